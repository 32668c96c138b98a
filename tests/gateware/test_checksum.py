"""The example of RFC 1071, 3, and sums by hand; scapy's checksum for the rest."""

from __future__ import annotations

import random
from typing import Any

import pytest
from scapy.utils import checksum

from gateware.frames import Bench
from roslet.gateware.checksum import SerialSum

SUMS = pytest.mark.parametrize(
    ("octets", "total"),
    [
        (bytes.fromhex("0001 f203 f4f5 f6f7"), 0xDDF2),
        (b"", 0),
        (b"\x12", 0x1200),
        (b"\xff\xff", 0xFFFF),
        (b"\xff\xff\x00\x01", 0x0001),
        (b"\xff\xff\xff\xff", 0xFFFF),
        (bytes.fromhex("4500 0073 0000 4000 4011 b861 c0a8 0001 c0a8 00c7"), 0xFFFF),
    ],
)


def test_a_serial_sum_is_right_where_the_sum_is_and_spells_what_makes_it_so() -> None:
    bench = Bench(SerialSum())
    rng = random.Random(7)
    plain = [rng.randbytes(rng.randrange(1, 40)) for _ in range(150)]
    plain += [bytes([octet]) * n for octet in (0, 1, 0xFE, 0xFF) for n in range(1, 9)]
    found: list[tuple[bool, bool, bytes]] = []

    async def take(ctx: Any, octet: int) -> int:
        ctx.set(bench.dut.data, octet)
        ctx.set(bench.dut.add, 1)
        result = int(ctx.get(bench.dut.result))
        await ctx.tick()
        ctx.set(bench.dut.add, 0)
        return result

    async def process(ctx: Any) -> None:
        for octets in plain:
            before = None
            for octet in octets:
                await take(ctx, octet)
            before = bool(ctx.get(bench.dut.right))
            spelled = bytes([~await take(ctx, 0) & 0xFF for _ in range(2)])
            ctx.set(bench.dut.clear, 1)
            await ctx.tick()
            ctx.set(bench.dut.clear, 0)
            for octet in octets + bytes(len(octets) % 2) + checksum(octets).to_bytes(2, "big"):
                await take(ctx, octet)
            found.append((before, bool(ctx.get(bench.dut.right)), spelled))
            ctx.set(bench.dut.clear, 1)
            await ctx.tick()
            ctx.set(bench.dut.clear, 0)

    bench.drive(process)
    bench.run()
    for octets, (before, after, spelled) in zip(plain, found, strict=True):
        total = checksum(octets)
        assert before == (total == 0 and any(octets)), octets
        assert after == (any(octets) or total == 0xFFFF), octets
        if len(octets) % 2 == 0 and octets[-1] != 0xFF:
            assert spelled == total.to_bytes(2, "big"), octets


@SUMS
def test_a_serial_sum_is_right_at_once_and_anew_after_it_was_cleared(octets: bytes, total: int) -> None:
    bench = Bench(SerialSum())
    found = []

    async def process(ctx: Any) -> None:
        for _ in range(2):
            for octet in octets:
                ctx.set(bench.dut.data, octet)
                ctx.set(bench.dut.add, 1)
                await ctx.tick()
            found.append(ctx.get(bench.dut.right))
            ctx.set(bench.dut.clear, 1)
            await ctx.tick()
            ctx.set(bench.dut.clear, 0)
            ctx.set(bench.dut.add, 0)

    bench.drive(process)
    bench.run()
    assert found == [total == 0xFFFF] * 2


def test_a_serial_sum_of_any_octets_is_right_where_the_remainder_by_0xffff_is_0() -> None:
    bench = Bench(SerialSum())
    numbers = [[bench.random.choice((0, 1, 0xFE, 0xFF)) for _ in range(size)] for size in range(1, 40)]
    wrong = []

    async def process(ctx: Any) -> None:
        for octets in numbers:
            for octet in octets:
                ctx.set(bench.dut.data, octet)
                ctx.set(bench.dut.add, 1)
                await ctx.tick()
            data = bytes(octets) + bytes(len(octets) % 2)
            right = int.from_bytes(data, "big") % 0xFFFF == 0 and any(data)
            if ctx.get(bench.dut.right) != right:
                wrong.append((octets, right))
            ctx.set(bench.dut.clear, 1)
            await ctx.tick()
            ctx.set(bench.dut.clear, 0)
            ctx.set(bench.dut.add, 0)

    bench.drive(process)
    bench.run()
    assert wrong == []
