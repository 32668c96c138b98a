"""What is done by the clock comes as often as its period says, and one after the other."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from gateware.words import WordBench
from roslet.gateware.rtps.periods import QUICK, Periods

LATE = 100
"""Cycles by which a pulse may come after its step: the contract's."""
OUTPUTS = ("tick", "announce", "sweep", "publish")
SETTINGS = {
    "enable": 1, "publishing": 1, "prescaler_div": 200,
    "interval": 1, "announcement": 50, "sweep0": 30, "sweep1": 70, "message": 20,
}  # fmt: skip


class Clock:
    """`Periods` with these settings for so many cycles, and in which of them each pulse came. `changes`, by the cycle."""

    def __init__(
        self, cycles: int, changes: dict[int, dict[str, int]] | None = None, **settings: int
    ) -> None:
        self.times: dict[str, list[int]] = {name: [] for name in OUTPUTS}
        bench = WordBench(Periods(2000, 5, bits=12), stalls=0)
        dut = bench.dut

        async def process(ctx: Any) -> None:
            for name, value in {**SETTINGS, **settings}.items():
                ctx.set(getattr(dut, name), value)
            for cycle in range(cycles):
                for name, value in (changes or {}).get(cycle, {}).items():
                    ctx.set(getattr(dut, name), value)
                _, _, *high = await ctx.tick().sample(*(getattr(dut, name) for name in OUTPUTS))
                for name, now in zip(OUTPUTS, high, strict=True):
                    if now:
                        self.times[name].append(cycle)

        bench.drive(process)
        bench.run(cycles=cycles + 10)

    def steps(self, name: str, step: int = 200) -> list[int]:
        """How many steps lie between its pulses."""
        times = self.times[name]
        gaps = [after - before for before, after in itertools.pairwise(times)]
        assert all(min(gap % step, -gap % step) <= LATE for gap in gaps), gaps
        return [round(gap / step) for gap in gaps]


def test_each_comes_as_often_as_its_period_says() -> None:
    clock = Clock(36_000, interval=0, sweep0=30, sweep1=4000)
    assert clock.times["announce"][0] <= LATE
    assert clock.steps("announce")[:QUICK] == [5] * QUICK
    assert set(clock.steps("announce")[QUICK:]) == {50}
    assert set(clock.steps("sweep")) == {30}
    assert set(clock.steps("publish")) == {20}
    assert [after - before for before, after in itertools.pairwise(clock.times["tick"])] == ([2000] * 17)


def test_either_period_of_sweeps_counts() -> None:
    clock = Clock(40_000, interval=0)
    first = clock.times["sweep"][0]
    due = sorted({30 * n for n in range(11)} | {70 * n for n in range(5)})
    assert [round((time - first) / 200) for time in clock.times["sweep"]] == [n for n in due if n < 300][
        : len(clock.times["sweep"])
    ]
    assert len(clock.times["sweep"]) >= 8


def test_no_period_drifts() -> None:
    clock = Clock(40_000, prescaler_div=64, interval=0, announcement=3, message=7)
    for name, period in (("announce", 3), ("publish", 7)):
        times = clock.times[name][QUICK + 1 :]
        assert all(abs(time - times[0] - 64 * period * n) <= LATE for n, time in enumerate(times))


def test_what_is_due_together_comes_an_interval_apart() -> None:
    clock = Clock(20_000, interval=3, announcement=10, sweep0=10, sweep1=10, message=10)
    every = sorted(time for name in OUTPUTS[1:] for time in clock.times[name])
    gaps = [after - before for before, after in itertools.pairwise(every)]
    assert min(gaps) >= 3 * 200 - LATE
    assert all(len(clock.times[name]) >= 7 for name in OUTPUTS[1:])


def test_messages_come_a_period_after_publishing_rises_and_never_before() -> None:
    changes = {5_000: {"publishing": 1}, 20_000: {"publishing": 0}, 30_000: {"publishing": 1}}
    clock = Clock(40_000, changes, publishing=0, interval=0)
    times = clock.times["publish"]
    rises = [
        (time - rise) / 200
        for rise, end in ((5_000, 20_000), (30_000, 40_000))
        for time in times
        if rise <= time < end
    ]
    assert len(rises) == len(times)
    assert rises == pytest.approx([20, 40, 60, 20, 40], abs=1.5)


def test_nothing_comes_while_it_is_not_enabled() -> None:
    clock = Clock(16_000, {10_000: {"enable": 1}}, enable=0)
    assert all(min(clock.times[name]) >= 10_000 for name in OUTPUTS)
    assert clock.times["announce"][0] <= 10_000 + LATE


@pytest.mark.parametrize("divider", [0, 1, 2, 7])
def test_steps_that_are_quicker_than_what_counts_them_are_counted(divider: int) -> None:
    step = max(1, divider)
    clock = Clock(6_000, prescaler_div=divider, announcement=300, interval=0)
    times = clock.times["announce"][QUICK + 1 :]
    assert all(abs(time - times[0] - step * 300 * n) <= LATE for n, time in enumerate(times))
    assert len(times) >= 6_000 // (step * 300) - 2


def test_periods_of_nothing_come_again_and_again() -> None:
    clock = Clock(12_000, announcement=0, sweep0=0, sweep1=0, message=0, interval=0)
    for name in OUTPUTS[1:]:
        gaps = [after - before for before, after in itertools.pairwise(clock.times[name][QUICK + 1 :])]
        assert len(gaps) > 30 and max(gaps) <= 200 + LATE, name


def test_a_period_that_cannot_be_counted_is_refused() -> None:
    with pytest.raises(ValueError, match="a second of 0 cycles and a period of 5 steps cannot be counted"):
        Periods(0, 5)
