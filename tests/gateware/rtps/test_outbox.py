"""Composed datagrams leave whole and in order, with their length and sum; who does not answer to ARP keeps nobody
waiting."""

from __future__ import annotations

import random
from typing import Any

import pytest

from gateware.frames import STALLS
from gateware.words import WordBench, words
from roslet.gateware.rtps.outbox import Outbox

LONGEST, PATIENCE = 40, 6
SILENT, FAILED = 0x0A0A0A0A, 0x0B0B0B0B


def ones_sum(octets: bytes) -> int:
    """RFC 1071, 1."""
    total = sum(int.from_bytes(octets[n : n + 2], "big") for n in range(0, len(octets), 2))
    while total >> 16:
        total = (total & 0xFFFF) + (total >> 16)
    return total


def mac_of(ip: int) -> int:
    return ip << 16 | 0x1234


Datagram = tuple[int, int, bytes]


class Box:
    """An outbox, the writer of these datagrams, and a resolver who takes his time."""

    def __init__(
        self, datagrams: list[Datagram], stalls: int = 0, late: int = 0, slow: int = 0, take: bool = True
    ) -> None:
        self.bench = WordBench(Outbox(LONGEST, PATIENCE), stalls, seed=stalls)
        self.datagrams, self.late, self.slow = datagrams, late, slow
        self.lookups: list[tuple[int, int]] = []
        self.bench.drive(self.write)
        self.bench.watch(self.resolve)
        if take:
            self.got = self.bench.receive("o")
        self.bench.count("drop_unresolved")

    async def write(self, ctx: Any) -> None:
        dut, random_ = self.bench.dut, self.bench.random
        ctx.set(dut.source_port, 7410)
        await ctx.tick().repeat(3)
        for ip, port, octets in self.datagrams:
            # As soon as it may be.
            while ctx.get(dut.busy) or not ctx.get(dut.room):
                await ctx.tick()
            pushed = [ip, port | random_.getrandbits(16) << 16, *words(octets)]
            for at, word in enumerate(pushed):
                while random_.randrange(100) < self.bench.stalls:
                    await ctx.tick()
                last = at == len(pushed) - 1 and not self.late
                ctx.set(dut.push, 1)
                ctx.set(dut.word, word)
                if last:
                    ctx.set(dut.finish, 1)
                await ctx.tick()
                ctx.set(dut.push, 0)
                ctx.set(dut.word, random_.getrandbits(32))
            if self.late:
                await ctx.tick().repeat(self.late)
                ctx.set(dut.finish, 1)
                await ctx.tick()
            ctx.set(dut.finish, 0)
            assert ctx.get(dut.busy)

    async def resolve(self, ctx: Any) -> None:
        lookup = self.bench.dut.lookup
        cycle = 0
        while True:
            _, _, valid, ip = await ctx.tick().sample(lookup.valid, lookup.ip)
            cycle += 1
            if not valid:
                continue
            for _ in range(self.slow):
                await ctx.tick()
                cycle += 1
            ctx.set(lookup.done, 1)
            ctx.set(lookup.found, ip not in (SILENT, FAILED))
            ctx.set(lookup.failed, ip == FAILED)
            ctx.set(lookup.mac, mac_of(ip))
            await ctx.tick()
            cycle += 1
            self.lookups.append((cycle, ip))
            for signal in (lookup.done, lookup.found, lookup.failed):
                ctx.set(signal, 0)

    def check(self, cycles: int = 20_000) -> None:
        expected = [one for one in self.datagrams if one[0] not in (SILENT, FAILED)]
        self.bench.run(lambda: len(self.got) == len(expected), cycles=cycles, rest=200)
        assert [octets for octets, _ in self.got] == [octets for _, _, octets in expected]
        for (_, meta), (ip, port, octets) in zip(self.got, expected, strict=True):
            assert (meta.destination, meta.destination_port, meta.mac) == (ip, port, mac_of(ip))
            assert (meta.source_port, meta.length) == (7410, len(octets))
            assert meta.sum == ones_sum(octets)
        assert self.bench.counts["drop_unresolved"] == len(self.datagrams) - len(expected)


def datagrams(seed: int, count: int, answering: bool = True) -> list[Datagram]:
    random_ = random.Random(seed)
    made = []
    for n in range(count):
        size = 4 * random_.randrange(1, LONGEST // 4 + 1)
        octets = random_.choice([random_.randbytes(size), b"\xff" * size, bytes(size)])
        ip = random_.choice([0x0100000A + n] * 3 + ([] if answering else [SILENT, FAILED]))
        made.append((ip, random_.randrange(1, 65536), octets))
    return made


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("late", [0, 3])
def test_datagrams_leave_in_order_with_their_length_and_sum(stalls: int, late: int) -> None:
    Box(datagrams(stalls, 25), stalls, late, slow=stalls // 10).check()


def test_a_writer_as_quick_as_room_allows_overwrites_nothing_while_nobody_takes() -> None:
    """`room` must know of what has just been written when `busy` falls."""
    box = Box([(n + 1, 7400, bytes([n]) * LONGEST) for n in range(8)], take=False)
    stream = box.bench.dut.o.stream
    got: list[bytes] = []

    async def late(ctx: Any) -> None:
        await ctx.tick().repeat(150)  # both places are full by then, and the third must wait
        octets = bytearray()
        ctx.set(stream.ready, 1)
        while len(got) < 8:
            _, _, valid, item = await ctx.tick().sample(stream.valid, stream.payload)
            if valid and item.end:
                got.append(bytes(octets))
                octets.clear()
            elif valid:
                octets.append(item.data)

    box.bench.drive(late)
    box.bench.run()
    assert got == [bytes([n]) * LONGEST for n in range(8)]


def test_sums_that_carry_twice_are_right() -> None:
    cases = [
        b"\xff\xff\xff\xff",
        b"\xff\xff\x00\x01",
        b"\xff\xfe\x00\x01\x00\x01\x00\x00",
        bytes(4),
        b"\xff" * 40,
    ]
    cases += [b"\xff\xff\xff\xff" + bytes([0, n, 0, 0]) for n in range(4)]
    Box([(1, 2, octets) for octets in cases]).check()


def test_who_does_not_answer_is_dropped_and_those_behind_leave() -> None:
    box = Box(datagrams(5, 25, answering=False), slow=3)
    assert any(ip == SILENT for ip, _, _ in box.datagrams) and any(ip == FAILED for ip, _, _ in box.datagrams)
    box.check()


def test_who_does_not_answer_is_waited_for_as_long_as_patience_lasts_and_no_longer() -> None:
    box = Box([(SILENT, 1, bytes(8)), (FAILED, 1, bytes(8)), (7, 1, bytes(12))], slow=2)
    box.check()
    times = [cycle for cycle, ip in box.lookups if ip == SILENT]
    assert (1 << PATIENCE) - 4 <= times[-1] - times[0] <= (1 << PATIENCE) + 4
    assert len([ip for _, ip in box.lookups if ip == FAILED]) == 1


def test_a_datagram_begins_to_leave_six_cycles_after_its_end() -> None:
    box = Box([(1, 2, bytes(8))])
    dut = box.bench.dut
    times: dict[str, int] = {}

    async def look(ctx: Any) -> None:
        cycle = 0
        while True:
            _, _, finish, valid = await ctx.tick().sample(dut.finish, dut.o.stream.valid)
            cycle += 1
            for name, high in (("finish", finish), ("valid", valid)):
                if high:
                    times.setdefault(name, cycle)

    box.bench.watch(look)
    box.check()
    assert times["valid"] - times["finish"] == 6  # the resolver here takes two cycles
