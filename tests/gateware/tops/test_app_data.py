"""The rights to change and to read messages, with users who take them whenever they like. The manual, 4.2 and 4.3."""

from __future__ import annotations

import random
from typing import Any

import pytest
from amaranth.hdl import Array, Module, Signal
from amaranth.sim import Simulator

from roslet.gateware.tops.app_data import AppDataRx, AppDataTx

SIZE, CYCLES = 20, 6000


async def wait(ctx: Any, cycles: int) -> None:
    """Not `repeat`, which a testbench in the background cannot be ended in."""
    for _ in range(cycles):
        await ctx.tick()


class Publishing:
    """A publisher whose data the user changes word by word, never two of the same message alike; `sent` came out."""

    def __init__(self, seed: int, hold: bool, on_change: bool = True) -> None:
        self.dice = random.Random(seed)
        self.hold = hold
        self.sent: list[list[int]] = []
        self.written: list[int] = []
        self.waits: list[int] = []
        dut = AppDataTx(SIZE, on_change)
        words = [Signal(32, name=f"word{n}") for n in range(SIZE // 4)]
        m = Module()
        m.submodules.dut = dut
        m.d.sync += dut.word.eq(Array(words)[dut.index])
        sim = Simulator(m)
        sim.add_clock(1e-6)

        async def user(ctx: Any) -> None:
            ctx.set(dut.length, SIZE)
            ctx.set(dut.enable, 1)
            number = 0
            while True:
                await wait(ctx, self.dice.randrange(1, 60))
                ctx.set(dut.req, 1)
                waited = 0
                while not ctx.get(dut.grant):
                    await ctx.tick()
                    waited += 1
                if not self.hold:
                    ctx.set(dut.req, 0)
                self.waits.append(waited)
                number += 1
                for word in self.dice.sample(words, len(words)):
                    await wait(ctx, self.dice.randrange(1, 4))
                    ctx.set(word, number)
                ctx.set(dut.rel, 1)
                await ctx.tick()
                ctx.set(dut.rel, 0)
                self.written.append(number)

        async def clock(ctx: Any) -> None:
            while True:
                await wait(ctx, self.dice.randrange(5, 40))
                ctx.set(dut.periodic, 1)
                await ctx.tick()
                ctx.set(dut.periodic, 0)

        async def taker(ctx: Any) -> None:
            message: list[int] = []
            for _ in range(CYCLES):
                ctx.set(dut.o.stream.ready, int(self.dice.random() < 0.7))
                _, _, valid, ready, payload = await ctx.tick().sample(
                    dut.o.stream.valid, dut.o.stream.ready, dut.o.stream.payload
                )
                if valid and ready and payload.end:
                    self.sent.append(message)
                    message = []
                elif valid and ready:
                    message.append(payload.data)

        sim.add_testbench(user, background=True)
        sim.add_testbench(clock, background=True)
        sim.add_testbench(taker)
        sim.run()


@pytest.mark.parametrize("hold", [False, True])
@pytest.mark.parametrize("seed", range(3))
def test_no_message_is_sent_while_it_is_changed_and_nobody_starves(seed: int, hold: bool) -> None:
    run = Publishing(seed, hold)
    assert len(run.sent) > 30
    assert len(run.written) > 30
    assert max(run.waits) < 60
    for message in run.sent:
        assert len(message) == SIZE // 4
        assert len(set(message)) == 1, "parts of two messages"
    numbers = [message[0] for message in run.sent]
    assert numbers == sorted(numbers)


@pytest.mark.parametrize("seed", range(3))
def test_no_message_is_written_while_it_is_read_and_nobody_starves(seed: int) -> None:
    dice = random.Random(seed)
    dut = AppDataRx(SIZE)
    sim = Simulator(dut)
    sim.add_clock(1e-6)
    memory = bytearray(SIZE)
    given: list[bytes] = []
    read: list[bytes] = []
    rises = 0
    longs = 0

    async def peer(ctx: Any) -> None:
        ctx.set(dut.enable, 1)
        stream = dut.i.stream

        async def put(item: dict[str, int]) -> None:
            ctx.set(stream.payload, item)
            ctx.set(stream.valid, 1)
            ready = 0
            while not ready:
                _, _, ready = await ctx.tick().sample(stream.ready)
            ctx.set(stream.valid, 0)

        while True:
            await wait(ctx, dice.randrange(1, 40))
            if not ctx.get(dut.room):
                continue
            size = dice.choice([0, 1, 3, 4, 7, 16, 19, 20, 21, 24, 40])
            bad = int(dice.random() < 0.3)
            data = bytes([len(given) % 256]) * size
            for at in range(0, size, 4):
                part = data[at : at + 4].ljust(4, b"\xee")
                await put({"data": int.from_bytes(part, "little")})
                await wait(ctx, dice.randrange(1, 4))
            if not bad and size <= SIZE:
                given.append(data)
            await put({"end": 1, "bad": bad, "padding": 0 if bad else -size % 4})

    async def ram(ctx: Any) -> None:
        nonlocal rises, longs
        before = 0
        async for _, _, ce, we, addr, wdata, grant, recv, long in ctx.tick().sample(
            dut.ce, dut.we, dut.addr, dut.wdata, dut.grant, dut.recv, dut.drop_long
        ):
            if ce and we:
                assert not grant, "written while the user reads"
                memory[addr] = wdata
            rises += recv and not before
            longs += long
            before = recv

    async def user(ctx: Any) -> None:
        for _ in range(CYCLES // 30):
            while not ctx.get(dut.recv):
                await ctx.tick()
            await wait(ctx, dice.randrange(1, 40))
            ctx.set(dut.req, 1)
            waited = 0
            while not ctx.get(dut.grant):
                await ctx.tick()
                waited += 1
            assert waited < 60
            ctx.set(dut.req, 0)
            length = ctx.get(dut.length)
            found = bytearray()
            for at in range(length):
                await wait(ctx, dice.randrange(1, 3))
                found.append(memory[at])
            assert ctx.get(dut.length) == length
            read.append(bytes(found))
            ctx.set(dut.rel, 1)
            await ctx.tick()
            ctx.set(dut.rel, 0)

    sim.add_testbench(peer, background=True)
    sim.add_testbench(ram, background=True)
    sim.add_testbench(user)
    sim.run()
    assert len(read) == CYCLES // 30
    assert longs > 5
    order = iter(given)
    assert all(any(message == one for one in order) for message in read), "each was given, in this order"
    assert rises >= len(set(read)) - 1
