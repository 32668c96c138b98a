"""The MAC with its three clocks: both directions, at line rate, with stalls, and every reason to drop a frame counted."""

from __future__ import annotations

import random
from typing import Any

import pytest

from gateware.frames import Bad, Bench, taken
from gateware.phy import IDLE, PREAMBLE, Cycle, Watch, fcs, play, sealed, shown, some
from roslet.gateware.mac import Mac, PhyReset

DROPS = tuple(
    f"drop_{reason}"
    for reason in ("fcs", "rx_er", "runt", "giant", "odd", "sfd", "overflow", "underrun", "tx_giant")
)
FRAME = bytes.fromhex("ffff ffff ffff 0200 0000 0002 0806") + bytes(range(46))
WIDTHS = {"mii": 4, "gmii": 8}
PERIODS = {"mii": 40e-9, "gmii": 8e-9}
FAST, SLOW = 0.9999, 1.0001  # 100 ppm, IEEE 802.3, 22.2.2.1, 35.2.2.1

LINE_RATE = pytest.mark.parametrize(
    ("phy", "period", "skew"),
    [
        ("mii", 20e-9, FAST),
        ("mii", 20e-9, SLOW),
        ("mii", 8e-9, 1.0),
        ("gmii", 8e-9, FAST),
        ("gmii", 8e-9, SLOW),
    ],
)
"""The core's period, and how much longer than its nominal one is the PHY's."""


class MacBench(Bench):
    """A MAC, its PHY, and what was sent."""

    def __init__(self, phy: str, period: float, stalls: int, skew: float = 1.0, **depths: int) -> None:
        clock = PERIODS[phy] * skew
        super().__init__(
            Mac(phy, **depths), stalls, period=period, clocks={"phy_rx": clock, "phy_tx": clock * 1.00001}
        )
        pins = self.dut.pins
        outputs = [pins.phy_txd, pins.phy_tx_en, *([pins.phy_tx_er] if phy == "gmii" else [])]
        self.width = WIDTHS[phy]
        self.line = Watch(outputs, self.width, "phy_tx")
        self._simulator.add_testbench(self.line.run, background=True)
        self.count(*DROPS)

        async def wake(ctx: Any) -> None:
            for _ in range(8):  # until the queues are out of their reset
                await ctx.tick("phy_tx")
            self.stalls = stalls

        self.stalls = 100
        self._simulator.add_testbench(wake, background=True)

    def show(self, cycles: list[Cycle]) -> None:
        pins = self.dut.pins.phy_rxd, self.dut.pins.phy_rx_dv, self.dut.pins.phy_rx_er
        self.drive(lambda ctx: play(ctx, pins, cycles, "phy_rx"))

    @property
    def dropped(self) -> dict[str, int]:
        return {name.removeprefix("drop_"): n for name, n in self.counts.items() if n}


@LINE_RATE
def test_minimum_frames_back_to_back_lose_nothing_in_either_direction(
    phy: str, period: float, skew: float
) -> None:
    rng = random.Random(3)
    frames = [some(rng, 60) for _ in range(6)]
    bench = MacBench(phy, period, stalls=0, skew=skew, rx_depth=128, tx_depth=128)
    bench.show([IDLE, *(cycle for frame in frames for cycle in shown(PREAMBLE + sealed(frame), bench.width))])
    bench.send("tx", frames)
    got = bench.receive("rx")
    bench.run(lambda: len(got) == len(bench.line.carriers) == len(frames))
    assert [frame for frame, _ in got] == frames
    assert bench.line.carriers == [PREAMBLE + sealed(frame) for frame in frames]
    assert bench.line.gaps[1:] == [96 // bench.width] * (len(frames) - 1)
    assert bench.dropped == {}


@pytest.mark.parametrize(("stalls", "period"), [(30, 20e-9), (60, 10e-9)])
def test_stalls_that_leave_the_core_faster_than_the_line_lose_nothing(stalls: int, period: float) -> None:
    rng = random.Random(stalls)
    frames = [some(rng, size) for size in (60, 150, 61)]
    bench = MacBench("mii", period, stalls, rx_depth=64, tx_depth=64)
    bench.show([IDLE, *(cycle for frame in frames for cycle in shown(PREAMBLE + sealed(frame), 4))])
    bench.send("tx", frames)
    got = bench.receive("rx")
    bench.run(lambda: len(got) == len(bench.line.carriers) == len(frames))
    assert [frame for frame, _ in got] == bench.line.frames == frames
    assert bench.dropped == {}


@pytest.mark.parametrize(("phy", "period"), [("mii", 20e-9), ("gmii", 8e-9)])
def test_every_wrong_frame_is_counted_by_its_reason_and_the_next_is_taken(phy: str, period: float) -> None:
    bench = MacBench(phy, period, stalls=0)
    width = bench.width
    good = PREAMBLE + sealed(FRAME)
    wrong = [
        ("fcs", shown(good[:-1] + b"\0", width)),
        ("rx_er", shown(good, width, error=[50])),
        ("runt", shown(PREAMBLE + FRAME[:30] + fcs(FRAME[:30]), width)),
        ("sfd", shown(b"\x55" * 4, width)),
        ("sfd", shown(FRAME, width)),
    ]
    if width == 4:
        wrong.append(("odd", shown(good, width, gap=0) + [(0, 1, 0)] + [IDLE] * 24))
    else:  # in half the cycles
        wrong.append(("giant", shown(PREAMBLE + sealed(bytes(1515)), width)))
    cycles = [IDLE]
    for _, carrier in wrong:
        cycles += carrier + shown(good, width)
    bench.show(cycles)
    got = bench.receive("rx")
    bench.run(lambda: sum(not isinstance(frame, Bad) for frame, _ in got) == len(wrong))
    assert [frame for frame, _ in got if not isinstance(frame, Bad)] == [FRAME] * len(wrong)
    reasons = [reason for reason, _ in wrong]
    assert bench.dropped == {reason: reasons.count(reason) for reason in reasons}


def test_a_core_that_does_not_take_frames_loses_whole_ones() -> None:
    frames = [bytes([n]) * 60 for n in range(12)]
    bench = MacBench("gmii", 8e-9, stalls=100, rx_depth=256)
    bench.show([IDLE, *(cycle for frame in frames for cycle in shown(PREAMBLE + sealed(frame), 8))])
    got = bench.receive("rx")

    async def wake(ctx: Any) -> None:
        await ctx.tick().repeat(6 * 84)
        bench.stalls = 0

    bench.drive(wake)
    bench.run(rest=300)
    good = [frame for frame, _ in got if not isinstance(frame, Bad)]
    assert good[:4] == frames[:4] and good[-1] == frames[-1] and set(good) <= set(frames)
    assert bench.dropped == {"overflow": len(frames) - len(good)}
    assert len(got) - len(good) == 1


def test_frames_that_cannot_be_sent_are_spoilt_and_counted() -> None:
    bench = MacBench("gmii", 8e-9, stalls=0)
    bench.send("tx", [bytes(1515), FRAME, Bad(FRAME[:20]), FRAME])

    async def dry(ctx: Any) -> None:
        while len(bench.line.carriers) < 4:
            await ctx.tick()
        stream = bench.dut.tx.stream
        for n in range(31):
            if n == 30:
                for _ in range(1000):
                    await ctx.tick()
            ctx.set(stream.payload, {"data": n, "end": n == 30, "bad": 0})
            ctx.set(stream.valid, 1)
            await taken(ctx, stream)
            ctx.set(stream.valid, 0)

    bench.drive(dry)
    bench.run(lambda: len(bench.line.carriers) == 5)
    assert bench.line.frames == [FRAME, FRAME]
    assert bench.dropped == {"tx_giant": 1, "underrun": 1}


@pytest.mark.parametrize(
    ("phy", "period", "lateness", "spoilt"),
    [
        ("mii", 10e-9, 7 * 8, False),
        ("mii", 10e-9, 9 * 8, True),
        ("gmii", 8e-9, 7, False),
        ("gmii", 8e-9, 9, True),
    ],
)
def test_a_frame_may_be_late_by_seven_octets(phy: str, period: float, lateness: int, spoilt: bool) -> None:
    """The core pauses for `lateness` cycles after the first octet, and then gives the others at the rate of the line."""
    bench = MacBench(phy, period, stalls=0)
    octet_time = round(PERIODS[phy] * 8 / WIDTHS[phy] / period)
    stream = bench.dut.tx.stream

    async def process(ctx: Any) -> None:
        while bench.stalls:
            await ctx.tick()
        for n in range(len(FRAME) + 1):
            end = n == len(FRAME)
            ctx.set(stream.payload, {"data": 0 if end else FRAME[n], "end": end, "bad": 0})
            ctx.set(stream.valid, 1)
            await ctx.tick()
            ctx.set(stream.valid, 0)
            pause = octet_time - 1 + (lateness if n == 0 else 0)
            if pause:
                await ctx.tick().repeat(pause)

    bench.drive(process)
    bench.run(lambda: len(bench.line.carriers) == 1)
    assert bench.line.frames == ([] if spoilt else [FRAME])
    assert bench.dropped == ({"underrun": 1} if spoilt else {})


@pytest.mark.parametrize(("phy", "period"), [("mii", 20e-9), ("mii", 10e-9), ("gmii", 8e-9)])
def test_latencies_are_as_stated(phy: str, period: float) -> None:
    """From edge to edge at which something is seen, so one more of the last clock than until it is there."""
    times: dict[str, int] = {}
    bench = MacBench(phy, period, stalls=0)
    pins, rx, tx = bench.dut.pins, bench.dut.rx.stream, bench.dut.tx.stream
    bench.send("tx", [FRAME])
    bench.show([IDLE, *shown(PREAMBLE + sealed(FRAME), bench.width)])
    bench.receive("rx")

    now = 0

    async def watch(ctx: Any) -> None:
        nonlocal now
        while True:
            await ctx.delay(1e-9)
            now += 1

    def note(name: str, domain: str, signal: Any) -> None:
        async def process(ctx: Any) -> None:
            before = 0
            while True:
                (_, _, high) = await ctx.tick(domain).sample(signal)
                if (before and not high) if name == "silent" else high:
                    times.setdefault(name, now)
                before = high

        bench._simulator.add_testbench(process, background=True)

    bench._simulator.add_testbench(watch, background=True)
    note("taken", "sync", tx.valid & tx.ready)
    note("preamble", "phy_tx", pins.phy_tx_en)
    note("silent", "phy_rx", pins.phy_rx_dv)
    note("end", "sync", rx.valid & rx.payload.end)
    bench.run(lambda: {"end", "preamble"} <= set(times))
    assert times["preamble"] - times["taken"] <= 1e9 * 7 * PERIODS[phy] + 1
    assert times["end"] - times["silent"] <= 1e9 * (2 * PERIODS[phy] + 5 * period) + 1


def test_a_phy_is_held_in_reset_for_as_long_as_asked() -> None:
    bench = Bench(PhyReset(100))
    levels: list[int] = []

    async def process(ctx: Any) -> None:
        for _ in range(110):
            levels.append(ctx.get(bench.dut.phy_rst_n))
            await ctx.tick()

    bench.drive(process)
    bench.run()
    assert levels == [0] * 100 + [1] * 10


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(ValueError, match="a PHY is one of mii, gmii, not 'rmii'"):
        Mac("rmii")
    with pytest.raises(ValueError, match="must be a power of two from 4 on, and not 1000"):
        Mac(rx_depth=1000)
    with pytest.raises(ValueError, match="a reset takes at least one cycle, not 0"):
        PhyReset(0)
