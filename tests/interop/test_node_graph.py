"""What roslet and rclpy see of each other's nodes, topics, endpoints and services, and how they disappear; and Cyclone, of
nodes.
"""

from __future__ import annotations

import pathlib
import time
from collections.abc import Iterator

import pytest

from interop import ros2_exchange as exchange
from interop.ros2_peers import PATIENCE, Host, Peer, wait_until

STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
QOS = {
    "reliability": "best_effort",
    "durability": "transient_local",
    "liveliness": "manual_by_topic",
    "deadline": 2.0,
    "lifespan": 3.0,
    "lease": 4.0,
}
# Seconds: how soon a node that says goodbye is gone everywhere.
GONE = 1.0


class Two:
    def __init__(self, host: Host, kind: str) -> None:
        self.ours = host.peer("roslet", "ours", "/deep/space")
        self.theirs = host.peer(kind, "theirs", "/far/away")
        self.ours.node, self.theirs.node = "/deep/space/ours", "/far/away/theirs"


@pytest.fixture(scope="module", params=["kilted", "jazzy"])
def two(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Two]:
    with Host(tmp_path_factory.mktemp("graph")) as host:
        made = Two(host, request.param)
        for peer in (made.ours, made.theirs):
            wait_until(
                lambda peer=peer: peer.ask("nodes") == ["/deep/space/ours", "/far/away/theirs"],  # type: ignore[misc]
                f"{peer.kind} lists both nodes",
            )
        yield made


@pytest.fixture(params=["roslet", "rclpy"])
def sides(two: Two, request: pytest.FixtureRequest) -> tuple[Peer, Peer]:
    """Who has something, and who sees it."""
    return (two.ours, two.theirs) if request.param == "roslet" else (two.theirs, two.ours)


def test_a_topic_is_listed_with_its_type_counts_hash_and_qos(sides: tuple[Peer, Peer]) -> None:
    has, sees = sides
    topic = exchange.name()
    has.ask("publisher", "p", topic, exchange.STRING, QOS)
    has.ask("subscription", "s", topic, exchange.STRING, 0, QOS)
    sees.wait([1, 1], "counts", topic)
    assert sees.ask("topics")[topic] == [exchange.STRING]

    def named() -> bool:
        return {one["node"] for one in sees.ask("endpoints", topic)} == {has.node}

    wait_until(named, "the endpoints have their node")
    for kind in ("publisher", "subscription"):
        (found,) = [one for one in sees.ask("endpoints", topic) if one.pop("kind") == kind]
        # A reader has no lifespan to offer.
        lifespan = found["lifespan"] if kind == "subscription" else QOS["lifespan"]
        qos = {**QOS, "lifespan": lifespan}
        assert found == {"node": has.node, "type": exchange.STRING, "hash": STRING_HASH, **qos}
    has.ask("close", "p")
    sees.wait([0, 1], "counts", topic)
    has.ask("close", "s")
    sees.wait([0, 0], "counts", topic)
    assert topic not in sees.ask("topics")


def test_a_service_is_listed_with_its_type_and_by_its_node(sides: tuple[Peer, Peer]) -> None:
    has, sees = sides
    service = exchange.name()
    has.ask("service", "service", service, "std_srvs/srv/SetBool")
    wait_until(lambda: sees.ask("services").get(service) == ["std_srvs/srv/SetBool"], "the service is listed")
    wait_until(
        lambda: sees.ask("services_of", has.node).get(service) == ["std_srvs/srv/SetBool"],
        "the service is listed by its node",
    )
    assert service not in sees.ask("services_of", sees.node)
    has.ask("close", "service")
    wait_until(lambda: service not in sees.ask("services"), "the service is gone")


def listed(peer: Peer, name: str, there: bool, patience: float = PATIENCE) -> None:
    """Wait until a peer lists a node, or no longer does."""
    wait_until(
        lambda: (name in peer.ask("nodes")) == there, f"{peer.kind}: {name} is there: {there}", patience
    )


@pytest.mark.parametrize("kind", ["kilted", "jazzy"])
def test_a_node_that_closes_is_gone_within_a_second(tmp_path: pathlib.Path, kind: str) -> None:
    """And what it had; also where the other nodes of its process go on."""
    with Host(tmp_path) as host:
        theirs, witness = host.peer(kind, "theirs"), host.peer("roslet", "witness")
        for peer in (host.peer("roslet", "ours"), theirs):
            peer.ask("publisher", "p", "/gone", exchange.STRING, {})
            peer.ask("subscription", "s", "/gone", exchange.STRING, 0, {})
            others = [witness] if peer is theirs else [witness, theirs]
            for other in others:
                listed(other, peer.node, True)
                wait_until(lambda other=other: other.ask("counts", "/gone") > [0, 0], "so is the topic")  # type: ignore[misc]
            peer.ask("close_node")
            closed = time.monotonic()
            for other in others:
                listed(other, peer.node, False, closed + GONE - time.monotonic())
            if peer is not theirs:
                continue
            wait_until(lambda: "/gone" not in witness.ask("topics"), "the topic is gone", GONE)


def test_a_node_that_is_killed_is_gone_when_its_lease_is_over(tmp_path: pathlib.Path) -> None:
    with Host(tmp_path) as host:
        ours, theirs = host.peer("roslet", "ours"), host.peer("kilted", "theirs")
        mortals = host.peer("roslet"), host.peer("kilted")
        pids = [mortal.ask("mortal", f"mortal{k}") for k, mortal in enumerate(mortals)]
        everybody = ["/mortal0", "/mortal1", "/ours", "/theirs"]
        for peer in (ours, theirs):
            peer.wait(everybody, "nodes")
        for mortal, pid in zip(mortals, pids, strict=True):
            mortal.ask("kill", pid)
        time.sleep(2)
        for peer in (ours, theirs):
            assert peer.ask("nodes") == everybody
        for peer in (ours, theirs):
            peer.wait(["/ours", "/theirs"], "nodes", patience=30)
            peer.wait([0, 0], "counts", "/from")


@pytest.mark.parametrize("gid_size", [16, 24], ids=["as-jazzy", "as-humble"])
def test_cyclone_and_we_list_each_others_nodes(tmp_path: pathlib.Path, gid_size: int) -> None:
    """There is no rmw for Cyclone here; what it tells and hears is the message of that rmw, on its own topic."""
    with Host(tmp_path) as host:
        ours, theirs = host.peer("roslet", "ours", "/deep"), host.peer("cyclone", "theirs")
        theirs.ask("graph", gid_size)
        theirs.ask("publisher", "p", "/told", exchange.STRING, {})
        theirs.ask("tell_node", "/far", "theirs", ["p"])
        ours.wait(["/deep/ours", "/far/theirs"], "nodes")
        wait_until(
            lambda: [one["node"] for one in ours.ask("endpoints", "/told")] == ["/far/theirs"],
            "the publisher has its node",
        )
        theirs.wait(["/deep/ours", "/far/theirs"], "nodes")
        theirs.ask("tell_node", "", "", [])
        for peer in (ours, theirs):
            peer.wait(["/deep/ours"], "nodes")
        ours.ask("close_node")
        theirs.wait([], "nodes", patience=GONE)
