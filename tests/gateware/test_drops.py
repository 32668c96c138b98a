"""Counters of drops against integers."""

from __future__ import annotations

import gc
import random
from typing import Any

import pytest

from gateware.frames import Bench
from roslet.gateware.drops import DropCounters

NAMES = ("drop_length", "drop_checksum", "drop_port", "drop_busy", "drop_oversize")


async def counts(ctx: Any, counters: Any) -> dict[str, int]:
    got = {}
    for name, number in counters.numbers.items():
        ctx.set(counters.reason, number)
        await ctx.tick()
        got[name] = ctx.get(counters.count)
    return got


@pytest.mark.parametrize("names", [NAMES, NAMES[:2], NAMES + tuple("abcdefghijklm")])
def test_what_happens_as_rarely_as_frames_come_is_counted_exactly(names: tuple[str, ...]) -> None:
    rng = random.Random(0)
    bench = Bench(DropCounters(names))
    happened = dict.fromkeys(names, 0)
    got: dict[str, int] = {}

    async def process(ctx: Any) -> None:
        last = dict.fromkeys(names, -1000)
        for cycle in range(2000):
            for name in names:
                high = cycle - last[name] >= len(names) + 2 and rng.random() < 0.1
                ctx.set(getattr(bench.dut.drops, name), high)
                if high:
                    last[name] = cycle
                    happened[name] += 1
            await ctx.tick()
        ctx.set(bench.dut.drops.as_value(), 0)
        await ctx.tick().repeat(len(names) + 2)
        got.update(await counts(ctx, bench.dut))

    bench.drive(process)
    bench.run()
    assert got == happened
    assert min(got.values()) > 20


def test_what_is_high_all_the_time_is_counted_once_a_turn() -> None:
    bench = Bench(DropCounters(NAMES))
    got: dict[str, int] = {}

    async def process(ctx: Any) -> None:
        ctx.set(bench.dut.drops.drop_port, 1)
        await ctx.tick().repeat(100)
        ctx.set(bench.dut.drops.drop_port, 0)
        await ctx.tick().repeat(10)
        got.update(await counts(ctx, bench.dut))

    bench.drive(process)
    bench.run()
    assert got.pop("drop_port") in (20, 21)
    assert set(got.values()) == {0}


def test_a_counter_stops_at_its_greatest_number() -> None:
    bench = Bench(DropCounters(NAMES, width=3))
    got: list[int] = []

    async def process(ctx: Any) -> None:
        for _ in range(10):
            ctx.set(bench.dut.drops.drop_busy, 1)
            await ctx.tick()
            ctx.set(bench.dut.drops.drop_busy, 0)
            await ctx.tick().repeat(10)
            got.append((await counts(ctx, bench.dut))["drop_busy"])

    bench.drive(process)
    bench.run()
    assert got == [1, 2, 3, 4, 5, 6, 7, 7, 7, 7]


@pytest.mark.filterwarnings("ignore::amaranth.hdl.UnusedElaboratable")
def test_counters_of_nothing_are_refused() -> None:
    with pytest.raises(ValueError, match="two names or more, not 1"):
        DropCounters(["drop_port"])
    gc.collect()  # while the warning that it was never used is ignored
