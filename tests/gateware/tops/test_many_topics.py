"""A node with several topics each way, of several types and sizes, among software participants: messages go where they
belong, whole and in order, however they come together."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

import pytest
from amaranth.hdl import ClockDomain, ClockSignal, Module, Signal
from amaranth.lib import wiring

from engine.rtps.network import BEST_EFFORT, RELIABLE
from gateware.running import started
from gateware.tops.echo_nodes import COORDINATE, OCTET, PAIRS, STRING, TWIST, Many, Pair, load
from roslet.engine.rtps import events
from roslet.gateware.tops.ros_node import Publish, RosNode
from roslet.gateware.wires import expose
from roslet.gen.runtime import message_class
from roslet.names.ros2 import TOPIC, dds_topic, dds_type
from roslet.sim.model import Model
from roslet.sim.wire import Wire
from sim.test_wire import ParticipantStation

pytestmark = pytest.mark.timeout(600)  # the design is compiled
NUMBER = "std_msgs/msg/UInt32"
CLOCK, FACTOR = 25e6, 50.0
COUNTED: list[Pair] = [(NUMBER, None, True, 1), (COORDINATE, None, True, 2), (NUMBER, None, False, 1)]
EACH = 12


class Counters(wiring.Component):
    """Numbers on each of `COUNTED`, always the next."""

    def __init__(self) -> None:
        load()
        topics = [
            Publish(f"out{n}", pair[0], reliable=pair[2], depth=pair[3]) for n, pair in enumerate(COUNTED)
        ]
        self._node = RosNode("counters", topics=topics, clk_hz=CLOCK / FACTOR)
        members = self._node.signature.members
        self._pins = [name for name in members if not name.startswith("out")]
        super().__init__({name: members[name] for name in self._pins})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.node = node = self._node
        m.domains.sync = ClockDomain(reset_less=True)
        m.d.comb += ClockSignal("sync").eq(self.clk)
        expose(m, node, self, self._pins)
        for n, (type_, *_) in enumerate(COUNTED):
            out, number = getattr(node, f"out{n}"), Signal(32)
            m.d.comb += [
                out.valid.eq(1),
                (out.payload.time.nanosec if type_ == COORDINATE else out.payload.data).eq(number),
            ]
            with m.If(out.ready):
                m.d.sync += number.eq(number + 1)
        return m


class Peer:
    """A software participant that reads all that the node publishes, and writes what it takes."""

    def __init__(self, number: int, wire: Wire, pairs: Sequence[Pair]) -> None:
        self._station = ParticipantStation(number, wire.hub.port())
        wire.add(self._station)
        participant = self._station.participant
        self.writers, self._topics = [], {}
        for n, (type_, _, reliable, _) in enumerate(pairs):
            qos = RELIABLE if reliable else BEST_EFFORT
            named = [dds_topic(TOPIC, f"/{way}{n}") for way in ("in", "out")]
            self.writers.append(participant.create_writer(named[0], dds_type(type_), qos, wire.now))
            reader = participant.create_reader(named[1], dds_type(type_), qos, wire.now)
            self._topics[reader.entity_id] = n

    def matched(self) -> int:
        """How many endpoints match ours."""
        return sum(isinstance(event, events.EndpointMatched) for event in self._station.events)

    def got(self) -> list[list[bytes]]:
        """The messages of each topic, without encapsulation headers and padding."""
        found: list[list[bytes]] = [[] for _ in self.writers]
        for event in self._station.events:
            if isinstance(event, events.SampleReceived):
                payload = bytes(event.payload)
                found[self._topics[event.local]].append(payload[4 : len(payload) - (payload[3] & 3)])
        return found


def message(rng: random.Random, topic: int, number: int) -> bytes:
    """One that says of which topic it is, and which."""
    type_, bound, _, _ = PAIRS[topic]
    made: Any = message_class("ros2", type_)()
    if type_ == STRING:
        made.data = f"{topic} {number} ".ljust(rng.randrange(8, (bound or 0) - 1), "x")
    elif type_ == OCTET:
        made.data = 16 * topic + number
    elif type_ == TWIST:
        made.linear.x, made.angular.z = topic, number
    else:
        made.x, made.time.nanosec = topic, number
    return bytes(made.serialize())


@pytest.mark.parametrize("at_once", [1, 5, EACH * len(PAIRS)])
def test_messages_of_all_topics_come_back_on_theirs_in_their_order(at_once: int) -> None:
    rng = random.Random(at_once)
    with Model(Many(CLOCK / FACTOR)) as model:
        wire = Wire(FACTOR)
        started(model, wire, CLOCK)
        peers = [Peer(number, wire, PAIRS) for number in (2, 3)]
        assert wire.run(20.0, lambda: all(peer.matched() >= 2 * len(PAIRS) for peer in peers)), "all find all"
        order = [topic for topic in range(len(PAIRS)) for _ in range(EACH)]
        rng.shuffle(order)
        sent: list[list[bytes]] = [[] for _ in PAIRS]
        for start in range(0, len(order), at_once):
            for topic in order[start : start + at_once]:
                data = message(rng, topic, len(sent[topic]))
                sent[topic].append(data[4:])
                peers[0].writers[topic].write(data, wire.now)
            wire.run(0.05)
        wanted = [topic for topic, pair in enumerate(PAIRS) if pair[2]]
        assert wire.run(
            20.0, lambda: all(peer.got()[topic] == sent[topic] for peer in peers for topic in wanted)
        ), [[len(one) for one in peer.got()] for peer in peers]
        wire.close()
    for peer in peers:  # of the others messages may be lost, where they came too soon
        for got, given in zip(peer.got(), sent, strict=True):
            places = [given.index(one) for one in got]
            assert places == sorted(set(places)) and len(places) >= (EACH if at_once == 1 else 1)


def test_topics_that_always_have_a_message_take_turns_and_lose_none() -> None:
    with Model(Counters()) as model:
        wire = Wire(FACTOR)
        started(model, wire, CLOCK)
        peer = Peer(2, wire, COUNTED)
        assert wire.run(20.0, lambda: peer.matched() >= len(COUNTED))
        assert wire.run(20.0, lambda: all(len(got) >= 100 for got in peer.got()))
        wire.close()
    for topic, got in enumerate(peer.got()):
        numbers = [int.from_bytes(data[-4:], "little") for data in got]
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers))), topic
        assert len(numbers) < 150, "each has its share"
