"""`roslet run`."""

from __future__ import annotations

import argparse
import os

from roslet.cli.options import finish


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command."""
    finish(
        parser,
        run,
        "roslet run talker.py\nroslet run talker.py chatter:=news _rate:=5 __name:=bob\n"
        "roslet run --types my_ws/src talker.py --its-own-option",
        "types",
    )
    parser.description = (
        "Run an unmodified rospy program on a machine without ROS.\n\nThe program imports rospy and messages as "
        "ever; what it gets is roslet's. Options of this\ncommand stand before SCRIPT, everything after it is the "
        "program's. The exit code is the\nprogram's own."
    )
    parser.add_argument("--network", metavar="URL", help="ros1://host:port; default: $ROS_MASTER_URI")
    parser.add_argument(
        "--real", action="store_true", help="let the program import an installed rospy, not roslet's"
    )
    parser.add_argument("script", metavar="SCRIPT", help="a Python file")
    parser.add_argument("arguments", nargs=argparse.REMAINDER, metavar="...", help="the program's arguments")


def run(arguments: argparse.Namespace) -> int:
    """`roslet run`."""
    from roslet.compat.run import run as run_program

    master = None
    if arguments.network:
        from roslet.names import parse_network

        master = parse_network(arguments.network, os.environ.get("ROS_MASTER_URI"))[0]
    return run_program(
        arguments.script, arguments.arguments, types=arguments.types, master=master, real=arguments.real
    )
