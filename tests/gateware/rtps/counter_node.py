"""A node that counts: it publishes std_msgs/UInt32 on `count`, and shows what it receives on `shown`; on a simulated
wire."""

from __future__ import annotations

import functools
import pathlib
from typing import Any

from amaranth.hdl import ClockDomain, ClockSignal, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import In, Out

from gateware.collisions import SpoiledCollisions
from gateware.running import started
from roslet.cli.gateware_sim import dropped
from roslet.gateware.rtps import tables
from roslet.gateware.rtps.tables import Local
from roslet.gateware.tops.ros_core import Identity, RosCore
from roslet.gateware.wires import expose
from roslet.idl import Registry, type_hash
from roslet.sim.compile import build
from roslet.sim.model import Model
from roslet.sim.wire import Wire

ADDRESS = "192.168.1.100"
TYPE = "std_msgs::msg::dds_::UInt32_"
FIRST = 65_500
HASH = type_hash(Registry("ros2", None), "std_msgs/msg/UInt32")
CLOCK, FACTOR = 25e6, 250.0


class CounterNode(wiring.Component):
    """`rate` messages a second, whose sequence numbers begin behind FIRST: soon they have more than 16 bits."""

    def __init__(self, clk_hz: float, rate: float, reliable: bool, depth: int = 4) -> None:
        self._period = round(clk_hz / rate)
        self._core = RosCore(
            Identity("counter", address=f"{ADDRESS}/24"),
            [Local("rt/count", TYPE, reliable=reliable, words=1, depth=depth, type_hash=HASH)],
            [Local("rt/shown", TYPE, reliable=reliable, type_hash=HASH)],
            clk_hz,
            counters=True,
        )
        participant = self._core._participant
        participant._init[participant.own_map.writer_address(0, tables.WRITER_LAST)] = FIRST
        self.reasons = self._core.reasons
        members = self._core.signature.members
        self._pins = [name for name in members if name in ("clk", "rst_n", "alive", "matched")]
        self._pins += [name for name in members if name.startswith(("phy_", "drop_"))]
        super().__init__(
            {
                **{name: members[name] for name in self._pins},
                "number": Out(32),
                "received": Out(32),
                "count": Out(32),
                "enable": In(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain()
        m.d.comb += ClockSignal("sync").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(~self.rst_n, domain="sync")
        m.submodules.core = core = self._core
        expose(m, core, self, self._pins)
        left = Signal(32)
        o, i = core.publish0.stream, core.receive0.stream
        with m.FSM():
            with m.State("WAIT"):
                m.d.sync += left.eq(left + 1)
                with m.If((left >= self._period - 1) & self.enable):
                    m.d.sync += left.eq(0)
                    m.next = "NUMBER"
            with m.State("NUMBER"):
                m.d.comb += [o.valid.eq(1), o.payload.data.eq(self.number)]
                with m.If(o.ready):
                    m.next = "END"
            with m.State("END"):
                m.d.comb += [o.valid.eq(1), o.payload.end.eq(1)]
                with m.If(o.ready):
                    m.d.sync += self.number.eq(self.number + 1)
                    m.next = "WAIT"
        word = Signal(32)
        m.d.comb += [i.ready.eq(1), core.room.eq(1)]
        with m.If(i.valid & ~i.payload.end):
            m.d.sync += word.eq(i.payload.data)
        with m.If(i.valid & i.payload.end & ~i.payload.bad):
            m.d.sync += [self.received.eq(word), self.count.eq(self.count + 1)]
        return m


@functools.cache
def compiled(clk_hz: float, rate: float, reliable: bool) -> tuple[pathlib.Path, dict[str, int]]:
    design = CounterNode(clk_hz, rate, reliable)
    return build(design, SpoiledCollisions()), design.reasons


class Running:
    """The node on a wire, in whose seconds it counts."""

    def __init__(
        self, rate: float = 10.0, reliable: bool = False, wire: Wire | None = None, link: Any = None
    ) -> None:
        library, self.reasons = compiled(CLOCK / FACTOR, rate, reliable)
        self.model = Model(library)
        self.wire = wire or Wire(FACTOR)
        self.gates = started(self.model, self.wire, CLOCK, link)

    def __enter__(self) -> Running:
        return self

    def __exit__(self, *error: object) -> None:
        self.wire.close()
        self.model.close()

    def drops(self) -> dict[str, int]:
        return dropped(self.model, self.reasons)
