"""Words that are chosen without a multiplexer."""

from __future__ import annotations

import random
from typing import Any

import pytest
from amaranth.hdl import C, Module, Signal
from amaranth.sim import Simulator

from roslet.gateware.gather import gather


@pytest.mark.parametrize("count", [1, 2, 5, 33])
def test_the_word_of_an_index_is_there_a_cycle_later(count: int) -> None:
    dice = random.Random(count)
    m = Module()
    index = Signal(range(count + 2))
    shapes = [dice.choice((8, 32)) for _ in range(count)]
    words = [Signal(shape, name=f"word{n}") for n, shape in enumerate(shapes)]
    word = Signal(32)
    m.d.comb += word.eq(gather(m, [*words, C(1, 32)], index))
    simulator = Simulator(m)
    simulator.add_clock(1e-6)

    async def bench(ctx: Any) -> None:
        for _ in range(200):
            values = [dice.getrandbits(shape) for shape in shapes]
            for signal, value in zip(words, values, strict=True):
                ctx.set(signal, value)
            at = dice.randrange(count + 2)
            ctx.set(index, at)
            await ctx.tick()
            assert ctx.get(word) == [*values, 1, 0][at]

    simulator.add_testbench(bench)
    simulator.run()
