"""The node in gates and the software engine as a second opinion, in lock-step on the simulated wire, with seeded faults."""

from __future__ import annotations

from typing import Any

import pytest

from engine.rtps.network import RELIABLE
from gateware.rtps.counter_node import FACTOR, TYPE, Running
from roslet.engine.rtps import events
from roslet.sim.link import Faults
from roslet.sim.wire import Wire
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
