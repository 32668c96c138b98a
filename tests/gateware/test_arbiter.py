"""Frames of several senders, and answers to several askers, told apart by what is in them."""

from __future__ import annotations

from typing import Any

import pytest

from gateware.frames import STALLS, Bad, Bench
from roslet.gateware.arbiter import FrameArbiter, LookupArbiter
from roslet.gateware.meta import ETHERNET_TX


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_frames_pass_whole_in_order_with_their_meta(count: int, stalls: int) -> None:
    bench = Bench(FrameArbiter(count, ETHERNET_TX), stalls)
    sent = [[bytes([n]) * size for size in (3, 0, 1, 7)] + [Bad(bytes([n, n]))] for n in range(count)]
    for n, frames in enumerate(sent):
        metas = [{"type": n << 8 | k} for k in range(len(frames))]
        bench.send(f"i{n}", frames, metas)
    got = bench.receive("o")
    bench.run(lambda: len(got) == 5 * count)
    for n, frames in enumerate(sent):
        own = [(frame, type(frame), meta.type & 0xFF) for frame, meta in got if meta.type >> 8 == n]
        assert own == [(frame, type(frame), k) for k, frame in enumerate(frames)]


def test_busy_senders_take_turns() -> None:
    bench = Bench(FrameArbiter(3), stalls=0)
    for n in range(3):
        bench.send(f"i{n}", [bytes([n]) * (n + 1)] * 20)
    got = bench.receive("o")
    bench.run(lambda: len(got) == 60, cycles=20 * (3 * 2 + 6) + 10)
    order = [frame[0] for frame, _ in got]
    assert order == order[:3] * 20
    assert sorted(order[:3]) == [0, 1, 2]


def test_a_frame_keeps_its_turn_while_it_pauses() -> None:
    bench = Bench(FrameArbiter(2), stalls=90)
    bench.send("i0", [b"slow" * 10])
    bench.send("i1", [b"other"] * 3)
    got = bench.receive("o")
    bench.run(lambda: len(got) == 4)
    assert sorted(frame for frame, _ in got) == [b"other"] * 3 + [b"slow" * 10]


@pytest.mark.parametrize("count", [1, 2, 3])
def test_each_asker_gets_the_answer_to_its_own_question_in_turn(count: int) -> None:
    bench = Bench(LookupArbiter(count))
    dut: Any = bench.dut
    answers: list[tuple[int, int]] = []

    async def ask(ctx: Any, n: int) -> None:
        asker = getattr(dut, f"asker{n}")
        for k in range(8):
            ctx.set(asker.ip, n << 8 | k)
            ctx.set(asker.valid, 1)
            answer = ctx.tick().sample(asker.found, asker.failed, asker.mac)
            found, failed, mac = await answer.until(asker.done)
            assert (found, failed, mac) == (k & 1, ~k & 1, (n << 8 | k) * 3)
            answers.append((n, k))
            ctx.set(asker.valid, 0)

    async def resolve(ctx: Any) -> None:
        for _ in range(8 * count):
            await ctx.tick().until(dut.resolver.valid)
            await ctx.tick().repeat(bench.random.randrange(1, 5))
            ip = ctx.get(dut.resolver.ip)
            for name, value in (("done", 1), ("found", ip & 1), ("failed", ~ip & 1), ("mac", ip * 3)):
                ctx.set(getattr(dut.resolver, name), value)
            await ctx.tick()
            ctx.set(dut.resolver.done, 0)

    bench.drive(resolve)
    for n in range(count):
        bench.drive(lambda ctx, n=n: ask(ctx, n))  # type: ignore[misc]
    bench.run()
    order = [n for n, _ in answers]
    assert order == order[:count] * 8


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (FrameArbiter, "an arbiter serves at least one sender, not 0"),
        (LookupArbiter, "an arbiter serves at least one asker, not 0"),
    ],
)
def test_an_arbiter_of_nobody_is_refused(make: Any, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        make(0)
