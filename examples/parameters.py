"""Beats at a rate that is a parameter, and follows it when somebody changes it.

    python parameters.py
    roslet param set /heart hz 10          # ROS 2: a parameter is a node's
    roslet param set /heart/hz 10          # ROS 1: it is the master's

On ROS 2 `python parameters.py --ros-args -p hz:=5.0` begins at another rate, on ROS 1 `_hz:=5.0`.
"""

from __future__ import annotations

import argparse
import sys
from typing import Any

import roslet


def main() -> int:
    parser = argparse.ArgumentParser(description="A node heart that beats; its parameter hz says how often.")
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://, which needs no master; or ros1://"
    )
    parser.add_argument("--count", type=int, default=0, help="end after so many beats (default 0: never)")
    arguments, ros = parser.parse_known_args()

    with roslet.Node("heart", network=arguments.network, arguments=ros) as node:
        name = "hz"
        if node.network.startswith("ros2"):
            # A declared parameter has a type; what does not fit the description is refused, and whoever asks is told why.
            node.declare_parameter(name, 2.0, text="beats a second", range=(0.1, 100.0))
        else:
            name = "~hz"
            if not node.has_parameter(name):
                node.set_parameter(name, 2.0)
        beats = 0
        timer: roslet.Timer | None = None

        def beat() -> None:
            nonlocal beats
            beats += 1

        def changed(hz: Any) -> None:
            nonlocal timer
            if timer is not None:
                timer.cancel()
            timer = node.timer(1.0 / hz, beat)
            print(f"{hz:g} beats a second", flush=True)

        changed(node.on_parameter(name, changed))
        node.spin_until(lambda: arguments.count and beats >= arguments.count)
        print(f"{beats} beats", flush=True)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(0)
