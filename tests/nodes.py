"""Fixtures and helpers for tests with nodes on loopback: an embedded master a test, nodes that are closed behind it."""

from __future__ import annotations

import os
import socket
import struct
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import roslet
from roslet.io.select import reactor
from roslet.master.server import MasterServer
from roslet.node.ros1.network import Ros1Network
from roslet.wire.tcpros import emit_header, parse_header

PATIENCE = 8.0


def wait_until(predicate: Callable[[], object], what: str, patience: float = PATIENCE) -> None:
    """Serve, callbacks too, until the predicate is true; fails after `patience` seconds, saying what did not happen."""
    if not reactor().run_until(predicate, patience):
        raise AssertionError(f"{what}: not within {patience:g} s")


@pytest.fixture
def master() -> Iterator[MasterServer]:
    with MasterServer(port=0) as server:
        yield server


class Nodes:
    """Makes nodes; all are closed after the test."""

    def __init__(self, master: MasterServer) -> None:
        self.master = master
        self.network = f"ros1://127.0.0.1:{master.port}"
        self.made: list[roslet.Node] = []

    def __call__(self, name: str, **options: Any) -> roslet.Node:
        options.setdefault("network", self.network)
        node = roslet.Node(name, **options)
        node.log.quiet = True
        self.made.append(node)
        return node


@pytest.fixture
def make(master: MasterServer) -> Iterator[Nodes]:
    nodes = Nodes(master)
    yield nodes
    for node in nodes.made:
        node.close()


def domain() -> int:
    """A domain that others on this host hardly use: tests of several checkouts may run at a time."""
    return 1 + os.getpid() % 100


@pytest.fixture(params=["ros1", "ros2"])
def network(request: pytest.FixtureRequest) -> Iterator[str]:
    """The URL of either network, which does not leave this host: a master of the test's own, or a domain."""
    if request.param == "ros1":
        with MasterServer(port=0) as server:
            yield f"ros1://127.0.0.1:{server.port}"
    else:
        yield f"ros2://{domain()}?range=localhost"


def ros1(node: roslet.Node) -> Ros1Network:
    """What the node is on its network."""
    return node._ros1("a test")


def entry_of(handle: Any) -> Any:
    """What the engine knows of a publisher or subscription of ROS 1."""
    return handle._entry


def ports(node: roslet.Node) -> tuple[int, int]:
    """The node's slave API port and its TCPROS port."""
    return int(node.uri.rstrip("/").rpartition(":")[2]), ros1(node).engine.tcpros_port


def descriptors() -> int:
    return len(os.listdir("/proc/self/fd"))


class Raw:
    """A TCPROS peer made of a blocking socket, which says what it likes."""

    def __init__(self, port: int) -> None:
        self.sock = socket.create_connection(("127.0.0.1", port), 5)
        self.sock.settimeout(5)

    def send(self, data: bytes) -> None:
        self.sock.sendall(data)

    def send_header(self, **fields: str) -> None:
        self.send(emit_header(fields))

    def read(self, size: int) -> bytes:
        data = b""
        while len(data) < size:
            piece = self.sock.recv(size - len(data))
            if not piece:
                raise EOFError(f"closed after {len(data)} of {size} bytes")
            data += piece
        return data

    def read_frame(self) -> bytes:
        return self.read(struct.unpack("<I", self.read(4))[0])

    def read_header(self) -> dict[str, str]:
        return parse_header(self.read_frame())

    def at_end(self) -> bool:
        """Whether the other side has closed; what it sends before is thrown away."""
        try:
            while self.sock.recv(65536):
                pass
        except ConnectionError:
            return True
        except TimeoutError:
            return False
        return True

    def close(self) -> None:
        self.sock.close()

    def __enter__(self) -> Raw:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


def string_subscriber(node: roslet.Node, name: str, **other: str) -> Raw:
    """A raw subscriber of a std_msgs/String topic of `node`, its header exchanged."""
    raw = Raw(ports(node)[1])
    fields = {
        "callerid": "/raw",
        "md5sum": "992ce8a1687cec8c8bd883ec73ca41d1",
        "topic": name,
        "type": "std_msgs/String",
        "message_definition": "string data\n",
    }
    fields.update(other)
    raw.send_header(**fields)
    return raw


def serve(seconds: float) -> None:
    """Serve callbacks for a time."""
    end = time.monotonic() + seconds
    reactor().run_until(lambda: time.monotonic() >= end, seconds)
