"""HeaderReader and HeaderWriter against a naive model: a count of the frame's octets, and a register for one of a header."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Assert, Cover, Module, Mux, Signal

from gateware.formal import Bug, Spec
from roslet.gateware import header
from roslet.wire.fields import OCTETS, Field

FIELDS = (Field("kind", 0, 8), Field("port", 1, 16), Field("address", 3, 16, OCTETS))
"""Both kinds of field, as few octets as that takes: deep enough for several frames within a proof's cycles."""
SIZE = 5

PASS = "o.valid.eq(i.valid), i.ready.eq(o.ready)]"
READER = """
            with m.If(i.valid & o.ready & i.payload.end):
                m.d.sync += at.eq(0)
        with m.Else():
            m.d.comb += i.ready.eq(1)"""
"""What passes, in the reader; the writer has the same words."""
WRITER = f"m.d.comb += [o.payload.eq(i.payload), {PASS}"

HEADER = "m.d.comb += [o.valid.eq(i.valid), o.payload.data.eq(pick(header, at))]"


class ReaderSpec(Spec):
    """A frame gives what is behind its header as it comes; or nothing, and is counted unless it is bad."""

    module = header
    quick, deep = 20, 40
    bugs = (
        Bug("passes", f"{PASS}{READER}", f"{PASS.replace('o.ready)', '1)')}{READER}"),
        Bug("takes", "m.d.comb += i.ready.eq(1)", "m.d.comb += i.ready.eq(o.ready)"),
        Bug("o.steady", f"{PASS}{READER}", f"{PASS}{READER.replace(' & o.ready', '')}"),
        Bug(
            "o.bad_only_at_end",
            "[o.payload.eq(i.payload), self",
            "[o.payload.bad.eq(i.payload.data[0]), self",
        ),
        Bug("o.meta_steady", "(at == field.offset + n)", "(at >= field.offset + n)"),
        Bug("drop_short", "self.drop_short.eq(~i.payload.bad)", "self.drop_short.eq(1)"),
        Bug("port", "enumerate(kept)", "enumerate(reversed(kept))"),
        Bug("address", "if field.kind == OCTETS:", "if field.kind != OCTETS:"),
        Bug("below", "self.o.meta.below.eq(self.i.meta)", "self.o.meta.below.eq(self.i.meta[:-1])"),
    )

    def block(self) -> Any:
        return self.gates.HeaderReader(FIELDS, ("port", "address"), below=4)

    def properties(self, m: Module) -> None:
        self.assume(m, "i")
        self.check(m, "o")
        i, o = self.dut.i.stream, self.dut.o.stream
        at = Signal(range(SIZE + 1))
        octets = [Signal(8, name=f"octet{n}") for n in range(SIZE)]
        inside = at < SIZE
        taken = i.valid & i.ready
        with m.If(taken):
            m.d.sync += at.eq(Mux(i.payload.end, 0, at + inside))
            for n, octet in enumerate(octets):
                with m.If(at == n):
                    m.d.sync += octet.eq(i.payload.data)
        with m.If(inside):
            m.d.comb += Assert(i.ready & ~o.valid, "takes")
        with m.Else():
            m.d.comb += [
                Assert((o.valid == i.valid) & (o.ready == i.ready), "passes"),
                Assert(o.payload.as_value() == i.payload.as_value(), "passes"),
                Assert(self.dut.o.meta.below == self.dut.i.meta, "below"),
                Assert(self.dut.o.meta.header.port == octets[1] << 8 | octets[2], "port"),
                Assert(self.dut.o.meta.header.address == octets[4] << 8 | octets[3], "address"),
            ]
        short = taken & inside & i.payload.end & ~i.payload.bad
        m.d.comb += [Assert(self.dut.drop_short == short, "drop_short"), Cover(short, "short")]


class WriterSpec(Spec):
    """A frame gets its header, octet by octet, and passes behind it."""

    module = header
    quick, deep = 20, 40
    bugs = (
        Bug("o.steady", HEADER, HEADER.replace("(i.valid)", "(i.valid & i.payload.data[0])")),
        Bug("o.bad_only_at_end", HEADER, HEADER.replace("]", ", o.payload.bad.eq(i.payload.bad)]")),
        Bug("holds", HEADER, HEADER.replace("]", ", i.ready.eq(o.ready)]")),
        Bug(
            "header", "m.d.sync += at.eq(at + 1)\n        return", "m.d.sync += at.eq(at + 2)\n        return"
        ),
        Bug("passes", WRITER, WRITER.replace("i.payload)", "Cat(i.payload.data, i.payload.end, 0))")),
    )

    def block(self) -> Any:
        return self.gates.HeaderWriter(FIELDS, {"kind": 0xA5})

    def properties(self, m: Module) -> None:
        self.assume(m, "i")
        self.check(m, "o")
        i, o, meta = self.dut.i.stream, self.dut.o.stream, self.dut.i.meta
        at = Signal(range(SIZE + 1))
        octets = [0xA5, meta.port[8:], meta.port[:8], meta.address[:8], meta.address[8:]]
        with m.If(o.valid & o.ready):
            m.d.sync += at.eq(Mux(o.payload.end, 0, at + (at < SIZE)))
        with m.If(at < SIZE):
            m.d.comb += Assert(~i.ready & (o.valid == i.valid), "holds")
        with m.Else():
            m.d.comb += [
                Assert((o.valid == i.valid) & (o.ready == i.ready), "passes"),
                Assert(o.payload.as_value() == i.payload.as_value(), "passes"),
            ]
        for n, octet in enumerate(octets):
            with m.If(o.valid & (at == n)):
                m.d.comb += Assert((o.payload.data == octet) & ~o.payload.end, "header")


SPECS: tuple[type[Spec], ...] = (ReaderSpec, WriterSpec)
