"""What every ROS 1 peer is put through, in each direction; the test files name the peer and the direction."""

from __future__ import annotations

import threading
from functools import partial
from typing import Any

import pytest

import roslet
from interop.cases import Case
from interop.peers import samples
from interop.ros1 import Peer, wait_until
from roslet import Node
from roslet.gen.runtime import message_class


def make(name: str) -> Any:
    """An empty message (or time) of ours."""
    if name == "time":
        return roslet.Time(0, 0)
    if name == "duration":
        return roslet.Duration(0, 0)
    return message_class("ros1", name)()


def message(type_name: str, i: int, size: int) -> Any:
    return samples.build(samples.sample(type_name, i, size), make)


class Inbox:
    """A callback that keeps what it was called with: copies, since views live as long as the callback."""

    def __init__(self) -> None:
        self.messages: list[Any] = []
        self._lock = threading.Lock()

    def __call__(self, message: Any) -> None:
        with self._lock:
            self.messages.append(message.copy())

    def wait(self, count: int) -> list[Any]:
        wait_until(lambda: len(self.messages) >= count, f"{count} messages arrive, {len(self.messages)} did")
        return list(self.messages)


def receive(node: Node, peer: Peer, case: Case, topic: str) -> None:
    """The peer publishes, our node receives every message whole and in order."""
    inbox = Inbox()
    peer.ask(f"advertise {case.type} {topic} 0", f"advertised {topic}")
    subscription = node.subscribe(topic, case.type, inbox)
    wait_until(lambda: peer.subscribers(topic) == 1, "our subscription reaches the peer")
    for i in range(case.count):
        peer.say(f"publish {topic} {i} {case.size}")
    got = inbox.wait(case.count)
    assert [
        samples.differences(samples.sample(case.type, i, case.size), each) for i, each in enumerate(got)
    ] == [[] for _ in range(case.count)]
    subscription.close()
    peer.ask(f"unadvertise {topic}", f"unadvertised {topic}")


def send(node: Node, peer: Peer, case: Case, topic: str) -> None:
    """Our node publishes, the peer says of every message that it is the one expected."""
    with node.publisher(topic, case.type) as publisher:
        peer.ask(f"subscribe {case.type} {topic} {case.size}", f"subscribed {topic}")
        wait_until(lambda: publisher.subscriber_count == 1, "the peer subscribes")
        for i in range(case.count):
            publisher.publish(message(case.type, i, case.size))
        lines = peer.wait_for(f"got {topic} ", case.count)
    assert lines == [f"got {topic} {i} ok" for i in range(case.count)]
    peer.ask(f"unsubscribe {topic}", f"unsubscribed {topic}")


def raw_to_us(node: Node, peer: Peer, topic: str) -> None:
    """A subscription of any type gets the bytes, and from the publisher's header what they are."""
    inbox: list[Any] = []
    peer.ask(f"advertise peer_msgs/Crowd {topic} 0", f"advertised {topic}")
    subscription = node.subscribe(topic, "*", inbox.append)
    wait_until(lambda: peer.subscribers(topic) == 1, "our subscription reaches the peer")
    peer.say(f"publish {topic} 0 3")
    wait_until(lambda: inbox, "the message arrives")
    crowd = message_class("ros1", "peer_msgs/Crowd")
    assert inbox[0].type == "peer_msgs/Crowd"
    assert inbox[0].md5sum == crowd._md5sum
    assert "MSG: mros_comm_measure/Coordinate" in inbox[0].definition
    got = crowd.deserialize(inbox[0].data)
    assert samples.differences(samples.sample("peer_msgs/Crowd", 0, 3), got) == []
    subscription.close()
    peer.ask(f"unadvertise {topic}", f"unadvertised {topic}")


def mismatch_to_us(node: Node, peer: Peer, topic: str) -> None:
    """A publisher of another type is not understood as ours: no message, no connection, and others unharmed."""
    wrong, right = Inbox(), Inbox()
    peer.ask(f"advertise std_msgs/String {topic} 0", f"advertised {topic}")
    mistaken = node.subscribe(topic, "mros_comm_measure/Coordinate", wrong)
    subscription = node.subscribe(topic, "std_msgs/String", right)
    wait_until(lambda: peer.subscribers(topic) >= 1, "the right subscription reaches the peer")
    peer.say(f"publish {topic} 0 16")
    right.wait(1)
    assert wrong.messages == []
    assert mistaken.publisher_count == 0
    subscription.close()
    mistaken.close()
    peer.ask(f"unadvertise {topic}", f"unadvertised {topic}")


def mismatch_to_peer(node: Node, peer: Peer, topic: str) -> None:
    """A subscriber of another type is refused; the publisher goes on."""
    with node.publisher(topic, "mros_comm_measure/Coordinate") as publisher:
        peer.ask(f"subscribe std_msgs/String {topic} 1", f"subscribed {topic}")
        inbox = Inbox()
        with node.subscribe(topic, "mros_comm_measure/Coordinate", inbox):
            publisher.publish(message("mros_comm_measure/Coordinate", 0, 0))
            inbox.wait(1)
        assert peer.told(f"got {topic}") == []
        assert publisher.subscriber_count == 0
    peer.ask(f"unsubscribe {topic}", f"unsubscribed {topic}")


def latched_to_us(node: Node, peer: Peer, topic: str) -> None:
    """What a latched publisher sent before we subscribed still reaches us, once."""
    inbox = Inbox()
    peer.ask(f"advertise std_msgs/String {topic} 1", f"advertised {topic}")
    peer.ask(f"publish {topic} 0 10", f"published {topic} 0")
    peer.ask(f"publish {topic} 1 10", f"published {topic} 1")
    subscription = node.subscribe(topic, "std_msgs/String", inbox)
    assert [each.data for each in inbox.wait(1)] == [samples.sample("std_msgs/String", 1, 10)["data"]]
    subscription.close()
    peer.ask(f"unadvertise {topic}", f"unadvertised {topic}")


def latched_to_peer(node: Node, peer: Peer, topic: str) -> None:
    with node.publisher(topic, "std_msgs/String", qos=roslet.QoS(durability="transient_local")) as publisher:
        publisher.publish(message("std_msgs/String", 3, 10))
        publisher.publish(message("std_msgs/String", 0, 10))
        peer.ask(f"subscribe std_msgs/String {topic} 10", f"subscribed {topic}")
        assert peer.wait_for(f"got {topic} ") == [f"got {topic} 0 ok"]
        peer.ask(f"unsubscribe {topic}", f"unsubscribed {topic}")


def sequence_to_us(node: Node, peer: Peer, topic: str) -> None:
    """A publisher numbers the headers of what it sends: we keep the numbers."""
    inbox = Inbox()
    peer.ask(f"advertise peer_msgs/Stamps {topic} 0", f"advertised {topic}")
    subscription = node.subscribe(topic, "peer_msgs/Stamps", inbox)
    wait_until(lambda: peer.subscribers(topic) == 1, "our subscription reaches the peer")
    for i in range(4):
        peer.say(f"publish {topic} {i} 0")
    numbers = [each.header.seq for each in inbox.wait(4)]
    assert numbers == list(range(numbers[0], numbers[0] + 4))
    subscription.close()
    peer.ask(f"unadvertise {topic}", f"unadvertised {topic}")


def datagrams_to_us(node: Node, peer: Peer, topic: str, size: int) -> None:
    """Over UDPROS nothing is promised to arrive: the peer sends until five did; each must be whole."""
    inbox = Inbox()
    peer.ask(f"advertise std_msgs/String {topic} 0", f"advertised {topic}")
    subscription = node.subscribe(topic, "std_msgs/String", inbox, qos=roslet.QoS(reliability="best_effort"))
    wait_until(lambda: peer.subscribers(topic) == 1, "our subscription reaches the peer")
    for _ in range(200):
        peer.ask(f"publish {topic} 7 {size}", f"published {topic}")
        if len(inbox.messages) >= 5:
            break
    expected = samples.sample("std_msgs/String", 7, size)["data"]
    assert {each.data for each in inbox.wait(5)} == {expected}
    assert "UDPROS" in transports(node, topic)
    subscription.close()
    peer.ask(f"unadvertise {topic}", f"unadvertised {topic}")


def datagrams_to_peer(node: Node, peer: Peer, topic: str, size: int) -> None:
    with node.publisher(topic, "std_msgs/String") as publisher:
        peer.ask(f"subscribe std_msgs/String {topic} {size} udp", f"subscribed {topic}")
        wait_until(lambda: publisher.subscriber_count == 1, "the peer subscribes")
        for i in range(5):
            publisher.publish(message("std_msgs/String", i, size))
            peer.wait_for(f"got {topic} ", i + 1)
        assert peer.told(f"got {topic} ") == [f"got {topic} {i} ok" for i in range(5)]
        assert "UDPROS" in transports(node, topic)
    peer.ask(f"unsubscribe {topic}", f"unsubscribed {topic}")


def falls_back(node: Node, peer: Peer, topic: str) -> None:
    """rospy speaks no UDPROS: a best-effort subscription then takes what there is."""
    inbox = Inbox()
    peer.ask(f"advertise std_msgs/String {topic} 0", f"advertised {topic}")
    subscription = node.subscribe(topic, "std_msgs/String", inbox, qos=roslet.QoS(reliability="best_effort"))
    wait_until(lambda: peer.subscribers(topic) == 1, "our subscription reaches the peer")
    peer.say(f"publish {topic} 0 5")
    inbox.wait(1)
    assert transports(node, topic) == {"TCPROS"}
    subscription.close()
    peer.ask(f"unadvertise {topic}", f"unadvertised {topic}")


def transports(node: Node, topic: str) -> set[str]:
    """What our own getBusInfo says of a topic's connections."""
    return {row[3] for row in node.call_node(node.uri, "getBusInfo") if row[4] == topic}


def peer_returns(node: Node, peer: Peer, topic: str) -> None:
    """A publisher that goes and returns is found again, and its counts follow."""
    inbox = Inbox()
    subscription = node.subscribe(topic, "std_msgs/String", inbox)
    for _ in range(2):
        inbox.messages.clear()
        peer.ask(f"advertise std_msgs/String {topic} 0", f"advertised {topic}")
        wait_until(lambda: subscription.publisher_count == 1, "we connect to the peer")
        wait_until(lambda: peer.subscribers(topic) == 1, "the peer counts us")
        peer.say(f"publish {topic} 0 5")
        inbox.wait(1)
        peer.ask(f"unadvertise {topic}", f"unadvertised {topic}")
        wait_until(lambda: subscription.publisher_count == 0, "we notice that the publisher went")
    subscription.close()


def calls_from_us(node: Node, peer: Peer, name: str, persistent: bool) -> None:
    """We call the peer's service: every reply is whole, a refusal raises, and the next call works again."""
    peer.ask(f"serve {name}", f"serving {name}")
    client = node.client(name, "peer_msgs/Scale", persistent=persistent)
    assert client.wait(timeout=10)
    for count in (0, 1, 100):
        points = samples.build(samples.scale_request(count, 0.5)["points"], make)
        response = client.call(points=points, factor=0.5, timeout=10)
        assert samples.differences(samples.scale_response(count, 0.5), response) == []
    with pytest.raises(roslet.RosletError):
        client.call(points=[], factor=0.0, timeout=10)
    assert client.call(points=[], factor=2.0, timeout=10).text == "scaled 0"
    client.close()


def on_scale(request: Any) -> dict[str, Any]:
    """The service of the samples, ours."""
    if request.factor == 0:
        raise ValueError("factor is zero")
    for point in request.points:
        point.x *= request.factor
        point.y *= request.factor
        point.z *= request.factor
    return {"points": request.points, "text": f"scaled {len(request.points)}"}


def calls_to_us(node: Node, peer: Peer, name: str, persistent: bool) -> None:
    """The peer calls our service: it finds every response right, and is told when our handler raises."""
    service = node.service(name, "peer_msgs/Scale", on_scale)
    kept = int(persistent)
    for count in (0, 1, 100):
        assert peer.ask(f"call {name} {count} 0.5 {kept}", f"called {name}") == "ok"
    assert peer.ask(f"call {name} 1 0 0", f"called {name}").startswith("failed")
    assert peer.ask(f"call {name} 1 2.0 {kept}", f"called {name}") == "ok"
    service.close()


PARAMETERS: list[tuple[str, Any, str, str]] = [  # kind, value, how a command spells it, how a peer tells it
    ("int", -42, "-42", "-42"),
    ("int", 2**31 - 1, "2147483647", "2147483647"),
    ("double", 0.1, "0.1", "0.10000000000000001"),
    ("double", 1e300, "1e300", "1.0000000000000001e+300"),
    ("bool", True, "1", "1"),
    ("bool", False, "0", "0"),
    ("string", "a < b & c > d", "a < b & c > d", "a < b & c > d"),
    ("doubles", [1.5, -2.25, 1e300], "-", "1.5;-2.25;1.0000000000000001e+300;"),
    ("ints", {"one": 1, "two": 2}, "-", "one=1;two=2;"),
]


def parameters_to_peer(node: Node, peer: Peer, name: str) -> None:
    for kind, value, _, told in PARAMETERS:
        node.set_parameter(name, value)
        assert peer.ask(f"get {name} {kind}", f"value {name} {kind}") == told
    node.delete_parameter(name)
    assert peer.ask(f"get {name} int", f"missing {name}") == ""


def _last_is(told: list[Any], value: Any) -> bool:
    return bool(told) and told[-1] == value


def parameters_to_us(node: Node, peer: Peer, name: str) -> None:
    """What a peer sets we read, and are told of at once where we asked to be."""
    told: list[Any] = []
    node.on_parameter(name, told.append)
    for kind, value, spelled, _ in PARAMETERS:
        told.clear()
        peer.ask(f"set {name} {kind} {spelled}", f"set {name}")
        assert node.get_parameter(name) == value
        wait_until(partial(_last_is, told, value), f"the change to {value!r} is told")
    assert node.has_parameter(name)
    node.delete_parameter(name)
    assert not node.has_parameter(name)
