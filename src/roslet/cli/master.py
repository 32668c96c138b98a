"""`roslet master`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roslet.cli.options import finish

if TYPE_CHECKING:
    import argparse


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command."""
    finish(
        parser,
        run,
        "roslet master\nroslet master --port 11312\nroslet master --host 127.0.0.1 --port 0",
    )
    parser.description = (
        "Be a ROS 1 master: naming, registration, parameters. Keeps nothing on disk; ends with Ctrl-C.\n\n"
        "Prints the ROS_MASTER_URI that nodes need. It names $ROS_HOSTNAME or $ROS_IP where one is set."
    )
    parser.add_argument(
        "--host", default="0.0.0.0", help="the address to listen on; default: every interface"
    )
    parser.add_argument(
        "-p", "--port", type=_port, default=11311, help="default 11311; 0 takes any free port"
    )


def _port(text: str) -> int:
    import argparse

    value = int(text)
    if not 0 <= value < 65536:
        raise argparse.ArgumentTypeError(f"{text} is no port")
    return value


def run(arguments: argparse.Namespace) -> int:
    """Be a master until somebody ends it."""
    from roslet.master.server import run as serve

    return serve(arguments.host, arguments.port)
