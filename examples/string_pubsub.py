"""Publishes std_msgs/String on `chatter`, or prints what others publish there, or both.

python string_pubsub.py sub &
python string_pubsub.py pub
"""

from __future__ import annotations

import argparse
import sys
from typing import Any

import roslet


def main() -> int:
    parser = argparse.ArgumentParser(description="Strings on the topic chatter.")
    parser.add_argument("role", choices=("pub", "sub", "both"), nargs="?", default="both")
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://, which needs no master; or ros1://"
    )
    parser.add_argument("--rate", type=float, default=1.0, help="messages a second (default 1)")
    parser.add_argument("--count", type=int, default=0, help="end after so many messages (default 0: never)")
    arguments = parser.parse_args()

    with roslet.Node("string_" + arguments.role, network=arguments.network) as node:
        heard: list[str] = []

        def callback(message: Any) -> None:
            heard.append(message.data)
            print(f"I heard: {message.data}", flush=True)

        def enough() -> bool:
            return bool(arguments.count) and len(heard) >= arguments.count

        if arguments.role != "pub":
            node.subscribe("chatter", "std_msgs/String", callback)
        if arguments.role == "sub":
            node.spin_until(enough)
            return 0

        chatter = node.publisher("chatter", "std_msgs/String")
        chatter.wait_for_subscribers(timeout=5.0)
        rate = node.rate(arguments.rate)
        number = 0
        while not node.is_shutdown and (not arguments.count or number < arguments.count):
            number += 1
            chatter.publish(data=f"Hello roslet {number}")
            rate.sleep()
        if arguments.role == "both" and arguments.count:
            node.spin_until(enough, timeout=2.0)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(0)
