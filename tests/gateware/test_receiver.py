"""MII and GMII reception. IEEE 802.3, 3, 4.2.9, 22.2.3, 35.2.3."""

from __future__ import annotations

import random
from typing import Any

import pytest

from gateware.frames import Bad, Bench
from gateware.phy import IDLE, PREAMBLE, Cycle, fcs, play, sealed, shown, some
from roslet.gateware.receiver import REASONS, Receiver

FRAME = bytes.fromhex("ffff ffff ffff 0200 0000 0002 0806") + bytes(range(46))
RX = pytest.mark.parametrize("width", [4, 8])


def heard(width: int, cycles: list[Cycle]) -> list[bytes | str]:
    """What the receiver makes of these cycles: good frames, and why others were dropped."""
    bench = Bench(Receiver(width), stalls=0)  # it cannot wait
    got = bench.receive("o")
    reasons: list[int] = []

    async def listen(ctx: Any) -> None:
        stream = bench.dut.o.stream
        while True:
            _, _, valid, item = await ctx.tick().sample(stream.valid, stream.payload)
            if valid and item.bad:
                reasons.append(item.data)

    bench._simulator.add_testbench(listen, background=True)
    pins = bench.dut.rxd, bench.dut.rx_dv, bench.dut.rx_er
    bench.drive(lambda ctx: play(ctx, pins, cycles))
    bench.run(cycles=len(cycles) + 10)
    named = iter(reasons)
    return [_name(next(named)) if isinstance(frame, Bad) else frame for frame, _ in got]


def _name(bits: int) -> str:
    (reason,) = [name for n, name in enumerate(REASONS) if bits >> 1 + n & 1]
    return reason


@RX
def test_frames_of_all_sizes_are_taken_without_preamble_and_fcs(width: int) -> None:
    rng = random.Random(1)
    frames = [FRAME, *(some(rng, size) for size in (60, 61, 63, 64, 511, 1514))]
    cycles = [IDLE, *(cycle for frame in frames for cycle in shown(PREAMBLE + sealed(frame), width))]
    assert heard(width, cycles) == frames


@RX
def test_the_preamble_may_be_shortened_and_of_any_length(width: int) -> None:
    cycles = [IDLE]
    for length in (0, 1, 2, 6, 20):
        cycles += shown(b"\x55" * length + b"\xd5" + sealed(FRAME), width)
    if width == 4:
        cycles += shown(PREAMBLE + sealed(FRAME), 4)[1:]  # an odd number of nibbles
    assert heard(width, cycles) == [FRAME] * (6 if width == 4 else 5)


@RX
def test_one_cycle_between_frames_is_enough(width: int) -> None:
    one = [*shown(PREAMBLE + sealed(FRAME), width, gap=0), IDLE]
    assert heard(width, [IDLE, *one * 5]) == [FRAME] * 5


@RX
def test_a_frame_with_a_wrong_fcs_is_dropped_whole(width: int) -> None:
    right = sealed(FRAME)
    cycles = [IDLE]
    for bit in (0, 8 * 30 + 3, 8 * 60, 8 * 63 + 7):
        wrong = bytearray(right)
        wrong[bit // 8] ^= 1 << bit % 8
        cycles += shown(PREAMBLE + wrong, width) + shown(PREAMBLE + right, width)
    assert heard(width, cycles) == ["fcs", FRAME] * 4


@RX
def test_an_error_of_the_phy_anywhere_drops_the_frame_whole(width: int) -> None:
    carrier = PREAMBLE + sealed(FRAME)
    last = len(carrier) * 8 // width - 1
    places = [0, 1, 5, 8, 9, 40, last - 1, last]
    cycles = [IDLE]
    for place in places:
        cycles += shown(carrier, width, error=[place]) + shown(carrier, width)
    cycles += shown(carrier, width, error=range(3, 30))
    assert heard(width, cycles) == [*["rx_er", FRAME] * len(places), "rx_er"]


@RX
def test_an_error_outside_of_frames_means_nothing(width: int) -> None:
    carrier = shown(PREAMBLE + sealed(FRAME), width)
    assert heard(width, [(0xE, 0, 1)] * 4 + carrier + [(0, 0, 1)] * 4 + carrier) == [FRAME, FRAME]


@RX
@pytest.mark.parametrize("size", [0, 1, 3, 4, 5, 59])
def test_a_runt_is_dropped_even_with_a_right_fcs(width: int, size: int) -> None:
    runt = PREAMBLE + FRAME[:size] + fcs(FRAME[:size])
    cycles = [IDLE, *shown(runt, width), *shown(PREAMBLE + sealed(FRAME), width), *shown(runt[:-4], width)]
    assert heard(width, cycles) == ["runt", FRAME, "runt"]


@RX
@pytest.mark.parametrize("size", [1515, 1700])
def test_a_giant_is_dropped_whole(width: int, size: int) -> None:
    giant = some(random.Random(size), size)
    cycles = [IDLE, *shown(PREAMBLE + sealed(giant), width), *shown(PREAMBLE + sealed(FRAME), width)]
    assert heard(width, cycles) == ["giant", FRAME]


def test_an_odd_number_of_nibbles_is_dropped() -> None:
    carrier = shown(PREAMBLE + sealed(FRAME), 4, gap=0)
    assert heard(4, [IDLE, *carrier, (5, 1, 0), IDLE, *carrier, IDLE, *carrier[:-1], IDLE]) == [
        "odd",
        FRAME,
        "odd",
    ]


@RX
def test_a_carrier_without_a_start_frame_delimiter_is_no_frame(width: int) -> None:
    cycles = [IDLE]
    good = shown(PREAMBLE + sealed(FRAME), width)
    for carrier in (b"\x55", b"\x55" * 80, b"\x55\x5e" + FRAME, FRAME, b"\x55\x55\x00" + PREAMBLE + FRAME):
        cycles += shown(carrier, width) + good
    assert heard(width, cycles) == ["sfd", FRAME] * 5


@RX
def test_a_frame_that_had_begun_at_reset_is_nothing(width: int) -> None:
    carrier = shown(PREAMBLE + sealed(FRAME), width)
    assert heard(width, carrier[40:] + carrier) == [FRAME]
    assert heard(width, carrier[3:] + carrier) == [FRAME]


@RX
def test_a_cut_anywhere_gives_no_good_frame(width: int) -> None:
    carrier = shown(PREAMBLE + sealed(FRAME), width, gap=0)
    cuts = range(1, len(carrier), 7)
    cycles = [IDLE, *(c for cut in cuts for c in (*carrier[:cut], IDLE)), *carrier, IDLE]
    *dropped, last = heard(width, cycles)
    assert len(dropped) == len(cuts) and set(dropped) <= set(REASONS) and last == FRAME


def test_the_last_octet_leaves_two_cycles_after_the_end() -> None:
    bench = Bench(Receiver(4), stalls=0)
    cycles = [IDLE, *shown(PREAMBLE + sealed(FRAME), 4)]
    ends: list[int] = []

    async def listen(ctx: Any) -> None:
        for at in range(len(cycles)):
            _, _, valid, item = await ctx.tick().sample(bench.dut.o.stream.valid, bench.dut.o.stream.payload)
            if valid and item.end:
                ends.append(at)

    bench.drive(listen)
    bench.drive(lambda ctx: play(ctx, (bench.dut.rxd, bench.dut.rx_dv, bench.dut.rx_er), cycles))
    bench.run()
    first_silent = cycles.index(IDLE, 1)
    assert ends == [first_silent + 2]


def test_only_nibbles_and_octets_are_widths() -> None:
    with pytest.raises(ValueError, match="a PHY gives 4 or 8 bits a cycle, not 2"):
        Receiver(2)
