"""A ROM in columns: what it gives, and of how many memories it is."""

from __future__ import annotations

import random
from typing import Any

import pytest
from amaranth.back import rtlil
from amaranth.sim import Simulator

from roslet.gateware.rtps.column_rom import ColumnRom


@pytest.mark.parametrize(
    ("depth", "width", "columns"),
    [
        (1, 36, 1),
        (1024, 36, 1),
        (1025, 36, 4),
        (2049, 36, 9),
        (4096, 35, 9),
        (4097, 36, 18),
        (16384, 3, 3),
        (20000, 2, 2),
    ],
)
def test_words_come_a_cycle_later_from_columns_as_narrow_as_a_block_is_deep(
    depth: int, width: int, columns: int
) -> None:
    rng = random.Random(depth)
    words = [rng.getrandbits(width) for _ in range(depth)]
    rom = ColumnRom(words, width)
    assert rtlil.convert(rom, emit_src=False).count("\n  memory ") == columns

    async def bench(ctx: Any) -> None:
        for address in [0, depth - 1, *rng.choices(range(depth), k=50)]:
            ctx.set(rom.en, 1)
            ctx.set(rom.addr, address)
            await ctx.tick()
            assert ctx.get(rom.data) == words[address]
            ctx.set(rom.en, 0)
            ctx.set(rom.addr, rng.randrange(depth))
            await ctx.tick()
            assert ctx.get(rom.data) == words[address], "it stays without `en`"

    simulator = Simulator(rom)
    simulator.add_clock(1e-6)
    simulator.add_testbench(bench)
    simulator.run()
