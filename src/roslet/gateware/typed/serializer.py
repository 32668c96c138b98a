"""From a message's fields to its bytes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.octets import octets, pick
from roslet.gateware.typed.layout import at_path, message_layout, plan_of
from roslet.gateware.typed.program import Position, Program
from roslet.gateware.words import WORD as ITEM
from roslet.gateware.words import MessageSignature
from roslet.gen.gateware import COUNT, LOOP, WORD

if TYPE_CHECKING:
    from roslet.gen.gateware import Bounds, Kind, Plan, Step


class Serializer(wiring.Component):
    """Makes the bytes of messages: XCDR version 1, little endian, without the encapsulation header, from behind which
    alignment counts.

    Ports: `i`, messages in the layout of their type (`layout`); `o`, their bodies. Octets of padding are zero, and so are
    those of the last word that are not of the message.

    Throughput one step of the plan a cycle. A step is a word, for most types; less only for what stands in odd places behind
    a string. Cycles without a word are one for each element of a sequence of messages or strings, and, in the types that
    have such odd places, one for each padding. The first word is valid a cycle after `i`. `i` is taken in the cycle in which
    the last word leaves, or a later one, and no copy of it is kept: the rules of streams hold it so long. The end follows in
    the next cycle, the first word of the next message behind it. Holds one word; where octets are shifted, two.

    `drop_bound`: a `length` is greater than its bound, where it has bits for that. Such a message is taken and ends badly,
    before that length would be sent.
    """

    def __init__(self, kind: Kind | Plan, bounds: Bounds | None = None) -> None:
        self.plan = plan_of(kind, bounds)
        self.layout = message_layout(self.plan)
        super().__init__(
            {
                "i": In(stream.Signature(self.layout)),
                "o": Out(MessageSignature()),
                "drop_bound": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        plan, i = self.plan, self.i
        program = Program(m, plan)
        free, full = Signal(), Signal()
        run = Signal()  # a step is done, or padding before it
        position = Position(m, program, plan, run)
        step = Signal()  # the step is done
        ends = Signal()
        refused = Signal()
        m.d.comb += [
            run.eq(i.valid & free),
            step.eq(run & ~position.pads),
            ends.eq(program.ended & ~position.pads),
            i.ready.eq(run & ends),
            self.drop_bound.eq(run & ends & refused),
        ]
        word, count, none, over = self._word(m, program, position.pads)
        with m.If(step):
            with m.If(program.ended):
                m.d.sync += [program.at.eq(0), refused.eq(0)]
            with m.Elif(over):
                m.d.sync += [program.at.eq(program.end), refused.eq(1)]
            with m.Else():
                program.advance(count, none)

        item = Signal(ITEM)
        with m.If(free):
            m.d.sync += [
                full.eq(i.valid & (position.pads | ~(program.is_loop | over))),
                item.data.eq(word),
                item.end.eq(ends),
                item.bad.eq(ends & refused),
                item.padding.eq(Mux(ends, self._unused(m, program, position, step, run), 0)),
            ]
        (self._words if plan.aligned else self._shifted)(m, item, full, free, position)
        return m

    def _word(self, m: Module, program: Program, pads: Value) -> tuple[Value, Value, Value, Value]:
        """The octets of the step, or zeros if `pads`; of a COUNT what it has, whether that is zero, and whether it is over
        the bound."""
        steps = self.plan.steps
        rows: list[Value] = []
        for one in steps:
            rows.append(rows[-1] if one.kind == LOOP else self._octets(one))  # not sent: any
        fields = m.submodules.fields = Module()  # apart, as the tables are
        raw, word, over = Signal(8 * WORD), Signal(8 * WORD), Signal()
        fields.d.comb += raw.eq(pick(rows, program.at))
        m.d.comb += word.eq(raw)
        counts = [one for one in steps if one.kind == COUNT]
        if any(one.bound & one.bound + 1 for one in counts):  # else no length has bits for more
            bits = max(one.bound.bit_length() for one in counts)
            bound = program.column([one.bound for one in steps], COUNT)
            m.d.comb += over.eq(program.is_count & (raw[:bits] > bound))
        low = program.count_bits
        none = raw[:low] == 0
        if any(one.text for one in counts):  # the NUL is counted
            m.d.comb += word[:low].eq(raw[:low] + (program.is_count & program.is_text))
            none &= ~program.is_text  # not by the sum, which is late
        sent = [(real | ~program.is_content) & ~pads for real in program.real()]
        masked = [Mux(one, octet, 0) for one, octet in zip(sent, octets(word), strict=True)]
        return Cat(*masked), word[:low], none, over

    def _octets(self, step: Step) -> Value:
        lanes: list[Value] = [C(0, 8)] * WORD
        if step.kind == COUNT:
            return Cat(at_path(self.i.payload, step.path), C(0, 8 * WORD))[: 8 * WORD]
        for piece in step.pieces:
            value = Cat(at_path(self.i.payload, piece.path), C(0, 7))  # a bool has one bit
            for octet in range(piece.octets):
                lanes[piece.lane + octet] = value[8 * (piece.shift + octet) :][:8]
        return Cat(*lanes)

    def _unused(self, m: Module, program: Program, position: Position, step: Value, run: Value) -> Value:
        """How many octets of the last word are not of the message."""
        if len(self.plan.unused) == 1:
            return C(self.plan.unused[0], 2)
        unused = Signal(2)
        with m.If(step & ~program.is_loop):
            m.d.sync += unused.eq(-program.octets[:2] if self.plan.aligned else 0)
        if not self.plan.aligned:
            with m.If(run & program.ended):
                m.d.sync += unused.eq(position.padding[:2])
        return unused

    def _words(self, m: Module, item: Any, full: Value, free: Value, position: Position) -> None:
        """Every item is a word."""
        o = self.o.stream
        m.d.comb += [o.payload.eq(item), o.valid.eq(full), free.eq(~full | o.ready)]

    def _shifted(self, m: Module, item: Any, full: Value, free: Value, position: Position) -> None:
        """Items begin anywhere in a word. What is begun of a word waits for the rest, with zeros behind it."""
        o = self.o.stream
        offset, completes = Signal(2), Signal()
        with m.If(free):
            m.d.sync += [offset.eq(position.at[:2]), completes.eq(position.completes)]
        emits = Signal()
        m.d.comb += [
            emits.eq(completes | item.end),
            o.valid.eq(full & emits),
            free.eq(~full | ~emits | o.ready),
        ]
        begun = Signal(8 * (WORD - 1))
        turned = octets(pick([item.data.rotate_left(8 * n) for n in range(WORD)], offset))
        here = [C(1, 1) if lane == WORD - 1 else offset <= lane for lane in range(WORD)]
        joined = [
            Mux(mine, octet, 0) | before
            for mine, octet, before in zip(here, turned, [*octets(begun), C(0, 8)], strict=True)
        ]
        m.d.comb += [o.payload.eq(item), o.payload.data.eq(Cat(*joined))]
        with m.If(full & free & ~item.end):
            for lane in range(WORD - 1):
                left = Mux(here[lane], 0, turned[lane])
                m.d.sync += begun.word_select(lane, 8).eq(Mux(completes, left, joined[lane]))
