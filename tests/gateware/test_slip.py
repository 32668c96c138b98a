"""Packets on a line of octets: by hand from RFC 1055, and by sliplib."""

from __future__ import annotations

import random
from typing import Any

import pytest
import sliplib

from gateware.frames import STALLS, Bad, Bench
from roslet.gateware.fifo import WholeFrameFifo
from roslet.gateware.slip import SlipRx, SlipTx

# RFC 1055: END is 192, ESC is 219, behind which stand 220 for END and 221 for ESC.
BY_HAND = [
    (b"\x01\x02", [192, 1, 2, 192]),
    (bytes([192]), [192, 219, 220, 192]),
    (bytes([219]), [192, 219, 221, 192]),
    (bytes([219, 220, 192, 221]), [192, 219, 221, 220, 219, 220, 221, 192]),
]
ERROR = 256
"""Beside octets: one that the line has spoilt."""
REASONS = ("drop_line", "drop_escape", "drop_too_long")


def random_packets(count: int, longest: int, seed: int = 1) -> list[bytes]:
    chance = random.Random(seed)
    return [
        bytes(chance.choices(b"\xc0\xdb\xdc\xdd\x00a", k=chance.randrange(1, longest))) for _ in range(count)
    ]


def framed(packet: bytes) -> list[int]:
    return [192, *sliplib.encode(packet), 192]


def receive(octets: list[int], stalls: int, max_size: int = 1500) -> tuple[list[bytes], dict[str, int]]:
    """What comes out of octets, and what was dropped."""
    bench = Bench(SlipRx(max_size), stalls)
    got = bench.receive("o")
    bench.count(*REASONS)

    async def line(ctx: Any) -> None:
        i = bench.dut.i
        for octet in octets:
            while bench.random.randrange(100) < stalls:
                await ctx.tick()
            ctx.set(i.payload, {"data": octet & 255, "bad": octet >= ERROR})
            ctx.set(i.valid, 1)
            ready = False
            while not ready:
                _, _, ready = await ctx.tick().sample(i.ready)
            ctx.set(i.valid, 0)

    bench.drive(line)
    bench.run(cycles=100_000)
    return [frame for frame, _ in got], bench.counts


def none_dropped() -> dict[str, int]:
    return dict.fromkeys(REASONS, 0)


@pytest.mark.parametrize("stalls", STALLS)
def test_octets_by_hand_are_packets(stalls: int) -> None:
    octets = [octet for _, line in BY_HAND for octet in line]
    assert receive(octets, stalls) == ([packet for packet, _ in BY_HAND], none_dropped())


@pytest.mark.parametrize("stalls", STALLS)
def test_what_sliplib_sends_is_received(stalls: int) -> None:
    packets = random_packets(20, 40)
    octets = [octet for packet in packets for octet in framed(packet)]
    assert receive(octets, stalls) == (packets, none_dropped())


@pytest.mark.parametrize("stalls", STALLS)
def test_empty_packets_are_none_and_one_end_between_packets_is_enough(stalls: int) -> None:
    assert receive([192, 192, 192, 1, 192, 2, 192, 192, 192], stalls) == ([b"\1", b"\2"], none_dropped())


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize(
    ("middle", "given", "reason"),
    [
        ([1, 219, 1, 2, 192], [Bad(b"\1")], "drop_escape"),
        ([219, 1, 2, 192], [], "drop_escape"),
        ([219, 219, 220, 192], [], "drop_escape"),
        ([1, 219, 192], [Bad(b"\1")], "drop_escape"),
        ([219] * 50 + [192], [], "drop_escape"),
        ([1, 2, ERROR, 3, 192], [Bad(b"\1\2")], "drop_line"),
        ([ERROR, ERROR, 3, 192], [], "drop_line"),
        ([1, 219, ERROR, 192], [Bad(b"\1")], "drop_line"),
        ([1, ERROR | 192, 5, 192], [Bad(b"\1")], "drop_line"),
        ([7] * 9 + [192], [Bad(b"\7" * 8)], "drop_too_long"),
        ([7] * 8 + [219, 220, 192], [Bad(b"\7" * 8)], "drop_too_long"),
        ([7] * 500 + [192], [Bad(b"\7" * 8)], "drop_too_long"),
    ],
)
def test_a_fault_ends_its_packet_badly_is_counted_once_and_the_next_packet_is_whole(
    middle: list[int], given: list[bytes], reason: str, stalls: int
) -> None:
    got, counts = receive([*framed(b"one"), *middle, *framed(b"two")], stalls, max_size=8)
    assert got == [b"one", *given, b"two"]
    assert [isinstance(frame, Bad) for frame in got] == [False, *[True for _ in given], False]
    assert counts == {**none_dropped(), reason: 1}


def test_the_longest_packet_passes() -> None:
    assert receive(framed(b"\xc0" * 8), 30, max_size=8) == ([b"\xc0" * 8], none_dropped())


def test_ten_thousand_octets_of_noise_are_dropped_by_reason_and_packets_pass_after_them() -> None:
    chance = random.Random(3)
    noise = [octet if octet < 255 else ERROR for octet in chance.choices(range(256), k=10_000)]
    got, counts = receive([*noise, *framed(b"alive")], 0, max_size=64)
    assert got[-1] == b"alive" and not isinstance(got[-1], Bad)
    assert all(counts[reason] > 5 for reason in REASONS), counts
    assert max(map(len, got)) <= 64


def transmit(packets: list[bytes], stalls: int, depth: int = 2048) -> tuple[list[int], int]:
    """What goes over the line, and how much was dropped as too long."""
    bench = Bench(SlipTx(depth), stalls)
    octets: list[int] = []
    bench.send("i", packets)
    bench.count("drop_too_long")

    async def line(ctx: Any) -> None:
        o, held = bench.dut.o, None
        while True:
            ready = bench.random.randrange(100) >= stalls
            ctx.set(o.ready, ready)
            _, _, valid, octet = await ctx.tick().sample(o.valid, o.payload)
            assert held is None or (valid and octet == held), "withdrawn"
            held = octet if valid and not ready else None
            if valid and ready:
                octets.append(octet)

    bench.watch(line)
    good = [packet for packet in packets if not isinstance(packet, Bad) and 0 < len(packet) < depth]
    wanted = sum(len(framed(packet)) for packet in good)
    bench.run(lambda: len(octets) >= wanted, cycles=100_000, rest=2 * depth if depth < 100 else 300)
    return octets, bench.counts["drop_too_long"]


@pytest.mark.parametrize("stalls", STALLS)
def test_packets_are_the_octets_by_hand(stalls: int) -> None:
    octets, dropped = transmit([packet for packet, _ in BY_HAND], stalls)
    assert octets == [octet for _, line in BY_HAND for octet in line] and dropped == 0


@pytest.mark.parametrize("stalls", STALLS)
def test_sliplib_reads_what_is_sent_however_small_the_memory(stalls: int) -> None:
    packets = random_packets(30, 32, seed=2)
    octets, dropped = transmit(packets, stalls, depth=32)
    driver = sliplib.Driver()
    driver.receive(bytes(octets))
    got = [driver.get(block=False) for _ in packets]
    assert got == packets and dropped == 0
    assert octets == [octet for packet in packets for octet in framed(packet)]


@pytest.mark.parametrize("stalls", STALLS)
def test_packets_that_end_badly_or_are_empty_or_too_long_leave_nothing_on_the_line(stalls: int) -> None:
    packets = [
        Bad(b"x"),
        b"one",
        b"",
        Bad(b""),
        Bad(b"yy"),
        b"z" * 16,
        b"w" * 15,
        b"v" * 99,
        Bad(b"u" * 99),
        b"two",
    ]
    octets, dropped = transmit(packets, stalls, depth=16)
    assert octets == [octet for packet in (b"one", b"w" * 15, b"two") for octet in framed(packet)]
    assert dropped == 2


def test_a_packet_begins_soon_after_its_end_and_an_octet_takes_two_cycles() -> None:
    bench = Bench(WholeFrameFifo(16), stalls=0)
    bench.send("i", [b"abcdefgh"])
    got = bench.receive("o")
    bench.run(lambda: len(got) == 1, cycles=9 + 3 + 2 * 9)
    assert got[0][0] == b"abcdefgh"


def test_bounds_are_checked() -> None:
    for depth in (0, 1, 12):
        with pytest.raises(ValueError, match="a power of two of items"):
            SlipTx(depth)
    with pytest.raises(ValueError, match="at least one octet"):
        SlipRx(0)
