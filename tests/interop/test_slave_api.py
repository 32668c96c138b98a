"""What other nodes may ask of a node: ours answers as a real node does. Asked with the standard library's XML-RPC.

Where roscpp differs from the API's description, rospy alone is the judge: roscpp has no `getMasterUri`, its statistics have
another shape, and it grants what nobody publishes.
"""

from __future__ import annotations

import contextlib
import os
import xmlrpc.client
from collections.abc import Iterator
from typing import Any, NamedTuple

import pytest

from interop.exchange import Inbox, message
from interop.ros1 import Master, Peer, wait_until
from roslet import Node

STRING = "std_msgs/String"
COUNT, SIZE = 3, 20


class Side(NamedTuple):
    """A node that is asked: where, its name, and its process."""

    uri: str
    name: str
    pid: int

    def ask(self, method: str, *arguments: Any) -> list[Any]:
        with xmlrpc.client.ServerProxy(self.uri) as proxy:
            answer: list[Any] = getattr(proxy, method)("/asker", *arguments)
        code, text, _ = answer
        assert type(code) is int and type(text) is str, answer
        return answer

    def value(self, method: str, *arguments: Any) -> Any:
        code, text, value = self.ask(method, *arguments)
        assert code == 1, (method, text)
        return value


class Both(NamedTuple):
    ours: Side
    theirs: Side
    out: str  # we publish it
    back: str  # the peer publishes it

    @property
    def exact(self) -> list[Side]:
        """Those that do as the API is described."""
        return [self.ours] if self.theirs.name == "/roscpp_peer" else [self.ours, self.theirs]

    def ways(self, side: Side) -> tuple[str, str]:
        """What a side publishes, and what it subscribes to."""
        return (self.out, self.back) if side is self.ours else (self.back, self.out)

    def other(self, side: Side) -> Side:
        return self.theirs if side is self.ours else self.ours


@pytest.fixture(params=["roscpp", "rospy"])
def both(request: pytest.FixtureRequest, node: Node, topic: str) -> Iterator[Both]:
    """A node of ours and a real one that publish to each other; COUNT messages have gone each way."""
    peer: Peer = request.getfixturevalue(request.param)
    out, back, inbox = topic + "_out", topic + "_back", Inbox()
    with contextlib.ExitStack() as stack:
        publisher = stack.enter_context(node.publisher(out, STRING))
        peer.ask(f"subscribe {STRING} {out} {SIZE}", f"subscribed {out}")
        peer.ask(f"advertise {STRING} {back} 0", f"advertised {back}")
        stack.enter_context(node.subscribe(back, STRING, inbox))
        wait_until(lambda: publisher.subscriber_count == 1, "the peer subscribes")
        wait_until(lambda: peer.subscribers(back) == 1, "our subscription reaches the peer")
        for i in range(COUNT):
            publisher.publish(message(STRING, i, SIZE))
            peer.ask(f"publish {back} {i} {SIZE}", f"published {back}")
        peer.wait_for(f"got {out} ", COUNT)
        inbox.wait(COUNT)
        uri = node.lookup_node(peer.node_name)
        assert uri is not None
        yield Both(
            Side(node.uri, node.name, os.getpid()), Side(uri, peer.node_name, peer.process.pid), out, back
        )
    peer.ask(f"unsubscribe {out}", f"unsubscribed {out}")
    peer.ask(f"unadvertise {back}", f"unadvertised {back}")


def row(rows: list[list[Any]], topic: str, at: int = 0) -> list[Any]:
    (found,) = [one for one in rows if one[at] == topic]
    return found


def test_it_says_who_it_is(both: Both, master: Master) -> None:
    for side in both.ours, both.theirs:
        assert side.value("getPid") == side.pid
    for side in both.exact:
        assert side.value("getMasterUri").rstrip("/") == master.uri


def test_it_lists_its_topics_with_their_types(both: Both) -> None:
    for side in both.ours, both.theirs:
        published, subscribed = both.ways(side)
        assert row(side.value("getPublications"), published) == [published, STRING]
        assert row(side.value("getSubscriptions"), subscribed) == [subscribed, STRING]


def test_it_tells_its_connections(both: Both) -> None:
    for side in both.ours, both.theirs:
        published, subscribed = both.ways(side)
        other = both.other(side)
        rows = side.value("getBusInfo")
        number, *outbound = row(rows, published, 4)
        assert outbound[:5] == [other.name, "o", "TCPROS", published, True]
        assert type(number) is int and type(outbound[5]) is str
        number, *inbound = row(rows, subscribed, 4)
        assert inbound[:5] == [other.uri, "i", "TCPROS", subscribed, True]
        assert type(number) is int and type(inbound[5]) is str


def test_it_counts_what_went_over_its_connections(both: Both) -> None:
    """Of a publication [topic, octets, [[connection, octets, messages, connected]]], of a subscription
    [topic, [[connection, octets, ..., connected]]]."""
    bodies = COUNT * (4 + SIZE)
    for side in both.exact:
        published, subscribed = both.ways(side)
        sent, received, services = side.value("getBusStats")
        assert type(services) is list
        _, octets, ((_, over, messages, connected),) = row(sent, published)
        assert bodies <= octets <= bodies + 4 * COUNT
        assert bodies <= over and (messages, connected) == (COUNT, True)
        _, ((_, over, *_, connected),) = row(received, subscribed)
        assert bodies <= over and connected is True


def test_it_offers_tcpros_for_what_it_publishes_and_nothing_for_what_not(both: Both) -> None:
    for side in both.ours, both.theirs:
        published, _ = both.ways(side)
        protocol, host, port = side.value("requestTopic", published, [["NOROS"], ["TCPROS"]])
        assert (protocol, host) == ("TCPROS", "127.0.0.1") and 0 < port < 65536
        assert side.ask("requestTopic", published, [["NOROS"]])[0] != 1
    for side in both.exact:
        assert side.ask("requestTopic", "/nothing", [["TCPROS"]])[0] != 1


def test_it_takes_what_the_master_tells(both: Both) -> None:
    """A list of publishers, here the same once more, and a parameter, here one that nobody asked for: real nodes differ in
    what they say to that, and go on."""
    for side in both.ours, both.theirs:
        _, subscribed = both.ways(side)
        assert side.value("publisherUpdate", subscribed, [both.other(side).uri]) == 0
        side.ask("paramUpdate", "/nothing/", 1)
        assert len([one for one in side.value("getBusInfo") if one[4] == subscribed]) == 1


def test_several_calls_go_in_one(both: Both) -> None:
    for side in both.ours, both.theirs:
        with xmlrpc.client.ServerProxy(side.uri) as proxy:
            calls = xmlrpc.client.MultiCall(proxy)
            calls.getPid("/asker")
            calls.getPublications("/asker")
            answers: Any = calls()
            pid, publications = answers[0][2], answers[1][2]
        assert pid == side.pid
        row(publications, both.ways(side)[0])
