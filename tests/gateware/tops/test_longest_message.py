"""Messages of all lengths through a node in gates, up to the longest that it takes and one word more."""

from __future__ import annotations

import random

import pytest

from engine.rtps.network import RELIABLE
from gateware.running import started
from gateware.tops.echo_nodes import TEXT, Longest
from roslet.cli.gateware_sim import dropped
from roslet.engine.rtps import events
from roslet.gateware.tops.ros_node import MAX_MESSAGE
from roslet.sim.model import Model
from roslet.sim.wire import Wire
from sim.test_wire import ParticipantStation

pytestmark = pytest.mark.timeout(400)  # the design is compiled
CLOCK, FACTOR = 25e6, 50.0
LENGTHS = [MAX_MESSAGE, 1, 2, 3, 4, 5, 700, 1023, *range(MAX_MESSAGE - 5, MAX_MESSAGE + 1)]


def test_messages_of_all_lengths_come_back_and_a_longer_one_is_counted() -> None:
    rng = random.Random(1)
    design = Longest(CLOCK / FACTOR)
    with Model(design) as model:
        wire = Wire(FACTOR)
        started(model, wire, CLOCK)
        peer = ParticipantStation(2, wire.hub.port())
        wire.add(peer)
        writer = peer.participant.create_writer("rt/in", TEXT, RELIABLE, wire.now)
        peer.participant.create_reader("rt/out", TEXT, RELIABLE, wire.now)

        def of(kind: type) -> list[object]:
            return [event for event in peer.events if isinstance(event, kind)]

        assert wire.run(20.0, lambda: len(of(events.EndpointMatched)) >= 2)
        sent = []
        for length in [*LENGTHS, MAX_MESSAGE + 4, 8]:
            payload = b"\0\1\0" + bytes([-length % 4]) + rng.randbytes(length) + bytes(-length % 4)
            writer.write(payload, wire.now)
            if length <= MAX_MESSAGE:
                sent.append(payload)
        assert wire.run(20.0, lambda: len(of(events.SampleReceived)) >= len(sent))
        got = [bytes(event.payload) for event in of(events.SampleReceived)]  # type: ignore[attr-defined]
        assert [one[4:] for one in got] == [one[4:] for one in sent]
        assert [one[3] & 3 for one in got] == [one[3] for one in sent]
        assert dropped(model, design.reasons) == {"rtps_sender_long0": 1}
        wire.close()
