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
        "Prints the ROS_MASTER_URI that nodes need. It names $ROS_HOSTNAME or $ROS_IP where one is set. The port is\n"
        "that of $ROS_MASTER_URI where it is set, as with roscore, else 11311."
    )
    parser.add_argument(
        "--host", default="0.0.0.0", help="the address to listen on; default: every interface"
    )
    parser.add_argument(
        "-p", "--port", type=_port, help="instead of $ROS_MASTER_URI's; 0 takes any free port"
    )


def _port(text: str) -> int:
    import argparse

    value = int(text)
    if not 0 <= value < 65536:
        raise argparse.ArgumentTypeError(f"{text} is no port")
    return value


def run(arguments: argparse.Namespace) -> int:
    """Be a master until somebody ends it. Raises InvalidName where $ROS_MASTER_URI is no URI with a port."""
    import os

    from roslet.master.server import DEFAULT_PORT
    from roslet.master.server import run as serve
    from roslet.names import parse_host_port

    port = arguments.port
    if port is None:
        uri = os.environ.get("ROS_MASTER_URI")
        port = parse_host_port(uri)[1] if uri else DEFAULT_PORT
    return serve(arguments.host, port)
