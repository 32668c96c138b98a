"""Everybody for whom something is due has a turn, and nobody who is gone."""

from __future__ import annotations

import random
from collections import Counter
from typing import Any

import pytest
from amaranth.hdl import ResetInserter, Signal
from amaranth.sim import Simulator

from roslet.gateware.rtps import tables
from roslet.gateware.rtps.tables import PeerMap
from roslet.gateware.rtps.turns import Turns

PEERS = PeerMap(participants=3, endpoints=5)
BUILTINS = PEERS.participants * tables.BUILTINS
USER = 1 << (PEERS.proxy_bits - 1)
PROXIES = [*range(BUILTINS), *(USER | n for n in range(PEERS.endpoints))]
# Cycles in which each place is looked at.
ROUND = 3 * 32


class Bench:
    """Turns among peers, all of whom are there unless told otherwise; `jobs` are those that were taken."""

    def __init__(self, pause: int = 0, peers: PeerMap = PEERS) -> None:
        self.peers = peers
        self.dut = Turns(peers)
        self.pause = pause
        self.jobs: list[dict[str, int]] = []
        self.reset = Signal()
        self.simulator = Simulator(ResetInserter(self.reset)(self.dut))
        self.simulator.add_clock(1e-8)
        self.simulator.add_testbench(self._take, background=True)

    async def _take(self, ctx: Any) -> None:
        while True:
            while not ctx.get(self.dut.valid):
                await ctx.tick()
            first = {name: ctx.get(self.dut.job[name]) for name in self.dut.job.shape().members}
            for _ in range(self.pause):
                await ctx.tick()
            assert {name: ctx.get(self.dut.job[name]) for name in first} == first, "a job is steady"
            ctx.set(self.dut.taken, 1)
            await ctx.tick()
            ctx.set(self.dut.taken, 0)
            self.jobs.append(first)

    def run(self, test: Any) -> None:
        async def whole(ctx: Any) -> None:
            ctx.set(self.dut.alive, (1 << self.peers.participants) - 1)
            ctx.set(self.dut.matched, (1 << self.peers.endpoints) - 1)
            await ctx.tick().repeat(ROUND)
            await test(ctx)

        self.simulator.add_testbench(whole)
        self.simulator.run()

    async def pulse(self, ctx: Any, **ports: int) -> None:
        for name, value in ports.items():
            ctx.set(getattr(self.dut, name), value)
        await ctx.tick()
        for name in ports:
            ctx.set(getattr(self.dut, name), 0)

    async def due(self, ctx: Any, proxy: int, source: int = 0) -> None:
        port = getattr(self.dut, f"due{source}")
        ctx.set(port.proxy, proxy)
        ctx.set(port.en, 1)
        await ctx.tick()
        ctx.set(port.en, 0)

    def served(self) -> Counter[tuple[int, int]]:
        """How often each proxy, with whether something was due for it."""
        return Counter(
            (job["user"] * USER | job["index"], job["asked"])
            for job in self.jobs
            if not (job["greet"] or job["announce"])
        )


@pytest.mark.parametrize("pause", [0, 1, 7])
def test_each_due_proxy_has_a_turn_and_none_else(pause: int) -> None:
    bench = Bench(pause)
    shuffled = random.Random(pause).sample(PROXIES, len(PROXIES))

    async def test(ctx: Any) -> None:
        for source, proxy in enumerate(shuffled):
            await bench.due(ctx, proxy, source % 2)
            await ctx.tick().repeat(ROUND + 2 * (bench.pause + 4))
            assert bench.served() == {(one, 1): 1 for one in shuffled[: source + 1]}

    bench.run(test)


def test_what_becomes_due_while_it_is_served_is_another_turn() -> None:
    bench = Bench(pause=3)

    async def test(ctx: Any) -> None:
        await bench.due(ctx, 2)
        while not ctx.get(bench.dut.taken):
            await ctx.tick()
        await bench.due(ctx, 2)
        await ctx.tick().repeat(3 * ROUND)
        assert bench.served() == {(2, 1): 2}

    bench.run(test)


def test_two_at_once_are_both_remembered() -> None:
    bench = Bench()

    async def test(ctx: Any) -> None:
        ctx.set(bench.dut.due1.proxy, USER | 4)
        ctx.set(bench.dut.due1.en, 1)
        await bench.due(ctx, 1)
        ctx.set(bench.dut.due1.en, 0)
        await ctx.tick().repeat(3 * ROUND)
        assert {proxy for proxy, _ in bench.served()} == {1, USER | 4}

    bench.run(test)


def test_nobody_who_is_gone_has_a_turn() -> None:
    bench = Bench()

    async def test(ctx: Any) -> None:
        ctx.set(bench.dut.alive, 0b101)
        ctx.set(bench.dut.matched, 0b01111)
        for proxy in (tables.BUILTINS, USER | 4):
            await bench.due(ctx, proxy)
        await ctx.tick().repeat(3 * ROUND)
        assert not bench.jobs
        # And it is forgotten, should somebody else have the place.
        ctx.set(bench.dut.alive, 0b111)
        ctx.set(bench.dut.matched, 0b11111)
        await ctx.tick().repeat(3 * ROUND)
        assert not bench.jobs

    bench.run(test)


def test_a_sweep_visits_each_once() -> None:
    bench = Bench(pause=2)

    async def test(ctx: Any) -> None:
        ctx.set(bench.dut.alive, 0b011)
        await bench.pulse(ctx, sweep=1)
        await ctx.tick().repeat(10 * ROUND)
        there = [proxy for proxy in PROXIES if not 2 * tables.BUILTINS <= proxy < USER]
        assert bench.served() == {(proxy, 0): 1 for proxy in there}

    bench.run(test)


@pytest.mark.parametrize(("participants", "endpoints"), [(4, 8), (8, 16), (1, 1), (1, 40), (5, 2)])
def test_a_sweep_visits_each_once_however_many_there_are(participants: int, endpoints: int) -> None:
    peers = PeerMap(participants, endpoints)
    bench = Bench(peers=peers)

    async def test(ctx: Any) -> None:
        await ctx.tick().repeat(3 * 128)
        await bench.pulse(ctx, sweep=1)
        await ctx.tick().repeat(3 * 3 * 128)
        user = 1 << (peers.proxy_bits - 1)
        there = [*range(tables.BUILTINS * participants), *(user | n for n in range(endpoints))]
        found = Counter(job["user"] * user | job["index"] for job in bench.jobs)
        assert found == dict.fromkeys(there, 1)

    bench.run(test)


def test_what_was_remembered_is_forgotten_by_a_reset() -> None:
    bench = Bench(pause=10 * ROUND)

    async def test(ctx: Any) -> None:
        for proxy in PROXIES:
            await bench.due(ctx, proxy)
            await ctx.tick().repeat(3)
        await bench.pulse(ctx, greet=1)
        ctx.set(bench.reset, 1)
        await ctx.tick().repeat(3)
        ctx.set(bench.reset, 0)
        for _ in range(3 * ROUND):
            await ctx.tick()
            assert not ctx.get(bench.dut.valid)

    bench.run(test)


def test_greetings_and_announcements_are_given_among_the_others() -> None:
    bench = Bench(pause=1)

    async def test(ctx: Any) -> None:
        await bench.pulse(ctx, announce=1)
        await ctx.tick().repeat(8)
        for slot in (2, 0):
            ctx.set(bench.dut.greet_slot, slot)
            await bench.pulse(ctx, greet=1)
        await bench.pulse(ctx, sweep=1)
        await ctx.tick().repeat(10 * ROUND)
        assert [job["index"] for job in bench.jobs if job["greet"]] in ([2, 0], [0, 2])
        assert sum(job["announce"] for job in bench.jobs) == 1
        assert bench.served() == {(proxy, 0): 1 for proxy in PROXIES}

    bench.run(test)


def test_whatever_comes_is_served_before_long() -> None:
    bench = Bench(pause=2)
    random_ = random.Random(5)
    asked: Counter[int] = Counter()

    async def test(ctx: Any) -> None:
        for _ in range(300):
            proxy = random_.choice(PROXIES)
            asked[proxy] += 1
            await bench.due(ctx, proxy, random_.randrange(2))
            await ctx.tick().repeat(random_.randrange(1, 12))
        await ctx.tick().repeat(8 * ROUND)
        served = Counter({proxy: times for (proxy, due), times in bench.served().items() if due})
        assert set(served) == set(asked)
        assert all(served[proxy] <= times for proxy, times in asked.items())

    bench.run(test)
