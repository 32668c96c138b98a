"""Round trips of every stack, in rounds in which each has its turn, so that what else the machine does falls on all."""

from __future__ import annotations

import os
import signal
import statistics
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from roslet.cli.bench.paper import COORDINATE, SIZES
from roslet.cli.process import Failed, Process

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from roslet.cli.bench.stacks import Network, Stack

COUNT = 200
"""Messages of each size in each round, as in the paper."""
WARM_UP = 20
# Seconds for a program to be there, and for one size beyond what the program itself waits.
START, CASE = 30.0, 60.0


@dataclass
class Measured:
    """The round trips of one stack at one size: microseconds by round."""

    rounds: list[list[float]] = field(default_factory=list)
    lost: int = 0

    def all(self) -> list[float]:
        """Of every round."""
        return [value for one in self.rounds for value in one]

    def summary(self) -> dict[str, float]:
        """In microseconds: mean, median, quartiles, 99th percentile, and the least and greatest median of a round."""
        values = sorted(self.all())
        medians = [statistics.median(one) for one in self.rounds if one]
        return {
            "count": len(values),
            "lost": self.lost,
            "mean": statistics.fmean(values),
            "min": values[0],
            "quartile1": quantile(values, 0.25),
            "median": statistics.median(values),
            "quartile3": quantile(values, 0.75),
            "p99": quantile(values, 0.99),
            "max": values[-1],
            "lowest round": min(medians),
            "highest round": max(medians),
        }


def quantile(ordered: Sequence[float], part: float) -> float:
    """Of sorted values, interpolated."""
    place = part * (len(ordered) - 1)
    low = int(place)
    high = min(low + 1, len(ordered) - 1)
    return ordered[low] + (place - low) * (ordered[high] - ordered[low])


@dataclass
class Trips:
    """What was measured: by stack and case; why a stack failed; memory of its echo node in bytes; load of the machine at
    the beginning of each round."""

    measured: dict[str, dict[str, Measured]] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)
    memory: dict[str, int] = field(default_factory=dict)
    load: list[float] = field(default_factory=list)
    busy: list[float] = field(default_factory=list)

    def figures(self) -> dict[str, dict[str, dict[str, float]]]:
        """The summaries, by stack and case."""
        return {
            name: {case: one.summary() for case, one in cases.items() if one.all()}
            for name, cases in self.measured.items()
        }


def cases(sizes: Sequence[int] = SIZES) -> list[str]:
    """Names of the cases: sizes of strings, and coordinate."""
    return [*map(str, sizes), COORDINATE]


def measure(
    stacks: Sequence[Stack],
    network: Network,
    names: Sequence[str],
    rounds: int,
    count: int,
    progress: Callable[[str, int, int], None],
) -> Trips:
    """Measure; `progress` gets the stack, and how many of how many cases are done. A stack that fails is named among the
    problems, and the others go on."""
    trips = Trips()
    done, whole = 0, rounds * len(stacks) * len(names)
    for number in range(rounds):
        trips.load.append(os.getloadavg()[0])
        for stack in stacks:
            before, begun = done, _ticks()

            def step(stack: Stack = stack) -> None:
                nonlocal done
                done += 1
                progress(stack.name, done, whole)

            progress(stack.name, done, whole)
            try:
                _turn(stack, network, names, count, trips, step)
            except Failed as error:
                trips.problems.append(f"round {number + 1}, {stack.name}: {error}")
            trips.busy.append(_busy(begun))
            done = before + len(names)
    progress("", whole, whole)
    return trips


def _turn(
    stack: Stack,
    network: Network,
    names: Sequence[str],
    count: int,
    trips: Trips,
    step: Callable[[], None],
) -> None:
    """One stack's part of a round."""
    variables = stack.environment(network)
    options: dict[str, Any] = {"cases": list(names), "count": count, "warm_up": WARM_UP}
    name, stop = f"the echo node of {stack.name}", signal.SIGTERM if stack.foreign else None
    with Process(name, stack.command("echo", {}), variables, stop) as echo:
        if not stack.foreign:
            ready = echo.fact(START)
            variables["BENCH_PORT"] = str(ready.get("port", ""))
        with Process(f"the sender of {stack.name}", stack.command("ping", options), variables) as ping:
            while "done" not in (fact := ping.fact(CASE)):
                if "case" not in fact:
                    continue
                step()
                if "failed" in fact:
                    trips.problems.append(f"{stack.name}, {fact['case']}: {fact['failed']}")
                    continue
                one = trips.measured.setdefault(stack.name, {}).setdefault(fact["case"], Measured())
                one.rounds.append(fact["us"])
                one.lost += fact["lost"]
            memory = echo.memory()
            if memory is not None:
                trips.memory[stack.name] = max(memory, trips.memory.get(stack.name, 0))


def _ticks() -> tuple[float, float, float]:
    """Processor seconds used on this machine, by us and our children so far, and the time."""
    try:
        with open("/proc/stat", encoding="ascii") as stat:
            words = [int(word) for word in stat.readline().split()[1:9]]
    except OSError:
        return 0.0, 0.0, time.monotonic()
    ours = os.times()
    used = sum(words) - words[3] - words[4]
    return used / os.sysconf("SC_CLK_TCK"), sum(ours[:4]), time.monotonic()


def _busy(begun: tuple[float, float, float]) -> float:
    """Processors that others used on average since then."""
    now = _ticks()
    seconds = max(now[2] - begun[2], 1e-6)
    return max(0.0, (now[0] - begun[0] - (now[1] - begun[1])) / seconds)
