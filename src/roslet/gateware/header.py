"""Fixed headers between a stream of octets and registers, by the field tables of `wire`.

A field is a number, or octets in the order of the wire, the first in the lowest bits, as its kind in the table says.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from amaranth.hdl import Cat, Module, ShapeLike, Signal, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.stream import FrameSignature
from roslet.wire.fields import OCTETS, Field


def header_layout(fields: tuple[Field, ...], keep: Iterable[str]) -> data.StructLayout:
    """The layout of the fields named, in the order of the table. Raises ValueError for a name that is not in it."""
    wanted = set(keep)
    unknown = wanted - {field.name for field in fields}
    if unknown:
        raise ValueError(f"no such fields: {', '.join(sorted(unknown))}")
    return data.StructLayout({field.name: field.bits for field in fields if field.name in wanted})


def wire_order(field: Field, value: Value) -> Value:
    """The octets of a field's value in the order of the wire, the first in the lowest bits; and back."""
    if field.kind == OCTETS:
        return value
    return Cat(value.word_select(n, 8) for n in reversed(range(field.bits // 8)))


class HeaderReader(wiring.Component):
    """Takes the header off each frame.

    Ports: `i`, frames with `below` as their meta (none where None); `o`, what follows the header, with the kept fields
    beside it: `o.meta.header`, and `o.meta.below`, which is `i.meta` passed through. `at`, which octet of the header comes
    next, or their number behind it. `drop_short`: a good frame ended within its header.

    Throughput one octet a cycle. Header octets are taken in one cycle each; the rest passes without a register, so `o` is
    valid in the cycle in which `i` is. Holds the header from the first field on that is kept, in a shift register. A frame
    that ends within its header gives nothing.
    """

    def __init__(
        self, fields: tuple[Field, ...], keep: Iterable[str], below: ShapeLike | None = None
    ) -> None:
        self._fields = fields
        self._header = header_layout(fields, keep)
        self._size = fields[-1].offset + fields[-1].bits // 8
        self._below = below
        meta: dict[str, Any] = {"header": self._header}
        if below is not None:
            meta["below"] = below
        super().__init__(
            {
                "i": In(FrameSignature(below)),
                "o": Out(FrameSignature(data.StructLayout(meta))),
                "at": Out(range(self._size + 1)),
                "drop_short": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        i, o = self.i.stream, self.o.stream
        at = self.at
        kept = [field for field in self._fields if field.name in self._header.members]
        first = kept[0].offset
        rest = Signal(8 * (self._size - first))
        m.d.comb += o.payload.eq(i.payload)
        for field in kept:
            value = rest[8 * (field.offset - first) :][: field.bits]
            m.d.comb += self.o.meta.header[field.name].eq(wire_order(field, value))
        if self._below is not None:
            m.d.comb += self.o.meta.below.eq(self.i.meta)
        with m.If(at == self._size):
            m.d.comb += [o.valid.eq(i.valid), i.ready.eq(o.ready)]
            with m.If(i.valid & o.ready & i.payload.end):
                m.d.sync += at.eq(0)
        with m.Else():
            m.d.comb += i.ready.eq(1)
            with m.If(i.valid):
                m.d.sync += [at.eq(at + 1), rest.eq(Cat(rest[8:], i.payload.data))]
                with m.If(i.payload.end):
                    m.d.sync += at.eq(0)
                    m.d.comb += self.drop_short.eq(~i.payload.bad)
        return m
