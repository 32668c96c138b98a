"""Goes through the steps of a plan: what serialisers and deserialisers share.

Every step has a number of its own, those of each element of an array too: with all of a message's bits at hand the choice
among them is by far the dearest, and a number that is the step's and the word's at once makes it the cheapest.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from amaranth.hdl import C, Cat, Module, Mux, Signal, Value, unsigned

from roslet.gateware.octets import pick
from roslet.gen.gateware import CONTENT, COUNT, FIXED, LOOP, WORD, Plan

if TYPE_CHECKING:
    pass


class Program:
    """The number of the step, `at`, and what is known of the step; `ended` behind the last one.

    `count_bits` are enough for every uint32 that counts what follows, as it is sent.
    """

    def __init__(self, m: Module, plan: Plan) -> None:
        self.m = m
        self.steps = steps = plan.steps
        self.end = len(steps)
        self.at = Signal(range(self.end + 1))
        self.ended = Signal()
        self.tables = m.submodules.tables = Module()  # apart, so that a simulator works them out once a step
        self.tables.d.comb += self.ended.eq(self.at == self.end)
        counts = [step for step in steps if step.kind == COUNT]
        self.count_bits = max([(step.bound + step.text).bit_length() for step in counts], default=1)
        content = [step for step in counts if step.level is None]
        self._left_bits = max(
            [((step.bound << step.scale) + step.text).bit_length() for step in content], default=1
        )
        self.is_count = self._flags([step.kind == COUNT for step in steps])
        self.is_content = self._flags([step.kind == CONTENT for step in steps])
        self.is_loop = self._flags([step.kind == LOOP for step in steps])
        self.is_text = self._flags([step.text for step in steps])
        # Octets of content that are left, this step's too.
        self._left = left = Signal(self._left_bits)
        wide = Cat(left, C(0, 3))
        self.last = Signal()
        m.d.comb += self.last.eq((wide[3:] == 0) & ~(wide[2] & (wide[0] | wide[1])))
        few = Mux(self.last, wide[:3], WORD)
        fixed = self.column([step.octets for step in steps], FIXED, COUNT, LOOP)
        self.octets = Signal(3)
        """How many octets the step is."""
        m.d.comb += self.octets.eq(Mux(self.is_content, few, fixed) if content else fixed)
        self._levels = [
            Signal(max([step.bound for step in counts if step.level == level]).bit_length())
            for level in range(
                1 + max([-1 if step.level is None else step.level for step in counts], default=-1)
            )
        ]

    def column(self, values: Sequence[int], *kinds: int) -> Value:
        """One of `values`, by the step; of steps that are not of `kinds`, if there are any, anything."""
        rows = []
        known = [
            value for value, step in zip(values, self.steps, strict=True) if step.kind in kinds or not kinds
        ]
        value = known[0] if known else 0
        for own, step in zip(values, self.steps, strict=True):
            if step.kind in kinds or not kinds:
                value = own
            rows.append(value)
        if len(set(rows)) <= 1:
            return C(rows[0])
        width = max(rows).bit_length()
        return self._named(pick([C(row, unsigned(width)) for row in rows], self.at))

    def _named(self, value: Value) -> Value:
        found = Signal(len(value), name="column")
        self.tables.d.comb += found.eq(value)
        return found

    def _flags(self, values: Sequence[bool]) -> Value:
        """One of `values`, by the step; false behind the last one."""
        if not any(values):
            return C(0, 1)
        return self._named(pick([C(int(value), 1) for value in values], self.at) & ~self.ended)

    def real(self) -> list[Value]:
        """Of each octet of a content step, whether it is of the content; a NUL is not."""
        left = Cat(self._left, C(0, 3))
        four = left[2:] != 0
        at_least = [C(1, 1), four | left[1], four | (left[1] & left[0]), four, ~self.last]
        return [Mux(self.is_text, at_least[lane + 1], at_least[lane]) for lane in range(WORD)]

    def advance(self, count: Value, none: Value) -> None:
        """Go on to the next step, `count` being what a COUNT has, and `none` whether that is zero; called within the
        condition that the step is done."""
        m, steps = self.m, self.steps
        jump = self.column([step.jump for step in steps], COUNT, CONTENT, LOOP)
        leaves = Signal()
        m.d.sync += self.at.eq(Mux(leaves, jump, self.at + 1))
        with m.If(self.is_content):
            m.d.comb += leaves.eq(self.last)
            m.d.sync += self._left.eq(self._left - WORD)
        with m.If(self.is_count):
            m.d.comb += leaves.eq(none)
            scales = sorted({step.scale for step in steps if step.kind == COUNT and step.level is None})
            if scales:
                row = [scales.index(step.scale) if step.scale in scales else 0 for step in steps]
                scaled = [count << scale for scale in scales]
                m.d.sync += self._left.eq(pick(scaled, self.column(row, COUNT)))
        for number, level in enumerate(self._levels):
            with m.If(self._flags([step.kind == COUNT and step.level == number for step in steps])):
                m.d.sync += level.eq(count)
            with m.If(self._flags([step.kind == LOOP and step.level == number for step in steps])):
                m.d.comb += leaves.eq(level == 1)
                m.d.sync += level.eq(level - 1)


class Position:
    """Follows the position, as far as it matters: `run` says that a step, or padding before it, is being done.

    `padding` are octets to be done before the step, 4 at most at a time; `pads` is whether there are any. Where every step
    begins with a word the rest of a word needs none. Else `at` is the position modulo 8, and `completes` is whether a word
    is complete afterwards.
    """

    def __init__(self, m: Module, program: Program, plan: Plan, run: Value) -> None:
        steps, aligns = plan.steps, {step.align for step in plan.steps}
        self.padding = padding = Signal(3)
        self.at = at = Signal(3)
        self.pads = C(0, 1)
        size = Mux(padding != 0, padding, program.octets)
        self.completes = (at[:2] + size)[2]
        align_8 = program.column([int(step.align > WORD) for step in steps]) & ~program.ended
        if plan.aligned:
            if max(aligns) > WORD:
                self.pads = padding[2]
                m.d.comb += padding[2].eq(align_8 & at[2])
                with m.If(run & (self.pads | ~program.is_loop)):
                    m.d.sync += at[2].eq(~at[2] & ~program.ended)
            return
        self.pads = padding != 0
        align_2 = program.column([int(step.align == 2) for step in steps]) & ~program.ended
        align_4 = program.column([int(step.align >= WORD) for step in steps]) | program.ended
        with m.If(align_4 & (at[:2] != 0)):
            m.d.comb += padding.eq(-at[:2] & (WORD - 1))
        with m.Elif(align_8 & at[2]):
            m.d.comb += padding.eq(WORD)
        with m.Elif(align_2 & at[0]):
            m.d.comb += padding.eq(1)
        with m.If(run):
            m.d.sync += at.eq(at + size)
            with m.If(program.ended & ~self.pads):
                m.d.sync += at.eq(0)
