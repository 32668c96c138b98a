"""What quality of service does, told by its events: a mismatch, a missed deadline, a late subscriber. ROS 2 only.

python qos_events.py
"""

from __future__ import annotations

import argparse
import sys
from typing import Any

import roslet


def main() -> int:
    parser = argparse.ArgumentParser(description="Three lessons in quality of service.")
    parser.add_argument("--network", default="ros2://", help="default: ros2://; ROS 1 has no such events")
    arguments = parser.parse_args()

    with (
        roslet.Node("offers", network=arguments.network) as offers,
        roslet.Node("requests", network=arguments.network) as requests,
    ):
        told: list[Any] = []

        def wait_for(kind: str) -> Any:
            """The next event of this kind."""

            def found() -> list[Any]:
                return [one for one in told if type(one).__name__ == kind]

            if not requests.spin_until(found, timeout=10.0):
                raise TimeoutError(f"no {kind}")
            event = found()[0]
            told.clear()
            return event

        # A publisher that does not repeat what was lost is less than a reliable subscription requests.
        offers.log.quiet = requests.log.quiet = True  # each would say so in a line of its own
        weak = offers.publisher("scan", "std_msgs/String", qos=roslet.QoS(reliability="best_effort"))
        strict = requests.subscribe("scan", "std_msgs/String")
        strict.on_event(told.append)
        event = wait_for("QosIncompatible")
        print(f"no messages from {event.peer}: {', '.join(event.policies)}", flush=True)
        strict.close()
        weak.close()

        # Both agree to a message every 0.2 seconds; then one does not come.
        agreed = roslet.QoS(deadline=0.2)
        pulse = offers.publisher("pulse", "std_msgs/String", qos=agreed)
        requests.subscribe(
            "pulse", "std_msgs/String", lambda message: print(message.data), qos=agreed
        ).on_event(told.append)
        event = wait_for("Matched")
        print(f"matched with {event.peer}", flush=True)
        pulse.wait_for_subscribers(timeout=5.0)
        pulse.on_event(told.append)
        pulse.publish(data="one")
        wait_for("DeadlineMissed")
        print("the deadline was missed", flush=True)

        # What is transient local is kept for those who come late.
        kept = roslet.QoS(depth=2, durability="transient_local")
        map_ = offers.publisher("map", "std_msgs/String", qos=kept)
        for number in range(4):
            map_.publish(data=f"map {number}")
        late = requests.subscribe("map", "std_msgs/String", qos=kept)
        got = [late.take(timeout=5.0), late.take(timeout=5.0)]
        print("came late and got", *[message.data for message in got if message], flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
