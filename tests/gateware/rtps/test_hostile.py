"""Hostile packets at the pins of the node: what stacks sent on recorded wires, and what seeded mutations make of it. What is
dropped is counted, and a peer that the node had before loses nothing."""

from __future__ import annotations

import random
from typing import Any

import pytest

import pcap
from engine.rtps.network import RELIABLE
from gateware.rtps.counter_node import ADDRESS, FACTOR, TYPE, Running
from peers import ROOT
from roslet.engine.net.events import EchoReplied
from roslet.engine.net.host import Host
from roslet.engine.rtps import events
from roslet.gateware.tops.ros_core import Identity
from roslet.sim.wire import Wire
from sim.test_wire import ParticipantStation

pytestmark = pytest.mark.timeout(400)  # the design is compiled

CAPTURES = sorted((ROOT / "tests/captures/rtps").glob("*.pcap"))
META, USER = Identity("counter", address=f"{ADDRESS}/24").ports[1:]
LONGEST = 1400
"""Octets of a datagram here: longer ones come in fragments, which have tests of their own."""
DATAGRAMS = 3000


class Siege:
    """The node, a peer that it has known before, and a host that sends it whatever it likes."""

    def __init__(self, node: Running) -> None:
        self.node, self.wire = node, node.wire
        self.peer = ParticipantStation(2, self.wire.hub.port())
        self.wire.add(self.peer)
        self.peer.participant.create_reader("rt/count", TYPE, RELIABLE, 0.0)
        self.writer = self.peer.participant.create_writer("rt/shown", TYPE, RELIABLE, 0.0)
        self.host = Host("02:00:00:00:00:66", "192.168.1.66/24", seed=66)
        self.wire.host(self.host)
        self.socket = self.host.open(7400)
        self.written = 0
        assert self.wire.run(20.0, lambda: node.model.get("matched").bit_count() == 2)
        assert self.wire.run(20.0, lambda: len(self.peer_events(events.EndpointMatched)) == 2)
        node.model.set("enable", 1)

    def peer_events(self, kind: type) -> list[Any]:
        return [one for one in self.peer.events if isinstance(one, kind)]

    def send(self, datagram: bytes, port: int) -> None:
        """A datagram, and the time it is on the wire: the design's clock is FACTOR times as slow as its wire."""
        self.socket.send(datagram, (ADDRESS, port), self.wire.now)
        self.wire.run(FACTOR * (60 + len(datagram)) * 8 / 100e6)

    def check(self) -> None:
        """It answers a ping, takes what the peer writes, and the peer what it writes."""
        self.host.ping(ADDRESS, self.wire.now)

        def replied() -> bool:
            event = self.host.next_event()
            return isinstance(event, EchoReplied)

        assert self.wire.run(2.0, replied), "no answer to a ping"
        self.writer.write(b"\0\1\0\0" + self.written.to_bytes(4, "little"), self.wire.now)
        self.written += 1
        before = len(self.peer_events(events.SampleReceived))
        assert self.wire.run(
            5.0,
            lambda: (
                self.node.model.get("count") == self.written
                and len(self.peer_events(events.SampleReceived)) > before
            ),
        ), f"{self.node.model.get('count')} of {self.written} messages taken"

    def numbers(self) -> list[int]:
        """What the peer has received."""
        return [
            int.from_bytes(bytes(one.payload[4:8]), "little")
            for one in self.peer_events(events.SampleReceived)
        ]


def recorded() -> list[bytes]:
    """Every datagram of the recorded wires that is not too long, once."""
    found = {data: None for path in CAPTURES for _, _, data in pcap.read(path) if len(data) <= LONGEST}
    return list(found)


def mutated(dice: random.Random, sent: list[bytes]) -> bytes:
    """One of them, with one to three changes: octets, lengths, words, cuts, what other datagrams have."""
    datagram = bytearray(dice.choice(sent))
    for _ in range(dice.randrange(1, 4)):
        if not datagram:
            break
        at = dice.randrange(len(datagram))
        word = at & ~3
        kind = dice.randrange(7)
        if kind < 2:
            datagram[at] ^= 1 << dice.randrange(8)
        elif kind == 2:
            datagram[at] = dice.choice((0, 1, 0x7F, 0x80, 0xFF))
        elif kind == 3:
            datagram[word : word + 4] = dice.choice((bytes(4), b"\xff" * 4, b"\1\0\0\0", b"\0\0\0\x80"))
        elif kind == 4:
            del datagram[at:]
        elif kind == 5:
            datagram += dice.choice(sent)[20:]
        else:
            del datagram[word : word + 4]
    return bytes(datagram[:LONGEST])


def test_recorded_and_mutated_datagrams_are_dropped_by_name_and_leave_a_peer_served() -> None:
    wire = Wire(FACTOR)
    dice = random.Random(5)
    sent = recorded()
    assert len(sent) > 100
    with Running(reliable=True, wire=wire) as node:
        siege = Siege(node)
        siege.check()
        for number, datagram in enumerate(sent):
            siege.send(datagram, META if number % 2 else USER)
        siege.check()
        assert set(node.drops()) <= {"rtps_submessages_unmatched", "rtps_discovery_incomplete"}, (
            "none is wrong"
        )
        for number in range(DATAGRAMS):
            siege.send(mutated(dice, sent), dice.choice((META, USER)))
            if number % 500 == 499:
                siege.check()
        node.model.set("enable", 0)
        last = node.model.get("number") - 1
        assert wire.run(20.0, lambda: siege.numbers()[-1:] == [last])
        assert siege.numbers() == list(range(last + 1)), "in order, none twice, none missed"
        assert node.model.get("received") == siege.written - 1
        drops = node.drops()
    assert sum(drops.values()) > DATAGRAMS / 3
    assert drops.keys() >= {
        *("rtps_walker_not_rtps", "rtps_walker_version", "rtps_walker_truncated"),
        *("rtps_submessages_unmatched", "rtps_submessages_invalid"),
        *("rtps_discovery_malformed", "rtps_discovery_incomplete"),
    }
