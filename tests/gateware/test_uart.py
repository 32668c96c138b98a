"""Octets on a wire: the wire is made, and read, by hand."""

from __future__ import annotations

import random
from typing import Any

import pytest

from gateware.frames import Bench
from roslet.gateware.uart import UartRx, UartTx

DIVISOR = 16


def levels(octet: int, stop: int = 1) -> list[int]:
    """Start bit, the lowest bit first, stop bit: as every UART has it since the teletype."""
    return [0, *(octet >> n & 1 for n in range(8)), stop]


class Wire:
    """A receiver, what it gave, and a wire whose bits take `bit` cycles of it, from any phase on (in bits)."""

    def __init__(
        self, divisor: int = DIVISOR, bit: float | None = None, phase: float = 0.0, stalls: int = 0
    ) -> None:
        self.bench = Bench(UartRx(divisor), stalls=0)
        self.divisor = divisor
        self.bit = float(divisor) if bit is None else bit
        self.phase = phase
        self.got: list[tuple[int, int]] = []
        self.bench.count("drop_framing", "drop_overrun")
        self.take_after = stalls

    async def _take(self, ctx: Any) -> None:
        o = self.bench.dut.o
        waited = 0
        while True:
            ctx.set(o.ready, 0)
            _, _, valid = await ctx.tick().sample(o.valid)
            waited = waited + 1 if valid else 0
            if waited > self.take_after:
                ctx.set(o.ready, 1)
                _, _, octet, bad = await ctx.tick().sample(o.payload.data, o.payload.bad)
                self.got.append((octet, bad))
                waited = 0

    def play(self, bits: list[tuple[int, float]]) -> list[tuple[int, int]]:
        """Hold each level for so many bits of the wire; what the receiver gave."""

        async def wire(ctx: Any) -> None:
            ctx.set(self.bench.dut.rx, 1)
            await ctx.tick().repeat(20)
            at, cycle = 0.0, 0
            for level, width in [(1, self.phase), *bits]:
                ctx.set(self.bench.dut.rx, level)
                at += width * self.bit
                if round(at) > cycle:
                    await ctx.tick().repeat(round(at) - cycle)
                    cycle = round(at)
            ctx.set(self.bench.dut.rx, 1)
            await ctx.tick().repeat(12 * self.divisor)

        self.bench.watch(self._take)
        self.bench.drive(wire)
        self.bench.run(cycles=200_000)
        return self.got


def sent(octets: bytes) -> list[tuple[int, float]]:
    return [(level, 1.0) for octet in octets for level in levels(octet)]


OCTETS = bytes([0x00, 0xFF, 0x55, 0xAA, 0x01, 0x80, 0xC0, 0xDB])


@pytest.mark.parametrize("divisor", [8, 27, 50])
@pytest.mark.parametrize("off", [-0.02, 0.0, 0.02])
def test_octets_back_to_back_are_received_from_any_phase_and_a_clock_that_is_2_percent_off(
    divisor: int, off: float
) -> None:
    for phase in (0.0, 0.4):
        wire = Wire(divisor, bit=divisor * (1 + off), phase=phase)
        assert wire.play(sent(OCTETS)) == [(octet, 0) for octet in OCTETS]
        assert wire.bench.counts == {"drop_framing": 0, "drop_overrun": 0}


def test_an_octet_without_stop_bit_is_bad_and_counted_and_the_next_is_received() -> None:
    wire = Wire()
    bits = [(level, 1.0) for level in levels(0x41, stop=0)] + [(1, 1.0)] + sent(b"B")
    assert [bad for _, bad in wire.play(bits)] == [1, 0]
    assert wire.got[1] == (0x42, 0) and wire.bench.counts["drop_framing"] == 1


def test_a_break_is_one_bad_octet_however_long() -> None:
    wire = Wire()
    assert [bad for _, bad in wire.play([(0, 300.0), (1, 2.0), *sent(b"B")])] == [1, 0]
    assert wire.bench.counts["drop_framing"] == 1


def test_a_short_pulse_is_no_start_bit() -> None:
    wire = Wire()
    assert wire.play([(0, 0.3), (1, 2.0), *sent(b"B")]) == [(0x42, 0)]
    assert wire.bench.counts["drop_framing"] == 0


def test_a_pulse_in_the_middle_of_a_bit_is_outvoted() -> None:
    wire = Wire()
    start, *rest = sent(b"\x00")
    pulse = [(0, 0.45), (1, 0.1), (0, 0.45)]
    assert wire.play([start, *pulse, *rest[1:]]) == [(0, 0)]


def test_an_octet_that_is_not_taken_in_time_is_lost_and_the_next_one_says_so() -> None:
    wire = Wire(stalls=int(DIVISOR * 15))
    got = wire.play([*sent(b"ab"), (1, 20.0), *sent(b"c")])
    assert wire.bench.counts["drop_overrun"] == 1
    assert got == [(ord("b"), 1), (ord("c"), 0)]


def test_octets_may_wait_for_almost_the_time_of_one() -> None:
    wire = Wire(stalls=DIVISOR * 10 - 8)
    assert wire.play(sent(OCTETS)) == [(octet, 0) for octet in OCTETS]


@pytest.mark.parametrize("divisor", [8, 25])
def test_what_is_sent_has_bits_of_the_right_length_and_no_gaps(divisor: int) -> None:
    bench = Bench(UartTx(divisor))
    seen: list[int] = []

    async def watch(ctx: Any) -> None:
        while True:
            _, _, tx = await ctx.tick().sample(bench.dut.tx)
            seen.append(tx)

    async def give(ctx: Any) -> None:
        for octet in OCTETS:
            ctx.set(bench.dut.i.payload, octet)
            ctx.set(bench.dut.i.valid, 1)
            ready = False
            while not ready:
                _, _, ready = await ctx.tick().sample(bench.dut.i.ready)
        ctx.set(bench.dut.i.valid, 0)

    bench.watch(watch)
    bench.drive(give)
    bench.run(rest=12 * divisor)
    begin = seen.index(0)
    wanted = [level for octet in OCTETS for level in levels(octet) for _ in range(divisor)]
    assert seen[begin:][: len(wanted)] == wanted
    assert set(seen[:begin]) <= {1} and set(seen[begin + len(wanted) :]) == {1}


def test_noise_on_the_wire_leaves_the_receiver_alive() -> None:
    chance = random.Random(5)
    wire = Wire(8)
    bits = [(chance.randrange(2), chance.random() * 2) for _ in range(800)]
    got = wire.play([*bits, (1, 11.0), *sent(b"alive")])
    assert got[-5:] == [(octet, 0) for octet in b"alive"]
    assert wire.bench.counts["drop_framing"] > 10


def test_a_bit_of_few_cycles_is_refused() -> None:
    for block in (UartRx, UartTx):
        with pytest.raises(ValueError, match="a bit takes 8 cycles at least, not 7"):
            block(7)
