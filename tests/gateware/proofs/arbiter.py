"""FrameArbiter: whole frames of each sender in turn, nobody's octets among another's, and nobody waits for ever."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Assert, Assume, Cover, Module, Signal

from gateware.formal import Bug, Spec
from roslet.gateware import arbiter

COUNT = 2
ORDER = "(now + 1 + step) % count"


class ArbiterSpec(Spec):
    """`whose`: every item is the one that its sender, said by `meta`, has valid, and it goes with it. `whole`: between the
    first item of a frame and its end come only its own. `fair`: who waits is passed by at most once."""

    module = arbiter
    quick, deep = 12, 24
    bugs = (
        Bug("o.steady", "turn.busy & Array", "Array"),
        Bug("o.bad_only_at_end", "o.valid.eq(turn", "o.payload.bad.eq(1), o.valid.eq(turn"),
        Bug(
            "o.meta_steady",
            "turn.end.eq(o.valid & o.ready & o.payload.end)",
            "turn.end.eq(o.valid & o.ready)",
        ),
        Bug("whose", "(turn.owner == n) & o.ready", "o.ready"),
        Bug("whole", "turn.end.eq(o.valid & o.ready & o.payload.end)", "turn.end.eq(o.valid & o.ready)"),
        Bug("fair", ORDER, "(now + step) % count"),
    )

    def block(self) -> Any:
        return self.gates.FrameArbiter(COUNT, 1)

    def properties(self, m: Module) -> None:
        o = self.dut.o
        senders = [self.dut.i0, self.dut.i1]
        for n in range(COUNT):
            self.assume(m, f"i{n}")
            m.d.comb += Assume(senders[n].meta == n, "sender")
        self.check(m, "o")
        taken = o.stream.valid & o.stream.ready
        ended = taken & o.stream.payload.end
        within, owner = Signal(), Signal()
        with m.If(taken):
            m.d.sync += [within.eq(~o.stream.payload.end), owner.eq(o.meta)]
        m.d.comb += Assert(~(within & o.stream.valid) | (o.meta == owner), "whole")
        for n, sender in enumerate(senders):
            goes = sender.stream.valid & sender.stream.ready
            m.d.comb += [
                Assert(goes == (taken & (o.meta == n)), "whose"),
                Assert(~goes | (sender.stream.payload == o.stream.payload), "whose"),
            ]
            passed = Signal(2)  # frames of the other that ended while this one waited
            with m.If(goes | ~sender.stream.valid):
                m.d.sync += passed.eq(0)
            with m.Elif(ended & (o.meta != n) & (passed != 3)):
                m.d.sync += passed.eq(passed + 1)
            m.d.comb += Assert(passed < 2, "fair")
        m.d.comb += Cover(ended & (o.meta == 1), "the_other")


SPECS: tuple[type[Spec], ...] = (ArbiterSpec,)
