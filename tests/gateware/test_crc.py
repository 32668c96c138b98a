"""The frame check sequence: the catalogue's check value for CRC-32/ISO-HDLC, and zlib."""

from __future__ import annotations

import zlib
from typing import Any

import pytest

from gateware.frames import Bench
from gateware.phy import symbols
from roslet.gateware.crc import FrameCheck

WIDTHS = pytest.mark.parametrize("width", [1, 4, 8])


def states(width: int, octets: bytes) -> list[tuple[int, bool]]:
    """`fcs` and `match` after `clear`, and after each octet."""
    bench = Bench(FrameCheck(width))
    got = []

    async def process(ctx: Any) -> None:
        ctx.set(bench.dut.clear, 1)
        await ctx.tick()
        ctx.set(bench.dut.clear, 0)
        got.append((ctx.get(bench.dut.fcs), bool(ctx.get(bench.dut.match))))
        for octet in octets:
            for at in range(0, 8, width):
                ctx.set(bench.dut.data, octet >> at & (1 << width) - 1)
                await ctx.tick()
            got.append((ctx.get(bench.dut.fcs), bool(ctx.get(bench.dut.match))))

    bench.drive(process)
    bench.run(rest=1)
    return got


@WIDTHS
def test_the_check_value_is_that_of_the_catalogue(width: int) -> None:
    assert states(width, b"123456789")[-1] == (0xCBF43926, False)


@WIDTHS
def test_the_sequence_is_zlibs_after_every_octet_and_matches_where_it_follows(width: int) -> None:
    data = bytes(range(7, 250, 11)) + b"\0\0\xff\xff"
    sealed = data + zlib.crc32(data).to_bytes(4, "little")
    assert [fcs for fcs, _ in states(width, sealed)] == [
        zlib.crc32(sealed[:n]) for n in range(len(sealed) + 1)
    ]
    assert [match for _, match in states(width, sealed)] == [False] * len(sealed) + [True]


@pytest.mark.parametrize("width", [4, 8])
def test_fed_with_its_own_complement_it_shifts_itself_out(width: int) -> None:
    bench = Bench(FrameCheck(width))
    out = []

    async def process(ctx: Any) -> None:
        for data in symbols(b"123456789", width):
            ctx.set(bench.dut.data, data)
            await ctx.tick()
        for _ in range(32 // width):
            low = ctx.get(bench.dut.fcs) & (1 << width) - 1
            out.append(low)
            ctx.set(bench.dut.data, ~low & (1 << width) - 1)
            await ctx.tick()

    bench.drive(process)
    bench.run(rest=1)
    assert out == symbols(0xCBF43926.to_bytes(4, "little"), width)


def test_other_widths_are_refused() -> None:
    with pytest.raises(ValueError, match="of 1 to 8 bits, not 32"):
        FrameCheck(32)
