"""When a participant does what it does by the clock."""

from __future__ import annotations

from amaranth.hdl import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

QUICK = 5
"""Announcements at once at start: peers that start together find each other although some are lost."""
QUICK_PERIOD = 0.1


class Timers(wiring.Component):
    """Pulses of one cycle: `tick` each second, `sweep` each `sweep` seconds, `announce` each `announcement` seconds; of the
    last the first QUICK are QUICK_PERIOD apart, and the very first comes when `enable` rises. Nothing while `enable` is low.
    """

    def __init__(self, clk_hz: float, announcement: float = 3.0, sweep: float = 0.1) -> None:
        if min(announcement, sweep) * clk_hz < 1:
            raise ValueError("a period is one cycle at least")
        self._second = max(1, round(clk_hz))
        self._announcement, self._quick = round(announcement * clk_hz), max(1, round(QUICK_PERIOD * clk_hz))
        self._sweep = max(1, round(sweep * clk_hz))
        super().__init__({"enable": In(1), "tick": Out(1), "sweep": Out(1), "announce": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        quick = Signal(range(QUICK + 1), init=QUICK)
        for name, output, period, first in (
            ("second", self.tick, self._second - 1, self._second - 1),
            ("sweep", self.sweep, self._sweep - 1, self._sweep - 1),
            ("announcement", self.announce, Mux(quick != 0, self._quick - 1, self._announcement - 1), 0),
        ):
            left = Signal(
                max(self._second, self._announcement, self._sweep).bit_length(), init=first, name=name
            )
            m.d.comb += output.eq(self.enable & (left == 0))
            with m.If(self.enable):
                m.d.sync += left.eq(Mux(left == 0, period, left - 1))
        with m.If(self.announce & (quick != 0)):
            m.d.sync += quick.eq(quick - 1)
        return m
