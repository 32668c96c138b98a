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
        "roslet run talker.py --ros-args -r chatter:=news -p rate:=5\n"
        "roslet run --types my_ws/src talker.py --its-own-option",
        "types",
    )
    parser.description = (
        "Run an unmodified rospy or rclpy program on a machine without ROS.\n\nThe program imports rospy or rclpy, and "
        "messages, as ever; what it gets is roslet's. Options\nof this command stand before SCRIPT, everything after it "
        "is the program's. The exit code is\nthe program's own."
    )
    parser.add_argument(
        "--network",
        metavar="URL",
        help="of a rospy program: ros1://host:port; default: $ROS_MASTER_URI. An rclpy "
        "program is in the domain $ROS_DOMAIN_ID",
    )
    parser.add_argument(
        "--real", action="store_true", help="let the program import an installed rospy or rclpy, not roslet's"
    )
    parser.add_argument("script", metavar="SCRIPT", help="a Python file")
    parser.add_argument("arguments", nargs=argparse.REMAINDER, metavar="...", help="the program's arguments")


def run(arguments: argparse.Namespace) -> int:
    """`roslet run`."""
    from roslet.compat.run import run as run_program

    master = None
    if arguments.network:
        from roslet.cli.graph import is_ros1
        from roslet.errors import Unsupported
        from roslet.names import parse_network

        if not is_ros1(arguments.network):
            raise Unsupported(
                "--network names the master of a rospy program; set $ROS_DOMAIN_ID for one of rclpy"
            )
        master = parse_network(arguments.network, os.environ.get("ROS_MASTER_URI"))[0]
    return run_program(
        arguments.script, arguments.arguments, types=arguments.types, master=master, real=arguments.real
    )
