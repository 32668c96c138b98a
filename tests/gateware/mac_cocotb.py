"""Runs inside the Verilog simulator, which `test_mac_cocotb.py` starts: cocotbext-eth's models of a PHY against `Mac`.

`PHY` and `PERIOD`, of the core in picoseconds, come in the environment.
"""

from __future__ import annotations

import os
import random
from collections import Counter
from itertools import pairwise
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge, Timer
from cocotbext.eth import GmiiFrame, GmiiSink, GmiiSource, MiiSink, MiiSource

PHY = os.environ.get("PHY", "mii")
PERIOD = int(os.environ.get("PERIOD", "20000"))
GAP = {"mii": 24, "gmii": 12}[PHY]  # cycles in 96 bit times: the models count cycles
RX_PERIOD, TX_PERIOD = {"mii": (40004, 39996), "gmii": (8002, 7998)}[PHY]  # picoseconds, 100 ppm off and more
REASONS = ("fcs", "rx_er", "runt", "giant", "odd", "sfd", "overflow", "underrun", "tx_giant")
END, BAD = 1 << 8, 1 << 9  # in an item, behind the octet


def frame(rng: random.Random, size: int) -> bytes:
    return bytes(rng.randrange(256) for _ in range(size))


class Bed:
    """The design under its three clocks, a PHY on the pins and a core that is ready in `ready` of a hundred cycles."""

    def __init__(self, dut: Any, ready: int = 100) -> None:
        self.dut = dut
        self.received: list[bytes] = []
        self.octets = bytearray()
        self.bad = 0
        self.dropped: Counter[str] = Counter()
        pins = [getattr(dut, f"pins__phy_{name}") for name in ("rxd", "rx_dv", "rx_er", "txd", "tx_en")]
        rxd, rx_dv, rx_er, txd, tx_en = pins
        if PHY == "mii":
            self.source = MiiSource(rxd, rx_er, rx_dv, dut.phy_rx_clk)
            self.sink = MiiSink(txd, None, tx_en, dut.phy_tx_clk)
        else:
            self.source = GmiiSource(rxd, rx_er, rx_dv, dut.phy_rx_clk)
            self.sink = GmiiSink(txd, dut.pins__phy_tx_er, tx_en, dut.phy_tx_clk)
        self.source.ifg = GAP
        self._ready = ready
        self._random = random.Random(PHY)

    async def start(self) -> None:
        dut = self.dut
        dut.rst.value = 1
        dut.tx__stream__valid.value = 0
        dut.rx__stream__ready.value = 0
        Clock(dut.clk, PERIOD, "ps").start()
        Clock(dut.phy_rx_clk, RX_PERIOD, "ps").start()
        Clock(dut.phy_tx_clk, TX_PERIOD, "ps").start()
        await Timer(500, "ns")
        dut.rst.value = 0
        await Timer(500, "ns")
        cocotb.start_soon(self._take())

    async def _take(self) -> None:
        dut = self.dut
        drops = [(reason, getattr(dut, f"drop_{reason}")) for reason in REASONS]
        clock = RisingEdge(dut.clk)
        while True:
            ready = self._random.randrange(100) < self._ready
            dut.rx__stream__ready.value = int(ready)
            await clock
            for reason, drop in drops:
                if drop.value:
                    self.dropped[reason] += 1
            if not (ready and dut.rx__stream__valid.value):
                continue
            item = int(dut.rx__stream__payload.value)
            if not item & END:
                self.octets.append(item & 0xFF)
                continue
            if item & BAD:
                self.bad += 1
            else:
                self.received.append(bytes(self.octets))
            self.octets.clear()

    async def send(self, octets: bytes, end: int = END) -> None:
        """An octet as soon as it is taken."""
        dut = self.dut
        clock = RisingEdge(dut.clk)
        await clock
        for item in (*octets, end):
            dut.tx__stream__payload.value = item
            dut.tx__stream__valid.value = 1
            await clock
            while not dut.tx__stream__ready.value:
                await clock
        dut.tx__stream__valid.value = 0

    async def until(self, done: Any) -> None:
        for _ in range(1000):
            if done():
                break
            await Timer(1, "us")
        assert done(), (len(self.received), self.sink.count(), self.dropped)
        await Timer(1, "us")

    def sent(self) -> list[Any]:
        return [self.sink.recv_nowait() for _ in range(self.sink.count())]


@cocotb.test()
async def frames_of_random_sizes_pass_both_ways(dut: Any) -> None:
    rng = random.Random(1)
    bed = Bed(dut, ready=100 if PHY == "gmii" else 70)
    await bed.start()
    sizes = [60, 61, 1514, *(rng.randrange(60, 300) for _ in range(4))]
    down, up = ([frame(rng, size) for size in sizes] for _ in range(2))

    async def show() -> None:
        for octets in down:
            bed.source.ifg = GAP + rng.randrange(60)
            await bed.source.send(GmiiFrame.from_payload(octets))
            await bed.source.wait()

    shown = cocotb.start_soon(show())
    for octets in up:
        await bed.send(octets)
        for _ in range(rng.randrange(3)):
            await Timer(rng.randrange(3000), "ns")
    await shown
    await bed.until(lambda: len(bed.received) == bed.sink.count() == len(sizes))
    assert bed.received == down
    sent = bed.sent()
    assert [bytes(one.get_payload()) for one in sent] == up
    assert all(
        one.check_fcs() and not one.error and one.get_preamble_len() >= 7 for one in sent
    )  # the models miss a cycle
    assert not bed.dropped and not bed.bad


@cocotb.test()
async def minimum_frames_back_to_back_at_line_rate_lose_nothing(dut: Any) -> None:
    rng = random.Random(2)
    bed = Bed(dut)
    await bed.start()
    down, up = ([frame(rng, 60) for _ in range(12)] for _ in range(2))
    for octets in down:
        await bed.source.send(GmiiFrame.from_payload(octets))
    for octets in up:
        await bed.send(octets)
    await bed.until(lambda: len(bed.received) == bed.sink.count() == len(up))
    assert bed.received == down
    sent = bed.sent()
    assert [bytes(one.get_payload()) for one in sent] == up and all(one.check_fcs() for one in sent)
    starts = [one.sim_time_start for one in sent]
    spacing = 84 * 8 // {"mii": 4, "gmii": 8}[PHY] * TX_PERIOD
    assert {later - one for one, later in pairwise(starts)} == {spacing}
    assert not bed.dropped and not bed.bad


@cocotb.test()
async def wrong_frames_are_dropped_and_counted_and_the_next_is_taken(dut: Any) -> None:
    rng = random.Random(3)
    bed = Bed(dut)
    await bed.start()
    good = [frame(rng, 64) for _ in range(5)]
    wrong_fcs = GmiiFrame.from_payload(frame(rng, 100))
    wrong_fcs.data[-1] ^= 1
    error = GmiiFrame.from_payload(frame(rng, 100))
    error.error = [int(n == 50) for n in range(len(error.data))]
    runt = GmiiFrame.from_payload(frame(rng, 40), min_len=0)
    giant = GmiiFrame.from_payload(frame(rng, 1515))
    wrong = {"fcs": wrong_fcs, "rx_er": error, "runt": runt, "giant": giant}
    for octets, one in zip(good, (*wrong.values(), None), strict=True):
        await bed.source.send(GmiiFrame.from_payload(octets))
        if one is not None:
            await bed.source.send(one)
    await bed.until(lambda: len(bed.received) == len(good))
    assert bed.received == good
    assert bed.dropped == Counter(wrong.keys()) and bed.bad == len(wrong)


@cocotb.test()
async def what_cannot_be_sent_is_spoilt_and_counted(dut: Any) -> None:
    rng = random.Random(4)
    bed = Bed(dut)
    await bed.start()
    await bed.send(frame(rng, 30), END | BAD)
    await bed.send(b"short")
    await bed.send(frame(rng, 1515))
    await bed.send(b"after")
    await bed.until(lambda: bed.sink.count() == 4)
    sent = bed.sent()
    assert [one.check_fcs() for one in sent] == [False, True, False, True]
    assert [bytes(one.get_payload()) for one in sent[1::2]] == [
        b"short".ljust(60, b"\0"),
        b"after".ljust(60, b"\0"),
    ]
    assert bed.dropped == Counter(["tx_giant"])


@cocotb.test()
async def a_reset_of_one_cycle_amid_frames_leaves_nothing_of_them(dut: Any) -> None:
    rng = random.Random(5)
    bed = Bed(dut)
    await bed.start()
    for _ in range(4):
        bed.received.clear()
        await bed.source.send(GmiiFrame.from_payload(frame(rng, 200)))
        sending = cocotb.start_soon(bed.send(frame(rng, 200)))
        await Timer(RX_PERIOD * 2 * rng.randrange(40, 80), "ps")
        await RisingEdge(dut.clk)
        sending.cancel()
        dut.tx__stream__valid.value = 0
        dut.rst.value = 1
        await RisingEdge(dut.clk)
        dut.rst.value = 0
        await RisingEdge(dut.clk)
        bed.octets.clear()
        await bed.source.wait()
        await Timer(1, "us")
        good = frame(rng, 70)
        await bed.source.send(GmiiFrame.from_payload(good))
        await bed.send(good)
        await bed.until(lambda: bed.received and bed.sink.count() == 2)
        cut, whole = bed.sent()
        assert bed.received == [good] and not bed.bad and not bed.dropped
        assert not cut.check_fcs() and whole.check_fcs() and bytes(whole.get_payload()) == good
