"""Publishes a point that moves, mros_comm_measure/Coordinate, on `ping`, and times its way back on `pong`.

python coordinate_listener.py &
python coordinate_talker.py --rate 10
"""

from __future__ import annotations

import argparse
import json
import pathlib
import statistics
import sys
import time
from typing import Any

import roslet

# A type of one's own: loading its definition is all it takes, on either network.
Coordinate: Any = roslet.load(
    pathlib.Path(__file__).resolve().parent / "msgs" / "mros_comm_measure"
).mros_comm_measure.msg.Coordinate

# Messages kept for the other side while it does something else; the pair checks that none is lost.
DEPTH = 1000


def coordinate(number: int) -> tuple[float, float, float]:
    """Where the point is in message `number`, which counts from 1."""
    return 0.1 * number, 10.03 * number, 3.003 * number


def main() -> int:
    parser = argparse.ArgumentParser(description="A moving point on ping; round trips by way of pong.")
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://, which needs no master; or ros1://"
    )
    parser.add_argument("--rate", type=float, default=1.0, help="messages a second (default 1)")
    parser.add_argument("--count", type=int, default=0, help="end after so many messages (default 0: never)")
    parser.add_argument(
        "--subscribers", type=int, default=1, help="wait for so many listeners at the start (default 1)"
    )
    parser.add_argument(
        "--settle",
        type=float,
        default=0.0,
        metavar="SECONDS",
        help="then wait so long: a listener of another kind may find us later",
    )
    parser.add_argument("--json", action="store_true", help="report every second, in JSON lines")
    arguments = parser.parse_args()

    began = time.monotonic()
    with roslet.Node("talker", network=arguments.network) as node:
        under_way: dict[int, float] = {}
        round_trips: list[float] = []
        altered = 0

        def back(message: Any) -> None:
            nonlocal altered
            # The time in the message says which one it is: a listener that changed it would not find its send time.
            sent_at = under_way.pop(message.time.to_nsec(), None)
            if sent_at is None:
                altered += 1
            else:
                round_trips.append(time.perf_counter() - sent_at)

        pong = node.subscribe("pong", Coordinate, back, qos=DEPTH)
        ping = node.publisher("ping", Coordinate, qos=DEPTH)
        ping.wait_for_subscribers(arguments.subscribers, timeout=10.0)
        pong.wait_for_publishers(timeout=2.0)
        found = {"found": time.monotonic() - began, "subscribers": ping.subscriber_count}
        node.sleep(arguments.settle)

        def report(number: int, final: bool) -> None:
            figures: dict[str, Any] = {"sent": number, "returned": len(round_trips), "altered": altered}
            figures.update(found, final=final)
            median = statistics.median(round_trips) if round_trips else None
            if arguments.json:
                more = {"round_trips": round_trips} if final else {"median": median}
                print(json.dumps({**figures, **more}), flush=True)
            elif final:
                text = "" if median is None else f", median round trip {median * 1e6:.0f} us"
                print(f"sent {number}, came back {len(round_trips)}{text}", flush=True)

        rate = node.rate(arguments.rate)
        next_report = time.monotonic() + 1.0
        number = 0
        try:
            while not node.is_shutdown and (not arguments.count or number < arguments.count):
                number += 1
                x, y, z = coordinate(number)
                message = Coordinate(x=x, y=y, z=z, time=node.now())
                under_way[message.time.to_nsec()] = time.perf_counter()
                ping.publish(message)
                rate.sleep()
                if time.monotonic() >= next_report:
                    next_report += 1.0
                    report(number, final=False)
            node.spin_until(lambda: not under_way, timeout=2.0)
        except KeyboardInterrupt:
            pass
        report(number, final=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
