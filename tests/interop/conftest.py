"""Fixtures of the interop tests: ROS 1 masters a session and kind, long-lived peers a module or class."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

import peers
from interop.ros1 import Master, Peer, Tools
from interop.ros2_peers import Host, Pair

if TYPE_CHECKING:
    import roslet


@pytest.fixture(scope="session", params=["debian", "roslet"])
def master(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Master]:
    """Debian's rosmaster, then ours in its place."""
    started = Master(request.param, tmp_path_factory.mktemp(f"{request.param}-master"))
    yield started
    started.stop()


@pytest.fixture(scope="module")
def roscpp(master: Master) -> Iterator[Peer]:
    peer = Peer("roscpp", master)
    yield peer
    peer.quit()


@pytest.fixture(scope="module")
def rospy(master: Master) -> Iterator[Peer]:
    peer = Peer("rospy", master)
    yield peer
    peer.quit()


@pytest.fixture(scope="module")
def tools(master: Master, tmp_path_factory: pytest.TempPathFactory) -> Tools:
    return Tools(master, tmp_path_factory.mktemp("tools"))


@pytest.fixture(scope="class")
def pair(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Pair]:
    """The peers that a class of ROS 2 tests names (ros2_exchange.py)."""
    with Host(tmp_path_factory.mktemp(f"{request.cls.talker}-{request.cls.listener}")) as host:
        yield Pair(host, request.cls.talker, request.cls.listener)


_numbers = itertools.count()


@pytest.fixture
def topic() -> str:
    """A topic, service or parameter name that no other test uses."""
    return f"/name_{next(_numbers)}"


@pytest.fixture(scope="module")
def node(master: Master) -> Iterator[roslet.Node]:
    """A node of ours that spins in the background; the messages of the peers are loaded as a user does."""
    import roslet

    roslet.load(str(peers.WORKSPACE))
    with roslet.Node("roslet_node", network=master.network) as started:
        started.start()
        yield started
