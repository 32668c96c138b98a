"""Masters that restart, peers that are killed: our node is there again without being asked."""

from __future__ import annotations

import pathlib
import signal
from collections.abc import Iterator
from functools import partial

import pytest

import peers
import roslet
from interop import exchange
from interop.cases import Case
from interop.exchange import Inbox
from interop.ros1 import Master, Peer, Tools, wait_until
from roslet import Node

COORDINATE = Case("mros_comm_measure/Coordinate", 0, 3)


@pytest.fixture(params=["debian", "roslet"])
def mortal(request: pytest.FixtureRequest, tmp_path: pathlib.Path) -> Iterator[Master]:
    """A master of this test alone, to be stopped and started."""
    master = Master(request.param, tmp_path)
    yield master
    master.stop()


@pytest.fixture
def own(mortal: Master) -> Iterator[Node]:
    roslet.load(str(peers.WORKSPACE))
    with Node("survivor", network=mortal.network) as node:
        node.start()
        yield node


def test_a_restarted_master_knows_everything_of_ours_again(
    mortal: Master, own: Node, tmp_path: pathlib.Path
) -> None:
    own.publisher("/said", COORDINATE.type)
    own.subscribe("/heard", COORDINATE.type, Inbox())
    own.service("/served", "peer_msgs/Scale", exchange.on_scale)
    mortal.stop()
    mortal.start()
    tools = Tools(mortal, tmp_path)

    def all_back() -> bool:
        text = tools.run("rosnode", "info", own.name, code=None)
        return all(name in text for name in ("/said", "/heard", "/served"))

    wait_until(all_back, "publisher, subscription and service are registered again", 30)
    peer = Peer("rospy", mortal)
    exchange.send(own, peer, COORDINATE, "/said_later")
    exchange.receive(own, peer, COORDINATE, "/heard_later")
    assert peer.ask("call /served 2 0.5 0", "called /served") == "ok"
    peer.quit()


def test_a_connection_survives_the_master(mortal: Master, own: Node) -> None:
    """Topics are between nodes: with the master gone they go on."""
    peer = Peer("roscpp", mortal)
    inbox = Inbox()
    peer.ask("advertise std_msgs/String /steady 0", "advertised /steady")
    own.subscribe("/steady", "std_msgs/String", inbox)
    wait_until(lambda: peer.subscribers("/steady") == 1, "our subscription reaches the peer")
    mortal.stop()
    peer.say("publish /steady 0 5")
    inbox.wait(1)
    mortal.start()
    peer.quit()


def _counts_us(peer: Peer) -> bool:
    return peer.subscribers("/fragile") == 1


@pytest.mark.parametrize("kind", ["roscpp", "rospy"])
def test_a_killed_peer_is_noticed_and_found_again(mortal: Master, own: Node, kind: str) -> None:
    inbox = Inbox()
    subscription = own.subscribe("/fragile", "std_msgs/String", inbox)
    for _ in range(2):
        inbox.messages.clear()
        peer = Peer(kind, mortal)
        peer.ask("advertise std_msgs/String /fragile 0", "advertised /fragile")
        wait_until(lambda: subscription.publisher_count == 1, "we connect to the peer")
        wait_until(partial(_counts_us, peer), "the peer counts us")
        peer.say("publish /fragile 0 5")
        inbox.wait(1)
        peer.process.send_signal(signal.SIGKILL)
        wait_until(lambda: subscription.publisher_count == 0, "we notice that the peer is gone")
        peer.stop()


@pytest.mark.parametrize("kind", ["roscpp", "rospy"])
def test_a_killed_subscriber_leaves_our_publisher_and_the_others_unharmed(
    mortal: Master, own: Node, kind: str
) -> None:
    with own.publisher("/sturdy", "std_msgs/String") as publisher:
        doomed, healthy = Peer(kind, mortal), Peer("rospy" if kind == "roscpp" else "roscpp", mortal)
        for peer in (doomed, healthy):
            peer.ask("subscribe std_msgs/String /sturdy 100000", "subscribed /sturdy")
        wait_until(lambda: publisher.subscriber_count == 2, "both subscribe")
        doomed.process.send_signal(signal.SIGKILL)
        for i in range(20):
            publisher.publish(exchange.message("std_msgs/String", i, 100_000))
            lines = healthy.wait_for("got /sturdy", i + 1)
        assert lines == [f"got /sturdy {i} ok" for i in range(20)]
        wait_until(lambda: publisher.subscriber_count == 1, "we notice that one is gone")
        doomed.stop()
        healthy.quit()


@pytest.mark.parametrize("kind", ["debian", "roslet"])
def test_a_node_that_starts_before_the_master_works_when_it_comes(kind: str, tmp_path: pathlib.Path) -> None:
    master = Master(kind, tmp_path)
    master.stop()
    with Node("early", network=master.network) as node:
        node.start()
        publisher = node.publisher("/early", "std_msgs/String")
        master.start()
        peer = Peer("rospy", master)
        peer.ask("subscribe std_msgs/String /early 5", "subscribed /early")
        wait_until(lambda: publisher.subscriber_count == 1, "the peer finds us", 30)
        publisher.publish(exchange.message("std_msgs/String", 0, 5))
        assert peer.wait_for("got /early") == ["got /early 0 ok"]
        peer.quit()
    master.stop()
