"""`roslet demo`: the whole path in one terminal.

`floor` times a raw socket, `programs` runs the example programs and reads their reports, `show` puts it on the screen and
judges. The programs are those of `examples/`, which is their one home: a checkout has it, a wheel carries it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from roslet.cli.options import finish, positive

if TYPE_CHECKING:
    import argparse


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command."""
    finish(parser, run, "roslet demo\nroslet demo --seconds 5 --folder /tmp/demo --json", "json")
    parser.description = (
        "See it work, in about 20 seconds, and a minute more the first time, when a node in gates is compiled.\n\n"
        "On ROS 1: starts a master, a talker and a listener of mros_comm_measure/Coordinate, and a camera\n"
        "and a viewer of sensor_msgs/Image. On ROS 2: the same talker and listener over RTPS, and a listener\n"
        "on CycloneDDS where Python's cyclonedds is installed. Each is a process of its own. Last, a ROS 2\n"
        "node in gates, simulated, and one in software exchange texts. Checks every message; times the way\n"
        "there and back against raw sockets. Exit code 0 where every message came and was right."
    )
    parser.add_argument(
        "--seconds",
        type=positive,
        default=6.0,
        metavar="SECONDS",
        help="how long they talk on each network (default 6)",
    )
    parser.add_argument(
        "--rate", type=positive, default=200.0, metavar="HZ", help="coordinates a second (default 200)"
    )
    parser.add_argument(
        "--no-gates", action="store_true", help="without the node in gates, which is compiled"
    )
    parser.add_argument("--folder", metavar="DIR", help="where the picture goes; default: a new one")


def run(arguments: argparse.Namespace) -> int:
    """`roslet demo`."""
    from roslet.cli.demo.show import demonstrate

    return demonstrate(arguments)
