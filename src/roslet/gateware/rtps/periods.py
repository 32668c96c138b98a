"""When a participant does what it does by the clock, by periods that are ports. The manual, Table A-2."""

from __future__ import annotations

from amaranth.hdl import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

QUICK = 5
"""Announcements at once at start, QUICK_PERIOD seconds apart."""
QUICK_PERIOD = 0.1
BITS = 32
PRESCALER_BITS = 16


class Periods(wiring.Component):
    """Pulses of one cycle, while `enable` is high: `tick` each `second` cycles; `announce`, `sweep`, `publish` each so many
    steps as their period says, where a step is `prescaler_div` cycles; `sweep` has several periods, any of which counts.

    The first announcement comes at once, and the next ones `quick` steps apart: peers that start together find each other
    although some are lost. The first `publish` comes a period after `publishing` has risen, and none while it is low.

    Of what is due at the same time one comes after the other, `interval` steps apart. What is due again before it came comes
    once. A period of 0 is one of 1. Periods have `bits`.
    """

    def __init__(self, second: int, quick: int, sweeps: int = 2, bits: int = BITS) -> None:
        if second < 1 or not 0 <= quick < 1 << bits:
            raise ValueError(f"a second of {second} cycles and a period of {quick} steps cannot be counted")
        self._second, self._quick, self._bits = second, quick, bits
        self._sweeps = [f"sweep{n}" for n in range(sweeps)]
        super().__init__(
            {
                "enable": In(1),
                "publishing": In(1),
                "prescaler_div": In(PRESCALER_BITS),
                **{name: In(bits) for name in ("interval", "announcement", *self._sweeps, "message")},
                **{name: Out(1) for name in ("tick", "announce", "sweep", "publish")},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        cycles = Signal(range(self._second))
        m.d.comb += self.tick.eq(self.enable & (cycles == self._second - 1))
        divided = Signal(PRESCALER_BITS)
        step = Signal()
        m.d.sync += step.eq(self.enable & (divided == 0))
        with m.If(self.enable):
            m.d.sync += [
                cycles.eq(Mux(self.tick, 0, cycles + 1)),
                divided.eq(Mux(divided == 0, self.prescaler_div - (self.prescaler_div != 0), divided - 1)),
            ]
        quick = Signal(range(QUICK + 1), init=QUICK)

        def due(name: str, period: Value, running: Value, first: int | None = None) -> Signal:
            """High in the cycle after the last step of a period; the first one is as long, or has `first` steps."""
            left = Signal(self._bits, init=first or 0, name=f"{name}_left")
            last = Signal(name=f"{name}_last")  # step of the period: looked at a cycle before it counts
            over = Signal(name=f"{name}_over")
            m.d.sync += [last.eq(left[1:] == 0), over.eq(step & last & running)]
            with m.If(~running & (first is None)):
                m.d.sync += left.eq(period)
            with m.Elif(step & running):
                m.d.sync += left.eq(Mux(last, period, left - 1))
            return over

        announced = due("announcement", Mux(quick != 0, self._quick, self.announcement), self.enable, 1)
        with m.If(announced & (quick != 0)):
            m.d.sync += quick.eq(quick - 1)
        swept = Cat(due(name, getattr(self, name), self.enable) for name in self._sweeps).any()
        published = due("message", self.message, self.publishing & self.enable)

        gap = Signal(self._bits)
        free = Signal()
        m.d.sync += free.eq(gap == 0)
        with m.If(step & (gap != 0)):
            m.d.sync += gap.eq(gap - 1)
        given: Value = ~free  # to one before
        for output, over in (
            (self.announce, announced),
            (self.sweep, swept),
            (self.publish, published),
        ):
            waiting = Signal(name=f"{output.name}_waiting")
            with m.If(over):
                m.d.sync += waiting.eq(1)
            with m.If(waiting & ~given & ~over):
                m.d.comb += output.eq(1)
                m.d.sync += [waiting.eq(0), gap.eq(self.interval), free.eq(0)]
            given = given | waiting
        return m


def every(m: Module, count: int, of: Value) -> Value:
    """High in the cycle after the last of each `count` cycles in which `of` is."""
    over = Signal()
    if count == 1:
        m.d.sync += over.eq(of)
        return over
    bits = (count - 1).bit_length()
    start = (1 << bits) - count
    at, after = Signal(bits, init=start), Signal(bits + 1)  # what overflows needs no comparison
    m.d.comb += after.eq(at + of)
    m.d.sync += [at.eq(Mux(after[-1], start, after)), over.eq(after[-1])]
    return over
