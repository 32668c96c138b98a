"""Queues of frames: order and content, however the clocks stand to each other; overflow loses whole frames."""

from __future__ import annotations

import random
from typing import Any

import pytest
from amaranth.hdl import Module, unsigned
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from amaranth.sim import Simulator

from gateware.frames import STALLS, Bad, Bench
from gateware.phy import some
from gateware.words import WordBench
from roslet.gateware.fifo import (
    AsyncFrameFifo,
    FrameFifo,
    FrameRegister,
    FrameStage,
    LossyFrameFifo,
    MessageRegister,
)
from roslet.gateware.stream import FrameSignature

CLOCKS = pytest.mark.parametrize("other", [40e-9, 10.001e-9, 3e-9])
"""Periods of the other domain; that of `sync` is 10 ns."""


def some_frames(seed: int, count: int, longest: int) -> list[bytes]:
    rng = random.Random(seed)
    frames = [some(rng, rng.randrange(longest)) for _ in range(count)]
    return [Bad(frame) if rng.random() < 0.3 else frame for frame in frames]


def kinds(frames: list[bytes]) -> list[tuple[bytes, bool]]:
    return [(bytes(frame), isinstance(frame, Bad)) for frame in frames]


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("depth", [2, 3, 64])
def test_a_queue_keeps_frames_as_they_are(depth: int, stalls: int) -> None:
    frames = some_frames(depth, 20, 30)
    bench = Bench(FrameFifo(depth), stalls)
    bench.send("i", frames)
    got = bench.receive("o")
    bench.run(lambda: len(got) == len(frames))
    assert kinds([frame for frame, _ in got]) == kinds(frames)


@pytest.mark.parametrize("depth", [2, 64])
def test_an_item_passes_every_cycle(depth: int) -> None:
    bench = Bench(FrameFifo(depth), stalls=0)
    bench.send("i", [bytes(99)] * 5)
    got = bench.receive("o")
    bench.run(lambda: len(got) == 5, cycles=510)


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("register", [FrameRegister, FrameStage])
def test_registers_keep_frames_and_what_is_known_of_them(
    register: type[FrameRegister | FrameStage], stalls: int
) -> None:
    frames = some_frames(8, 30, 12)
    bench = Bench(register(unsigned(8)), stalls)
    bench.send("i", frames, list(range(len(frames))))
    got = bench.receive("o")
    bench.run(lambda: len(got) == len(frames))
    assert kinds([frame for frame, _ in got]) == kinds(frames)
    assert [meta for _, meta in got] == list(range(len(frames)))


def test_registers_pass_an_octet_every_cycle_and_take_two_more_for_an_end_with_meta() -> None:
    bench = Bench(FrameRegister(unsigned(8)), stalls=0)
    bench.send("i", [bytes(99)] * 5, [0] * 5)
    got = bench.receive("o")
    bench.run(lambda: len(got) == 5, cycles=5 * (99 + 1 + 2) + 2)


def test_a_stage_takes_one_more_for_an_end_with_meta() -> None:
    bench = Bench(FrameStage(unsigned(8)), stalls=0)
    bench.send("i", [bytes(99)] * 5, [0] * 5)
    got = bench.receive("o")
    bench.run(lambda: len(got) == 5, cycles=5 * (99 + 1 + 1) + 2)


@pytest.mark.parametrize("stalls", [0, 30])
def test_a_stage_without_meta_keeps_frames(stalls: int) -> None:
    frames = some_frames(8, 30, 12)
    bench = Bench(FrameStage(), stalls)
    bench.send("i", frames)
    got = bench.receive("o")
    bench.run(lambda: len(got) == len(frames))
    assert kinds([frame for frame, _ in got]) == kinds(frames)


@pytest.mark.parametrize("stalls", STALLS)
def test_a_place_for_messages_keeps_them_and_what_is_known_of_them(stalls: int) -> None:
    messages = [type(frame)(4 * frame) for frame in some_frames(9, 30, 10)]
    bench = WordBench(MessageRegister(unsigned(8)), stalls)
    bench.send_words("i", messages, list(range(len(messages))))
    got = bench.receive_words("o")
    bench.run(lambda: len(got) == len(messages))
    assert kinds([message for message, _ in got]) == kinds(messages)
    assert [meta for _, meta in got] == list(range(len(messages)))


def test_an_empty_place_for_messages_has_what_was_before_it_although_that_is_not_valid() -> None:
    """The participant keeps words by that: a GUID prefix, and a key, pass two places without being taken."""
    block = MessageRegister(unsigned(8))
    simulator = Simulator(block)
    simulator.add_clock(1e-6)

    async def bench(ctx: Any) -> None:
        for word in (5, 0xFFFFFFFF, 0, 7):
            ctx.set(block.i.stream.payload.data, word)
            await ctx.tick()
            assert not ctx.get(block.o.stream.valid)
            assert ctx.get(block.o.stream.payload.data) == word

    simulator.add_testbench(bench)
    simulator.run()


def test_a_place_for_messages_passes_a_word_in_two_cycles() -> None:
    bench = WordBench(MessageRegister(unsigned(8)), stalls=0)
    bench.send_words("i", [bytes(400)] * 5, [0] * 5)
    got = bench.receive_words("o")
    bench.run(lambda: len(got) == 5, cycles=5 * (2 * 100 + 1 + 2) + 2)


@CLOCKS
@pytest.mark.parametrize("towards", [True, False])
def test_a_queue_between_clocks_keeps_frames_as_they_are(other: float, towards: bool) -> None:
    """The other side is a queue of two places in the other domain, so that the bench sees `sync` only."""
    frames = some_frames(5, 12, 40)
    m = Module()
    m.submodules.there = there = AsyncFrameFifo(16, "sync", "other")
    m.submodules.back = back = AsyncFrameFifo(4, "other", "sync")
    wiring.connect(m, there.o, back.i)
    bench = Bench(_Ports(m, there.i, back.o), 20 if towards else 60, clocks={"other": other})
    bench.send("i", frames)
    got = bench.receive("o")
    bench.run(lambda: len(got) == len(frames))
    assert kinds([frame for frame, _ in got]) == kinds(frames)


class _Ports(wiring.Component):
    """The ports of what is inside a module."""

    def __init__(self, inside: Module, i: Any, o: Any) -> None:
        super().__init__({"i": In(FrameSignature()), "o": Out(FrameSignature())})
        self._inside, self._i, self._o = inside, i, o

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.inside = self._inside
        wiring.connect(m, wiring.flipped(self.i), self._i)
        wiring.connect(m, self._o, wiring.flipped(self.o))
        return m


def overflow(
    frames: list[bytes], depth: int, other: float, quiet: int, pause: int = 0, busy: int = 0
) -> tuple[list[bytes], int]:
    """Frames into a lossy queue, an item in each cycle of the other domain and `pause` cycles between frames, and nothing
    taken out for `quiet` cycles of `sync` at first, nor later in `busy` of a hundred: what came out, and how many were
    counted."""
    bench = Bench(LossyFrameFifo(depth, "other", "sync"), stalls=0, clocks={"other": other})
    dut = bench.dut
    got: list[bytes] = []

    async def put(ctx: Any) -> None:
        for frame in frames:
            for n in range(len(frame) + 1):
                end = n == len(frame)
                ctx.set(dut.i.stream.valid, 1)
                item = {"data": 0 if end else frame[n], "end": end, "bad": end and isinstance(frame, Bad)}
                ctx.set(dut.i.stream.payload, item)
                assert ctx.get(dut.i.stream.ready)
                await ctx.tick("other")
            ctx.set(dut.i.stream.valid, 0)
            for _ in range(pause):
                await ctx.tick("other")

    async def take(ctx: Any) -> None:
        for _ in range(quiet):
            await ctx.tick()
        octets = bytearray()
        while True:
            ready = bench.random.randrange(100) >= busy
            ctx.set(dut.o.stream.ready, ready)
            _, _, valid, item = await ctx.tick().sample(dut.o.stream.valid & ready, dut.o.stream.payload)
            if valid and item.end:
                got.append(Bad(octets) if item.bad else bytes(octets))
                octets.clear()
            elif valid:
                octets.append(item.data)

    bench._simulator.add_testbench(take, background=True)
    bench.drive(put)
    bench.count("drop_overflow")
    bench.run(rest=quiet + 200)
    return got, bench.counts["drop_overflow"]


@CLOCKS
def test_the_frame_that_overflows_ends_badly_and_the_next_is_whole(other: float) -> None:
    frames = [bytes([n]) * 20 for n in range(30)]
    pause = 20 + int(20 * 10e-9 / other)  # time to take a frame
    quiet = int(14 * (21 + pause) * other / 10e-9)  # some 14 of the 30 frames
    got, lost = overflow(frames, 64, other, quiet, pause)
    good = [frame for frame in got if not isinstance(frame, Bad)]
    assert good[:3] == frames[:3]  # 64 places
    assert set(good) <= set(frames) and good == sorted(set(good)) and good[-1] == frames[-1]
    (cut,) = [frame for frame in got if isinstance(frame, Bad)]
    assert cut == frames[3][: len(cut)]
    assert len(good) + lost == len(frames)


@pytest.mark.parametrize("size", range(8))
def test_a_queue_that_is_full_to_the_last_place_still_gives_a_bad_end(size: int) -> None:
    """Whatever fits, every frame that came out in part is ended, and nothing is counted twice."""
    frames = [bytes([n]) * size for n in range(12)]
    got, lost = overflow(frames, 4, 10.001e-9, quiet=40)
    good = [frame for frame in got if not isinstance(frame, Bad)]
    assert set(good) <= set(frames)
    assert len(good) + lost == len(frames)
    assert len(got) - len(good) <= lost


@pytest.mark.parametrize("seed", range(4))
def test_whatever_is_lost_frames_are_whole_or_bad_and_all_accounted_for(seed: int) -> None:
    """The reader is slower than the frames, which come without pauses: bad ends are owed while others pass."""
    rng = random.Random(seed)
    frames = [bytes([n]) * rng.randrange(1, 9) for n in range(150)]
    got, lost = overflow(frames, 4, 10.001e-9, quiet=20, busy=40)
    good = [frame for frame in got if not isinstance(frame, Bad)]
    numbers = [frame[0] for frame in good]
    assert good == [frames[n] for n in numbers] and numbers == sorted(set(numbers))
    assert len(good) + lost == len(frames) and lost > 10 and len(good) > 10


@CLOCKS
def test_nothing_is_lost_where_there_is_room(other: float) -> None:
    frames = some_frames(9, 10, 20)
    got, lost = overflow(frames, 256, other, quiet=0)
    assert (kinds(got), lost) == (kinds(frames), 0)


def test_depths_are_checked() -> None:
    with pytest.raises(ValueError, match="at least two places, not 1"):
        FrameFifo(1)
    for block in (AsyncFrameFifo, LossyFrameFifo):
        for depth in (0, 2, 96):
            with pytest.raises(ValueError, match=f"must be a power of two from 4 on, and not {depth}"):
                block(depth, "a", "b")
