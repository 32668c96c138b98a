"""Publishes a type of one's own, mros_test/UserTypeTest: a PersonName and the LEDValues that this person wants.

The definitions are in msgs/mros_test/msg; loading them is all that is needed.

    python custom_pubsub.py sub &
    python custom_pubsub.py pub
    roslet topic echo /user_type --network ros1://
"""

from __future__ import annotations

import argparse
import pathlib
import sys
from typing import Any

import roslet

# A package of definitions: no build step, no generated files.
messages = roslet.load(pathlib.Path(__file__).resolve().parent / "msgs" / "mros_test").mros_test.msg

PEOPLE = (
    ("Ada", "Lovelace", (255, 0, 0)),
    ("Grace", "Hopper", (0, 255, 0)),
    ("Mary", "Somerville", (0, 0, 255)),
)


def main() -> int:
    parser = argparse.ArgumentParser(description="A nested type of one's own on the topic user_type.")
    parser.add_argument("role", choices=("pub", "sub", "both"), nargs="?", default="both")
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://, which needs no master; or ros1://"
    )
    parser.add_argument("--rate", type=float, default=1.0, help="messages a second (default 1)")
    parser.add_argument("--count", type=int, default=0, help="end after so many messages (default 0: never)")
    arguments = parser.parse_args()

    with roslet.Node("custom_" + arguments.role, network=arguments.network) as node:
        heard: list[Any] = []

        def callback(message: Any) -> None:
            heard.append(message)
            name, leds = message.name, message.leds
            print(
                f"{name.first} {name.last} wants red {leds.red} green {leds.green} blue {leds.blue}",
                flush=True,
            )

        def enough() -> bool:
            return bool(arguments.count) and len(heard) >= arguments.count

        if arguments.role != "pub":
            node.subscribe("user_type", messages.UserTypeTest, callback)
        if arguments.role == "sub":
            node.spin_until(enough)
            return 0

        publisher = node.publisher("user_type", messages.UserTypeTest)
        publisher.wait_for_subscribers(timeout=5.0)
        message = messages.UserTypeTest()
        rate = node.rate(arguments.rate)
        number = 0
        while not node.is_shutdown and (not arguments.count or number < arguments.count):
            first, last, color = PEOPLE[number % len(PEOPLE)]
            message.name.first, message.name.last = first, last
            message.leds.red, message.leds.green, message.leds.blue = color
            publisher.publish(message)
            number += 1
            rate.sleep()
        if arguments.role == "both" and arguments.count:
            node.spin_until(enough, timeout=2.0)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(0)
