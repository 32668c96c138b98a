"""How often something was dropped, and for which reason."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from amaranth.hdl import Module, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out


def drop_outputs(blocks: Mapping[str, Any]) -> dict[str, tuple[str, str]]:
    """`drop_<block>_<reason>` for each output `drop_<reason>` of the blocks: the block and its output by that name."""
    return {
        f"drop_{block}_{name.removeprefix('drop_')}": (block, name)
        for block, component in blocks.items()
        for name in component.signature.members
        if name.startswith("drop_")
    }


class DropCounters(wiring.Component):
    """Counts the cycles in which each of some signals is high, and stops at the greatest number.

    Ports: `drops`, a struct of one bit for each of `names`; `reason`, the place of a name among them; `count`, in the next
    cycle, what has been counted for it. `numbers` has the place by name.

    One counter after another is looked after, one each cycle; a signal that is high again before its turn is counted once.
    So what happens at most once in as many cycles as there are names, and two more, as what happens to whole frames does, is
    counted exactly, and stands in `count` as many cycles later. The counters are a memory, with one adder for all: as
    registers, each with an adder, twenty take more than three times the logic.
    """

    def __init__(self, names: Iterable[str], width: int = 16) -> None:
        self.numbers = {name: number for number, name in enumerate(names)}
        if len(self.numbers) < 2:
            raise ValueError(f"counters are for two names or more, not {len(self.numbers)}")
        if width < 1:
            raise ValueError(f"a counter has at least one bit, not {width}")
        self._width = width
        super().__init__(
            {
                "drops": In(data.StructLayout(dict.fromkeys(self.numbers, 1))),
                "reason": In(range(len(self.numbers))),
                "count": Out(width),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        many = len(self.numbers)
        m.submodules.counts = counts = memory.Memory(
            shape=self._width, depth=many, init=[], attrs={"ram_style": "block"}
        )
        looked_at = counts.read_port()
        written = counts.write_port()
        asked_for = counts.read_port(transparent_for=(written,))
        m.d.comb += [asked_for.addr.eq(self.reason), self.count.eq(asked_for.data)]

        waiting = Signal(many)
        turn = Signal(range(many))
        mine = Signal(many, init=1)  # the same, one bit for each: cheaper than to compare
        happened = Signal()
        m.d.sync += [
            turn.eq(turn + 1),
            mine.eq(mine.rotate_left(1)),
            written.addr.eq(turn),
            waiting.eq(self.drops.as_value() | (waiting & ~mine)),
            happened.eq((waiting & mine).any()),
        ]
        with m.If(mine[many - 1]):
            m.d.sync += turn.eq(0)
        m.d.comb += [
            looked_at.addr.eq(turn),
            written.data.eq(looked_at.data + 1),
            written.en.eq(happened & ~looked_at.data.all()),
        ]
        return m
