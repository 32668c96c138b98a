"""Messages of all lengths through a node in gates, up to the longest that it takes and one word more."""

from __future__ import annotations

import random

import pytest
from amaranth.hdl import Module
from amaranth.lib import wiring

from engine.rtps.network import RELIABLE
from roslet.cli.gateware_sim import dropped
from roslet.engine.rtps import events
from roslet.gateware.rtps.tables import Local
from roslet.gateware.tops.ros_core import Identity, RosCore
from roslet.gateware.tops.ros_node import MAX_MESSAGE
from roslet.gateware.wires import expose
from roslet.sim.mii import Mii
from roslet.sim.model import Model
from roslet.sim.wire import Wire
from sim.test_wire import ParticipantStation

pytestmark = pytest.mark.timeout(400)  # the design is compiled
TYPE = "std_msgs::msg::dds_::String_"
CLOCK, PHY_CLOCK, FACTOR = 25e6, 25e6, 50.0
LENGTHS = [MAX_MESSAGE, 1, 2, 3, 4, 5, 700, 1023, *range(MAX_MESSAGE - 5, MAX_MESSAGE + 1)]


class Echo(wiring.Component):
    """What comes on `in` goes out on `out`, a word at a time."""

    def __init__(self) -> None:
        self._core = RosCore(
            Identity("echo", address="192.168.1.100/24"),
            [Local("rt/out", TYPE, reliable=True, words=MAX_MESSAGE // 4)],
            [Local("rt/in", TYPE, reliable=True)],
            CLOCK / FACTOR,
            counters=True,
        )
        self.reasons = self._core.reasons
        members = self._core.signature.members
        self._pins = [name for name in members if not name.startswith(("publish", "receive", "room"))]
        super().__init__({name: members[name] for name in self._pins})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.core = core = self._core
        expose(m, core, self, self._pins)
        o, i = core.publish0.stream, core.receive0.stream
        m.d.comb += [o.payload.eq(i.payload), o.valid.eq(i.valid), i.ready.eq(o.ready), core.room.eq(1)]
        return m


def test_messages_of_all_lengths_come_back_and_a_longer_one_is_counted() -> None:
    rng = random.Random(1)
    design = Echo()
    with Model(design) as model:
        for name, hertz in (("clk", CLOCK), ("phy_rx_clk", PHY_CLOCK), ("phy_tx_clk", PHY_CLOCK)):
            model.clock(name, hertz)
        model.set("rst_n", 0)
        model.run(1e-6)
        model.set("rst_n", 1)
        wire = Wire(FACTOR)
        wire.gateware(model, Mii(model))
        peer = ParticipantStation(2, wire.hub.port())
        wire.add(peer)
        writer = peer.participant.create_writer("rt/in", TYPE, RELIABLE, wire.now)
        peer.participant.create_reader("rt/out", TYPE, RELIABLE, wire.now)

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
