"""A C++ program as the board, and a roslet node as its partner: what the board sends goes out on `ping`, and what comes on
`pong` goes to the board. Between them is a socket pair, one message a packet, serialized.

python ../coordinate_listener.py &
python board.py
"""

from __future__ import annotations

import argparse
import os
import pathlib
import shutil
import socket
import subprocess
import sys
import tempfile
from typing import Any

import roslet
from roslet.gen.cpp import write_headers
from roslet.idl import Registry

HERE = pathlib.Path(__file__).resolve().parent
TYPES = HERE.parent / "msgs" / "mros_comm_measure"
DEPTH = 1000


def build(folder: pathlib.Path, dialect: Any) -> pathlib.Path:
    """Write the headers and compile the program."""
    registry = Registry(dialect)
    write_headers(folder, registry, list(registry.load(TYPES)))
    program = folder / "board"
    options = ["-std=c++17", "-O2", "-Wall", "-Wextra", "-Werror", "-fno-exceptions", "-fno-rtti"]
    if dialect == "ros1":
        options.append("-DBOARD_ROS1")
    compiler = os.environ.get("CXX", "g++")
    subprocess.run(
        [compiler, *options, f"-I{folder}", str(HERE / "main.cpp"), "-o", str(program)], check=True
    )
    return program


def main() -> int:
    parser = argparse.ArgumentParser(description="A board in C++ that has a roslet node for its network.")
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://, which needs no master; or ros1://"
    )
    parser.add_argument("--count", type=int, default=5, help="messages (default 5)")
    arguments = parser.parse_args()
    if shutil.which(os.environ.get("CXX", "g++")) is None:
        print("no C++ compiler: set $CXX", file=sys.stderr)
        return 1

    coordinate: Any = roslet.load(TYPES).mros_comm_measure.msg.Coordinate
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with tempfile.TemporaryDirectory() as folder, roslet.Node("board", network=arguments.network) as node:
        dialect = "ros1" if arguments.network.startswith("ros1:") else "ros2"
        program = build(pathlib.Path(folder), dialect)
        ping = node.publisher("ping", coordinate, qos=DEPTH)

        def back(message: Any) -> None:
            ours.send(message.serialize())

        pong = node.subscribe("pong", coordinate, back, qos=DEPTH)
        ping.wait_for_subscribers(timeout=10.0)
        pong.wait_for_publishers(timeout=2.0)
        node.start()
        board = subprocess.Popen(
            [str(program), str(theirs.fileno()), str(arguments.count)], pass_fds=[theirs.fileno()]
        )
        theirs.close()
        while packet := ours.recv(1024):
            ping.publish(ping.type.deserialize(packet))
        return board.wait()


if __name__ == "__main__":
    sys.exit(main())
