"""The node in gates and the software engine as a second opinion, in lock-step on the simulated wire, with seeded faults."""

from __future__ import annotations

from typing import Any

import pytest

from engine.rtps.network import GROUP, RELIABLE
from gateware.rtps.counter_node import FACTOR, TYPE, Running
from roslet.engine.rtps import events
from roslet.sim.link import Faults, Link
from roslet.sim.wire import Wire
from roslet.wire.rtps import locator
from sim.test_wire import ParticipantStation

pytestmark = pytest.mark.timeout(400)  # the design is compiled

FAULTS: dict[str, dict[str, Any]] = {
    "none": {},
    "loss": {"loss": 0.2},
    "all": {"loss": 0.1, "duplicate": 0.1, "reorder": 0.1, "bit_error": 0.05},
}


@pytest.mark.parametrize("faults", FAULTS)
def test_reliable_topics_lose_and_repeat_nothing_both_ways(faults: str) -> None:
    wire = Wire(FACTOR)
    link = Faults(wire.hub.port(), seed=7, **FAULTS[faults])
    with Running(reliable=True, wire=wire, link=link) as node:
        peer = ParticipantStation(2, wire.hub.port())
        wire.add(peer)
        peer.participant.create_reader("rt/count", TYPE, RELIABLE, 0.0)
        writer = peer.participant.create_writer("rt/shown", TYPE, RELIABLE, 0.0)
        assert wire.run(20.0, lambda: node.model.get("matched").bit_count() == 2)
        assert wire.run(
            20.0, lambda: sum(isinstance(one, events.EndpointMatched) for one in peer.events) == 2
        )

        def received() -> list[int]:
            samples = [one for one in peer.events if isinstance(one, events.SampleReceived)]
            return [int.from_bytes(bytes(one.payload[4:8]), "little") for one in samples]

        node.model.set("enable", 1)
        for number in range(40):
            writer.write(b"\0\1\0\0" + number.to_bytes(4, "little"), wire.now)
            wire.run(0.1)
        node.model.set("enable", 0)
        wire.run(0.2)
        sent = node.model.get("number")
        assert wire.run(20.0, lambda: received()[-1:] == [sent - 1] and node.model.get("received") == 39)
        got = received()
        assert got == sorted(set(got)), "in order, none twice"
        # The node keeps four: what a peer missed for longer is gone, and the peer is told so.
        assert len(got) == sent if faults == "none" else len(got) > sent * 0.8
        assert node.model.get("count") == 40


class GroupedStation(ParticipantStation):
    """A participant with a reader of `count`, which takes it by the group of all as well if it `listens`; `by_group`,
    `by_unicast`: how many datagrams came to the ports for the user's messages."""

    def __init__(self, number: int, link: Link, listens: bool) -> None:
        super().__init__(number, link)
        self.by_group = self.by_unicast = 0
        where = GROUP[0], GROUP[1] + 1
        self.many = self.station.host.open(where[1])
        if listens:
            self.many.join(where[0], 0.0)
        locators = (locator.udp4(*where),) if listens else ()
        self.participant.create_reader("rt/count", TYPE, RELIABLE, 0.0, multicast=locators)

    def exchange(self, now: float) -> None:
        self.station.exchange(now)
        for endpoint in (self.many, self.user):
            while (found := endpoint.receive()) is not None:
                self.by_group += endpoint is self.many
                self.by_unicast += endpoint is self.user
                self.participant.receive_datagram(found[0], found[1], now)
        super().exchange(now)

    @property
    def numbers(self) -> list[int]:
        samples = [one for one in self.events if isinstance(one, events.SampleReceived)]
        return [int.from_bytes(bytes(one.payload[4:8]), "little") for one in samples]


@pytest.mark.parametrize("loss", [0.0, 0.2])
def test_readers_in_the_group_get_a_message_together_and_the_others_by_themselves(loss: float) -> None:
    wire = Wire(FACTOR)
    link = Faults(wire.hub.port(), seed=8, loss=loss)
    with Running(reliable=True, wire=wire, link=link) as node:
        peers = [GroupedStation(number, wire.hub.port(), number < 4) for number in (2, 3, 4)]
        for peer in peers:
            wire.add(peer)
        assert wire.run(20.0, lambda: node.model.get("matched").bit_count() == 3)
        wire.run(1.0)  # what is said of matching has come
        for peer in peers:
            peer.by_group = peer.by_unicast = 0

        def published(count: int) -> None:
            until = node.model.get("number") + count
            node.model.set("enable", 1)
            assert wire.run(20.0, lambda: node.model.get("number") >= until)
            node.model.set("enable", 0)
            wire.run(1.0)

        published(30)
        sent = node.model.get("number")
        assert wire.run(20.0, lambda: all(peer.numbers[-1:] == [sent - 1] for peer in peers))
        for peer in peers:
            assert peer.numbers == sorted(set(peer.numbers)), "in order, none twice"
            if not loss:
                assert peer.numbers == list(range(sent))
        one, other, alone = peers
        assert alone.by_group == 0 and alone.by_unicast >= sent * (1 - 2 * loss)
        if loss:
            return
        # Of the first message it was not known that there are several.
        assert one.by_group == other.by_group == sent - 1
        assert one.by_unicast < 6 and other.by_unicast < 6, "the first, and heartbeats"
        # One leaves: of what comes then, the first still goes to the group.
        other.participant.close(wire.now)
        wire.run(1.0)
        published(10)
        assert one.numbers == list(range(node.model.get("number")))
        assert one.by_group <= sent and one.by_unicast >= 9


def test_a_node_that_was_reset_is_somebody_else_and_is_heard_from_its_first_message_on() -> None:
    wire = Wire(FACTOR)
    with Running(reliable=True, wire=wire) as node:
        peer = ParticipantStation(2, wire.hub.port())
        wire.add(peer)
        peer.participant.create_reader("rt/count", TYPE, RELIABLE, 0.0)
        node.model.set("enable", 1)

        def found(kind: type) -> list[Any]:
            return [one for one in peer.events if isinstance(one, kind)]

        assert wire.run(20.0, lambda: len(found(events.SampleReceived)) >= 3)
        node.model.set("rst_n", 0)
        wire.run(0.1)
        before = len(found(events.SampleReceived))
        node.model.set("rst_n", 1)
        assert wire.run(20.0, lambda: len(found(events.SampleReceived)) >= before + 3)
        one, other = (event.data.guid for event in found(events.ParticipantDiscovered))
        assert one[:8] == other[:8] and one != other
