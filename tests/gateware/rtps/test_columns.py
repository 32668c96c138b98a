"""A ROM in columns: what it gives, and of how many memories it is."""

from __future__ import annotations

import random
from typing import Any

import pytest
from amaranth.hdl import Cat, Module, Signal
from amaranth.sim import Simulator

from roslet.gateware.rtps.columns import rom_columns


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
    m = Module()
    reads = rom_columns(m, words, width)
    addr, en, data = Signal(range(depth)), Signal(), Signal(width)
    m.d.comb += data.eq(Cat(read.data for read in reads))
    for read in reads:
        m.d.comb += [read.addr.eq(addr), read.en.eq(en)]
    assert len(reads) == columns

    async def bench(ctx: Any) -> None:
        for address in [0, depth - 1, *rng.choices(range(depth), k=50)]:
            ctx.set(en, 1)
            ctx.set(addr, address)
            await ctx.tick()
            assert ctx.get(data) == words[address]
            ctx.set(en, 0)
            ctx.set(addr, rng.randrange(depth))
            await ctx.tick()
            assert ctx.get(data) == words[address], "it stays without `en`"

    simulator = Simulator(m)
    simulator.add_clock(1e-6)
    simulator.add_testbench(bench)
    simulator.run()
