"""`roslet master`, with the rosout node of roscore where it is asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roslet.cli.options import finish

if TYPE_CHECKING:
    import argparse

    from roslet.master.server import MasterServer
    from roslet.node import Node

# Log messages that wait for a slow reader of /rosout_agg: a restart of a large system logs some thousands.
ROSOUT_DEPTH = 10_000


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the command."""
    finish(
        parser,
        run,
        "roslet master\nroslet master --port 11312\nroslet master --host 127.0.0.1 --port 0\nroslet master --rosout",
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
    parser.add_argument(
        "--rosout",
        action="store_true",
        help="be the node /rosout too, which passes all logs on to /rosout_agg, as roscore does",
    )


def _port(text: str) -> int:
    import argparse

    if not text.isdecimal() or int(text) > 65535:
        raise argparse.ArgumentTypeError(f"{text} is no port")
    return int(text)


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
    beside = (lambda server: rosout(server, arguments.host)) if arguments.rosout else None
    return serve(arguments.host, port, beside)


def rosout(server: MasterServer, host: str) -> Node:
    """The node that gathers what all nodes log, so that a viewer needs one connection. It writes no file. `host` is where
    the master listens."""
    from roslet.names import parse_host_port
    from roslet.node import Node

    advertised, port = parse_host_port(server.uri)
    node = Node(
        "rosout",
        network=f"ros1://{'127.0.0.1' if host in ('', '0.0.0.0') else host}:{port}",
        arguments=[f"__hostname:={advertised}"],
        environment={},
    )
    gathered = node.publisher("/rosout_agg", "rosgraph_msgs/Log", qos=ROSOUT_DEPTH)

    node.subscribe("/rosout", "rosgraph_msgs/Log", gathered.publish, qos=ROSOUT_DEPTH)
    return node
