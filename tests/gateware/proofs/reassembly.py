"""Reassembly: what goes out was put in, of one datagram, at its place; no gap is ever passed."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Assert, Assume, Cover, Module, Signal, Value

from gateware.formal import DEEP, Bug, Spec, assume_steady
from roslet.gateware import reassembly


class ReassemblySpec(Spec):
    """`present`: an octet that is read was brought by a fragment of this datagram that ended well. `inside`: the memory is
    touched where it is.

    All fragments have one key. The memory is one place of it, `place`, any; what it does elsewhere is free.
    """

    module = reassembly
    fragments, unit = 3, 8  # 24 octets are no power of two, so an address may be outside
    quick, deep = 20, 34
    bugs: tuple[Bug, ...] = (
        Bug("present", "has_last & (units == self.total[_UNIT:])", "has_last"),
        Bug("inside", "above(stop, room)", "above(stop, room + 1)"),
    )

    def block(self) -> Any:
        return self.gates.Reassembly(1, self.fragments, self.unit)

    def properties(self, m: Module) -> None:
        rules = self.assume(m, "i")
        i, mem = self.dut.i, self.dut.ip_payloadsmem
        for name in ("source", "destination", "protocol", "identification"):
            assume_steady(m, i.meta[name])
        count = Signal(5)
        with m.If(rules.ended):
            m.d.sync += count.eq(0)
        with m.Elif(rules.transfer):
            m.d.sync += count.eq(count + ~count.all())
        good = i.stream.valid & i.stream.payload.end & ~i.stream.payload.bad
        m.d.comb += [
            Assume(~good | (count == i.meta.length), "length"),
            Assume(~i.stream.valid | i.stream.payload.end | (count < i.meta.length), "no_more"),
            Assume(~i.stream.valid | i.meta.more | (i.meta.offset != 0), "fragment"),
        ]

        place = self.steady(m, range(self.dut.depth), "place")
        kept, reading = Signal(8), Signal()
        brought, present = Signal(), Signal()  # by the fragment that is passing, by one before
        here = mem.ce & (mem.addr == place)
        m.d.sync += reading.eq(here & ~mem.we)
        with m.If(here & mem.we):
            m.d.sync += [kept.eq(mem.wdata), brought.eq(1)]
        with m.If(rules.ended):
            m.d.sync += [brought.eq(0), present.eq(present | (brought & ~i.stream.payload.bad))]
        over = self.over()
        with m.If(over | self.dut.drop_expired):
            m.d.sync += [present.eq(0), brought.eq(0)]
        m.d.comb += [
            Assume(~reading | (mem.rdata == kept), "memory"),
            Assert(~(here & ~mem.we) | present | brought, "present"),
            Cover(self.dut.drop_overlap, "overlap"),
        ]
        self.given(m, place, kept, over)

    def over(self) -> Value:
        """A datagram has gone out."""
        o = self.dut.o.stream
        over: Value = o.valid & o.ready & o.payload.end
        return over

    def given(self, m: Module, place: Value, kept: Value, over: Value) -> None:
        """What else is said."""
        mem = self.dut.ip_payloadsmem
        m.d.comb += Assert(~mem.ce | (mem.addr < self.dut.depth), "inside")


class DatagramSpec(ReassemblySpec):
    """And, for `inside`: `value`, an octet goes out as it came; `length`, as many go out as `meta` says.

    To see it takes all fragments of a datagram and their way out again: a unit has 2 octets here, and fragments are short.
    """

    fragments, unit = (3 if DEEP else 2), 2
    scale = (("_UNIT = 3", "_UNIT = 1"),)
    quick, deep = (26 if DEEP else 24), 37
    bugs = (
        ReassemblySpec.bugs[0],
        Bug("value", "octet.eq(mem.rdata), has_octet.eq(1)", "octet.eq(mem.rdata + 1), has_octet.eq(1)"),
        Bug("length", "with m.If(following == total):", "with m.If(at == total):"),
    )

    def given(self, m: Module, place: Value, kept: Value, over: Value) -> None:
        i, o = self.dut.i, self.dut.o
        m.d.comb += [
            Assume((i.meta.length < 8) & (i.meta.offset < 4), "short"),
            Assume(self.dut.expiration < 64, "soon"),
        ]
        count = Signal(6)
        with m.If(over):
            m.d.sync += count.eq(0)
        with m.Elif(o.stream.valid & o.stream.ready):
            m.d.sync += count.eq(count + 1)
        m.d.comb += [
            Assert(
                ~o.stream.valid | o.stream.payload.end | (count != place) | (o.stream.payload.data == kept),
                "value",
            ),
            Assert(~over | (count == o.meta.length), "length"),
            Cover(over, "whole"),
        ]


SPECS: tuple[type[Spec], ...] = (ReassemblySpec, DatagramSpec)
