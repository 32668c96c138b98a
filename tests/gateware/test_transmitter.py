"""MII and GMII transmission. IEEE 802.3, 3, 4.2.8, 4.4.2, 22.2, 35.2."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any

import pytest

from gateware.frames import Bad, Bench, taken
from gateware.phy import PREAMBLE, Watch, fcs, sealed, some
from roslet.gateware.transmitter import Transmitter

HEADER = bytes.fromhex("ffff ffff ffff 0200 0000 0002 0806")
TX = pytest.mark.parametrize("width", [4, 8])


def sent(width: int, frames: Sequence[bytes], carriers: int) -> tuple[Watch, dict[str, int]]:
    bench = Bench(Transmitter(width), stalls=0)  # it cannot wait
    dut = bench.dut
    watch = Watch((dut.txd, dut.tx_en, dut.tx_er), width)
    bench._simulator.add_testbench(watch.run, background=True)
    bench.send("i", frames)
    bench.count("drop_underrun", "drop_giant")
    bench.run(lambda: len(watch.carriers) == carriers)
    return watch, bench.counts


@TX
def test_a_frame_gets_preamble_padding_and_fcs(width: int) -> None:
    rng = random.Random(2)
    frames = [HEADER, *(HEADER + some(rng, size) for size in (1, 45, 46, 47, 1500)), b"\x01"]
    watch, counts = sent(width, frames, len(frames))
    assert watch.carriers == [PREAMBLE + sealed(frame) for frame in frames]
    assert not watch.errors and counts == {"drop_underrun": 0, "drop_giant": 0}


@TX
def test_the_gap_between_frames_is_96_bit_times(width: int) -> None:
    watch, _ = sent(width, [HEADER, HEADER + bytes(47), HEADER + bytes(100)] * 2, 6)
    assert watch.gaps[1:] == [96 // width] * 5


@TX
def test_a_frame_with_a_bad_end_is_spoilt(width: int) -> None:
    frames = [Bad(HEADER), HEADER, Bad(HEADER + bytes(60)), HEADER]
    watch, counts = sent(width, frames, 4)
    assert watch.carriers[::2] == [
        PREAMBLE + frame + bytes(octet ^ 0xFF for octet in fcs(frame)) for frame in frames[::2]
    ]
    assert watch.carriers[1::2] == [PREAMBLE + sealed(HEADER)] * 2
    assert watch.errors == [0, 2] and counts == {"drop_underrun": 0, "drop_giant": 0}
    assert min(watch.gaps[1:]) >= 96 // width


@TX
def test_a_giant_is_spoilt_and_counted(width: int) -> None:
    watch, counts = sent(width, [bytes(1515), HEADER, Bad(bytes(1516)), HEADER], 4)
    assert watch.frames == [HEADER.ljust(60, b"\0")] * 2
    assert [len(carrier) for carrier in watch.carriers] == [8 + 1518, 8 + 64] * 2
    assert counts == {"drop_underrun": 0, "drop_giant": 2}


@TX
@pytest.mark.parametrize("late", [1, 13, 59, 60, 61, 99])
def test_a_frame_that_is_late_is_spoilt_and_counted(width: int, late: int) -> None:
    """Of a hundred octets the one numbered `late` does not come in time."""
    bench = Bench(Transmitter(width))
    dut = bench.dut
    watch = Watch((dut.txd, dut.tx_en, dut.tx_er), width)
    bench._simulator.add_testbench(watch.run, background=True)
    bench.count("drop_underrun", "drop_giant")

    async def process(ctx: Any) -> None:
        for pause, size in ((True, 100), (False, len(HEADER))):
            for n in range(size + 1):
                ctx.set(dut.i.stream.payload, {"data": n & 0xFF, "end": n == size, "bad": 0})
                if pause and n == late:
                    ctx.set(dut.i.stream.valid, 0)
                    await ctx.tick().repeat(300)
                ctx.set(dut.i.stream.valid, 1)
                await taken(ctx, dut.i.stream)
        ctx.set(dut.i.stream.valid, 0)

    bench.drive(process)
    bench.run(lambda: len(watch.carriers) == 2)
    assert watch.frames == [bytes(range(len(HEADER))).ljust(60, b"\0")]
    assert watch.errors == [0] and len(watch.carriers[0]) == 8 + late + 4
    assert bench.counts == {"drop_underrun": 1, "drop_giant": 0}


@TX
def test_a_frame_of_no_octets_is_not_sent(width: int) -> None:
    watch, _ = sent(width, [b"", Bad(b""), HEADER, b"", HEADER, b""], 2)
    assert watch.carriers == [PREAMBLE + sealed(HEADER)] * 2
    assert watch.gaps[1] >= 96 // width


def test_only_nibbles_and_octets_are_widths() -> None:
    with pytest.raises(ValueError, match="a PHY takes 4 or 8 bits a cycle, not 16"):
        Transmitter(16)
