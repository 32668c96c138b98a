"""From a message's bytes to its fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.octets import octets, pick
from roslet.gateware.typed.layout import at_path, message_layout, plan_of
from roslet.gateware.typed.program import Position, Program
from roslet.gateware.words import MessageSignature
from roslet.gen.gateware import CONTENT, COUNT, WORD

if TYPE_CHECKING:
    from roslet.gen.gateware import Bounds, Kind, Path, Plan

BIG = data.StructLayout({"big": 1})
"""What must be known of a message: whether its sender's byte order is big endian."""


class Deserializer(wiring.Component):
    """Takes the fields out of the bytes of messages: XCDR version 1 in both byte orders, without the encapsulation header,
    from behind which alignment counts.

    Ports: `i`, bodies, with `big` in `meta` (which may say more); `o`, messages in the layout of their type (`layout`).
    Octets behind the body are allowed, of padding are any. A bool is true where its octet is not zero.

    Throughput one step of the plan a cycle, as of `Serializer`. `i` is ready while there is no message at `o`, which is
    valid in the cycle after a good end and stays until it is taken. Holds that message, of which what is behind a `length`
    means nothing; where octets are shifted, a word more.

    A message with a bad end is forgotten. So is one with a good end, whole, and counted, where

    - `drop_bound`: a string or a sequence is longer than its bound,
    - `drop_text`: a string has no octet, or its last one is not NUL,
    - `drop_short`: it ends too early.
    """

    def __init__(
        self, kind: Kind | Plan, bounds: Bounds | None = None, meta: data.StructLayout = BIG
    ) -> None:
        self.plan = plan_of(kind, bounds)
        self.layout = message_layout(self.plan)
        if "big" not in dict(meta):
            raise ValueError("meta does not say whether a message is big endian: it has no `big`")
        super().__init__(
            {
                "i": In(MessageSignature(meta)),
                "o": Out(stream.Signature(self.layout)),
                "drop_bound": Out(1),
                "drop_text": Out(1),
                "drop_short": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        plan, i = self.plan, self.i.stream
        program = Program(m, plan)
        run = Signal()  # a step, or padding before it, is being done
        position = Position(m, program, plan, run)
        took = Signal()  # a word
        word, needs_word = self._window(m, program, position, took)
        there = Signal(8 * WORD)
        m.d.comb += there.eq(word)
        word = Signal(8 * WORD)
        m.d.comb += word.eq(self._swapped(program, there))

        count = word[: program.count_bits]
        over, bad_text = Signal(), Signal()
        if any(step.kind == COUNT for step in plan.steps):
            bound = program.column([step.bound + step.text for step in plan.steps], COUNT)
            m.d.comb += over.eq(program.is_count & ((word[program.count_bits :] != 0) | (count > bound)))
        if any(step.text for step in plan.steps):
            last = pick([octet != 0 for octet in octets(word)], (program.octets - 1)[:2])
            empty = program.is_count & (word == 0)
            m.d.comb += bad_text.eq(program.is_text & (empty | (program.is_content & program.last & last)))

        ended = Signal()  # at an end that is taken
        good = Signal()
        extra = Signal()  # a word behind the last that was needed
        too_long = Signal()
        unused = self._unused(m, program, position, run)
        short = ~extra & (i.payload.padding > unused)
        store = Signal()
        m.d.comb += [ended.eq(i.valid & i.payload.end), good.eq(~i.payload.bad)]
        with m.FSM():
            with m.State("FIELDS"):
                with m.If(program.ended):
                    m.d.comb += i.ready.eq(1)
                    with m.If(i.valid):
                        m.d.sync += extra.eq(1)
                    with m.If(ended):
                        m.d.comb += self.drop_short.eq(good & short)
                        with m.If(good & ~short):
                            m.next = "GIVE"
                with m.Else():
                    m.d.comb += [
                        i.ready.eq(needs_word),
                        self.drop_short.eq(needs_word & ended & good),
                        run.eq(~needs_word | (i.valid & ~i.payload.end)),
                        took.eq(needs_word & run),
                        store.eq(run & ~position.pads),
                    ]
                    with m.If(store):
                        program.advance(count, count == 0)
                        with m.If(over | bad_text):
                            m.d.sync += too_long.eq(over)
                            m.next = "DROP"
            with m.State("DROP"):
                m.d.comb += [
                    i.ready.eq(1),
                    self.drop_bound.eq(ended & good & too_long),
                    self.drop_text.eq(ended & good & ~too_long),
                ]
                with m.If(ended):
                    m.next = "FIELDS"
            with m.State("GIVE"):
                m.d.comb += self.o.valid.eq(1)
                with m.If(self.o.ready):
                    m.next = "FIELDS"
        with m.If(i.ready & ended):
            m.d.sync += [program.at.eq(0), position.at.eq(0), extra.eq(0)]
        self._fields(m, program, word, store)
        return m

    def _window(self, m: Module, program: Program, position: Position, took: Value) -> tuple[Value, Value]:
        """The octets from the position on, and whether the next word has some of those that the step needs."""
        taken = self.i.stream.payload.data
        if self.plan.aligned:
            return taken, position.pads | ~program.is_loop
        held = Signal(8 * WORD)
        with m.If(took):
            m.d.sync += held.eq(taken)
        offset = position.at[:2]
        mixed = [
            Mux((offset != 0) & (offset <= lane), old, new)
            for lane, (old, new) in enumerate(zip(octets(held), octets(taken), strict=True))
        ]
        word = pick([Cat(*mixed).rotate_right(8 * n) for n in range(WORD)], offset)
        beyond = (offset + program.octets)[:3] > WORD
        needs = Mux(position.pads, offset == 0, ~program.is_loop & ((offset == 0) | beyond))
        return word, needs

    def _swapped(self, program: Program, word: Value) -> Value:
        """The octets of the step in little endian."""
        lanes = octets(word)
        units = [self._units(n) for n in range(len(self.plan.steps))]
        choices = list(dict.fromkeys(unit for unit in units if unit is not None))
        orders = list(dict.fromkeys([tuple(range(WORD)), *choices]))
        rows = [0 if unit is None else orders.index(unit) for unit in units]
        return word if len(orders) == 1 else self._choose(program, lanes, orders, rows)

    def _choose(
        self, program: Program, lanes: list[Value], orders: list[tuple[int, ...]], rows: list[int]
    ) -> Value:
        order = program.column(rows, COUNT, CONTENT, 0) & self.i.meta.big.replicate(
            (len(orders) - 1).bit_length()
        )
        return pick([Cat(*(lanes[source] for source in one)) for one in orders], order)

    def _units(self, number: int) -> tuple[int, ...] | None:
        """From which octet each octet of a step comes in big endian; None where that does not matter."""
        step = self.plan.steps[number]
        order = list(range(WORD))
        if step.kind == COUNT:
            return tuple(reversed(order))
        for piece in step.pieces:
            for octet in range(piece.octets):
                order[piece.lane + octet] = piece.lane + piece.octets - 1 - octet
        return tuple(order) if step.pieces else None

    def _unused(self, m: Module, program: Program, position: Position, run: Value) -> Value:
        """How many octets of the last word that was needed are not of the message."""
        if len(self.plan.unused) == 1:
            return C(self.plan.unused[0], 2)
        if not self.plan.aligned:
            return (-position.at[:2])[:2]
        unused = Signal(2)
        with m.If(run & ~program.is_loop):
            m.d.sync += unused.eq(-program.octets[:2])
        return unused

    def _fields(self, m: Module, program: Program, word: Value, store: Value) -> None:
        """Registers for what the steps bring."""
        steps, big = self.plan.steps, self.i.meta.big
        now = [store & (program.at == n) for n in range(len(steps))]
        length = Signal(program.count_bits)
        m.d.comb += length.eq(word - 1)  # without the NUL
        fields = m.submodules.fields = (
            Module()
        )  # apart, so that a simulator leaves it alone while it is steady
        parts: dict[Path, dict[int, Signal]] = {}

        def register(path: Path, shift: int, bits: int, enable: Value, value: Value) -> None:
            signal = Signal(bits, name="_".join(map(str, (*path, shift))))
            parts.setdefault(path, {})[shift] = signal
            with m.If(enable):
                m.d.sync += signal.eq(value)

        for n, step in enumerate(steps):
            if step.kind == COUNT:
                value = length if step.text else word
                register(step.path, 0, step.bound.bit_length(), now[n], value)
            for piece in step.pieces:
                bits = len(at_path(self.o.payload, piece.path))
                octets_ = word[8 * piece.lane :][: 8 * piece.octets]
                if bits == 1:
                    register(piece.path, 0, 1, now[n], octets_ != 0)
                    continue
                other = n + 1 if piece.shift == 0 else n - 1
                enable = Mux(big, now[other], now[n]) if piece.wide else now[n]
                register(piece.path, piece.shift, 8 * piece.octets, enable, octets_)
        for path, halves in parts.items():
            value = Cat(*(halves[shift] for shift in sorted(halves)))
            fields.d.comb += at_path(self.o.payload, path).eq(value)
