"""HeaderReader and EthernetTx against a naive model: a count of the frame's octets, and a register for one of a header."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Assert, Assume, Cover, Module, Mux, Signal

from gateware.formal import Bug, Spec, assume_steady
from roslet.gateware import ethernet, header
from roslet.wire.fields import OCTETS, Field

FIELDS = (Field("kind", 0, 8), Field("port", 1, 16), Field("address", 3, 16, OCTETS))
"""Both kinds of field, as few octets as that takes: deep enough for several frames within a proof's cycles."""
SIZE = 5

SHIFT = "rest.eq(Cat(rest[8:], i.payload.data))"
PASS = "o.valid.eq(i.valid), i.ready.eq(o.ready)]"
READER = """
            with m.If(i.valid & o.ready & i.payload.end):
                m.d.sync += at.eq(0)
        with m.Else():
            m.d.comb += i.ready.eq(1)"""
"""What passes, in the reader."""

VALID = "m.d.comb += o.valid.eq(i.valid)"
INSERT = "m.d.comb += o.payload.data.eq(pick("
THROUGH = "m.d.comb += [o.payload.eq(i.payload), i.ready.eq(o.ready)]"
ON = "with m.Elif(at != HOP + len(own)):\n                m.d.sync += at.eq(at + 1)"


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
            "o.payload.eq(i.payload)",
            "o.payload.bad.eq(i.payload.data[0])",
        ),
        Bug("o.meta_steady", PASS, f"{PASS}; m.d.sync += {SHIFT}"),
        Bug("drop_short", "self.drop_short.eq(~i.payload.bad)", "self.drop_short.eq(1)"),
        Bug("port", "wire_order(field, value)", "value"),
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
    """A frame gets our address and its type behind its destination, octet by octet, and passes otherwise."""

    module = ethernet
    quick, deep = 20, 40
    bugs = (
        Bug("o.steady", VALID, VALID.replace("i.valid)", "i.valid & i.payload.data[0])")),
        Bug("o.bad_only_at_end", INSERT, f"m.d.comb += o.payload.bad.eq(i.payload.bad); {INSERT}"),
        Bug("holds", INSERT, f"m.d.comb += i.ready.eq(o.ready); {INSERT}"),
        Bug("header", ON, ON.replace("at + 1", "at + 2")),
        Bug("passes", THROUGH, THROUGH.replace("i.payload)", "Cat(i.payload.data, i.payload.end, 0))")),
    )

    def block(self) -> Any:
        return self.gates.EthernetTx()

    def properties(self, m: Module) -> None:
        self.assume(m, "i")
        self.check(m, "o")
        i, o, meta = self.dut.i.stream, self.dut.o.stream, self.dut.i.meta
        mac = self.dut.addresses.mac
        at = Signal(range(15))
        own = [*(mac.word_select(n, 8) for n in range(6)), meta.type[8:], meta.type[:8]]
        with m.If(o.valid & o.ready):
            m.d.sync += at.eq(Mux(o.payload.end, 0, at + (at < 14)))
        assume_steady(m, mac)
        m.d.comb += Assume(~i.valid | ~i.payload.end | (at >= 6), "destination")
        with m.If((at >= 6) & (at < 14)):
            m.d.comb += Assert(~i.ready & (o.valid == i.valid), "holds")
        with m.Else():
            m.d.comb += [
                Assert((o.valid == i.valid) & (o.ready == i.ready), "passes"),
                Assert(o.payload.as_value() == i.payload.as_value(), "passes"),
            ]
        for n, octet in enumerate(own, 6):
            with m.If(o.valid & (at == n)):
                m.d.comb += Assert((o.payload.data == octet) & ~o.payload.end, "header")


SPECS: tuple[type[Spec], ...] = (ReaderSpec, WriterSpec)
