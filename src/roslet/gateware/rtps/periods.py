"""When a participant does what it does by the clock, by periods that are ports. The manual, Table A-2."""

from __future__ import annotations

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value, signed
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.octets import pick

QUICK = 5
"""Announcements at once at start, QUICK_PERIOD seconds apart."""
QUICK_PERIOD = 0.1
BITS = 32
PRESCALER_BITS = 16


class Periods(wiring.Component):
    """Pulses of one cycle, while `enable` is high: `tick` each `second` cycles; `announce`, `sweep`, `publish` each so many
    steps as their period says, where a step is `prescaler_div` cycles; `sweep` has several periods, any of which counts.

    The first announcement and the first sweep come at once, and the next announcements `quick` steps apart: peers that start
    together find each other although some are lost. The first `publish` comes a period after `publishing` has risen, and
    none while it is low.

    Of what is due at the same time one comes after the other, `interval` steps apart. What is due again before it came comes
    once. A period of 0 is one of 1, and so is a `prescaler_div` of 0. Periods have `bits`. One adder counts all of them, by
    turns: a pulse comes up to 100 cycles after its step, and periods that have fewer cycles end as often as that is done.
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
        divided, step = Signal(PRESCALER_BITS), Signal()
        m.d.comb += step.eq(self.enable & (divided[1:] == 0))
        with m.If(self.enable):
            m.d.sync += [
                cycles.eq(Mux(self.tick, 0, cycles + 1)),
                divided.eq(Mux(step, self.prescaler_div, divided - 1)),
            ]

        # Of each period, and of the interval, how many steps are left, as a negative number: it is over when it is not one.
        outputs = {
            "announcement": self.announce,
            **dict.fromkeys(self._sweeps, self.sweep),
            "message": self.publish,
        }
        names = [*outputs, "interval"]
        shape = signed(self._bits + 1)
        m.submodules.left = left = memory.Memory(
            shape=shape, depth=len(names), init=[], attrs={"ram_style": "block"}
        )
        read, write = left.read_port(), left.write_port()
        at = Signal(range(len(names)))  # which of them
        ends, again = Signal(), Signal()  # it begins again: next, now
        running, fresh = Signal(), Signal(init=1)  # in this round; nothing is in the memory yet
        steps, passed = Signal(8), Signal(8)  # in this round, and in the one before
        quick = Signal(range(QUICK + 1), init=QUICK)
        is_message = at == names.index("message")
        stopped = fresh | (is_message & ~self.publishing)
        waiting = {name: Signal(name=f"{name}_waiting") for name in ("announce", "sweep", "publish")}
        periods = [getattr(self, name) for name in names]
        periods[0] = Mux(quick != 0, self._quick, periods[0])
        # What was left; a period's complement; what is left then
        before, less, after = Signal(shape), Signal(shape), Signal(shape)
        m.d.comb += [read.addr.eq(at), write.addr.eq(at), write.data.eq(after)]
        m.d.sync += [steps.eq(steps + step), before.eq(read.data)]
        m.d.sync += less.eq(~Cat(pick(periods, at), C(0, 1)))
        with m.If(~again):
            m.d.sync += less.eq(0)
        with m.FSM() as fsm:
            with m.State("READ"):
                m.next = "LOOK"
            with m.State("LOOK"):
                m.next = "COUNT"
            with m.State("COUNT"):
                m.d.sync += after.eq((Cat(C(1, 1), before) + Cat(again, less | Mux(again, 0, passed)))[1:])
                m.next = "STORE"
            with m.State("STORE"):
                m.d.comb += write.en.eq(1)
                with m.If(~again & ~after[-1]), m.Switch(at):
                    for n, output in enumerate(outputs.values()):
                        with m.Case(n), m.If(stopped | (passed != 0)):
                            m.d.comb += ends.eq(1)
                            with m.If(running & ~(is_message & stopped)):
                                m.d.sync += waiting[output.name].eq(1)
                    with m.Default():
                        given: Value = ~running  # to one before
                        for output in (self.announce, self.sweep, self.publish):
                            waits = waiting[output.name]
                            with m.If(waits & ~given):
                                m.d.comb += [output.eq(1), ends.eq(1)]
                                m.d.sync += waits.eq(0)
                            given = given | waits
                with m.If(again & running & (at == 0) & (quick != 0)):
                    m.d.sync += quick.eq(quick - 1)
                m.d.sync += again.eq(ends)
                m.next = "READ"
                with m.If(~ends):
                    m.d.sync += at.eq(at + 1)
                    with m.If(at == len(names) - 1):
                        m.d.sync += [at.eq(0), running.eq(self.enable), fresh.eq(fresh & ~running)]
                        m.d.sync += [passed.eq(steps), steps.eq(step)]
        # What is late is not more than due.
        with m.If(fsm.ongoing("COUNT") & ~again & (stopped | ~before[-1])):
            m.d.sync += after.eq(0)
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
