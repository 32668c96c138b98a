"""Datagrams become words, first octet lowest, and their verdict is known before their end has been read."""

from __future__ import annotations

import random
from typing import Any

import pytest

from gateware.frames import STALLS, Bad
from gateware.words import WordBench
from roslet.gateware.rtps.queue import DatagramQueue

LONGEST = 40


def datagrams(seed: int, count: int = 60) -> list[bytes]:
    random_ = random.Random(seed)
    made = []
    for _ in range(count):
        octets = random_.randbytes(random_.randrange(LONGEST + 1))
        made.append(Bad(octets) if random_.randrange(4) == 0 else octets)
    return made


def watch(bench: WordBench) -> list[tuple[int, int]]:
    """`good` in each cycle in which `known` is high, beside the end that `o` gives; and what contradicts the contract."""
    seen: list[tuple[int, int]] = []
    dut = bench.dut

    async def process(ctx: Any) -> None:
        promised: int | None = None
        while True:
            _, _, known, good, valid, ready, item = await ctx.tick().sample(
                dut.known, dut.good, dut.o.stream.valid, dut.o.stream.ready, dut.o.stream.payload
            )
            if promised is not None and (not known or good != promised):
                bench._faults.append("the verdict changed before its end was taken")
            promised = good if known else None
            if valid and item.end:
                if not known:
                    bench._faults.append("an end stands there and is not known")
                if ready:
                    seen.append((good, item.bad))
                    promised = None

    bench.watch(process)
    return seen


@pytest.mark.parametrize("stalls", STALLS)
def test_datagrams_leave_as_they_came_each_with_its_verdict(stalls: int) -> None:
    bench = WordBench(DatagramQueue(LONGEST), stalls, seed=stalls)
    sent = datagrams(stalls)
    bench.send("i", sent, [{}] * len(sent))
    got = bench.receive_words("o")
    verdicts = watch(bench)
    bench.count("drop_long")
    bench.run(lambda: len(got) == len(sent))
    for (octets, _), one in zip(got, sent, strict=True):
        assert isinstance(octets, Bad) == isinstance(one, Bad)
        if isinstance(one, Bad):
            assert octets[: len(one)] == one and len(octets) - len(one) < 4  # nobody asks where it ended
        else:
            assert octets == one
    assert [good for good, _ in verdicts] == [not isinstance(one, Bad) for one in sent]
    assert all(good != bad for good, bad in verdicts)
    assert bench.counts["drop_long"] == 0


def test_the_octets_of_the_last_word_that_are_not_of_the_datagram_are_zero() -> None:
    bench = WordBench(DatagramQueue(LONGEST), stalls=0)
    bench.send("i", [b"\xff" * size for size in range(9)], [{}] * 9)
    words: list[int] = []
    got = bench.receive_words("o")

    async def look(ctx: Any) -> None:
        stream = bench.dut.o.stream
        while True:
            _, _, valid, ready, item = await ctx.tick().sample(stream.valid, stream.ready, stream.payload)
            if valid and ready and not item.end:
                words.append(item.data)

    bench.watch(look)
    bench.run(lambda: len(got) == 9)
    expected = [0xFF, 0xFFFF, 0xFFFFFF, 0xFFFFFFFF]
    expected += [0xFFFFFFFF, 0xFF, 0xFFFFFFFF, 0xFFFF, 0xFFFFFFFF, 0xFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF]
    assert words == expected


@pytest.mark.parametrize("longest", [4, 5, 7, 8, 40])
def test_a_datagram_that_is_too_long_ends_badly_and_is_counted_while_nobody_reads(longest: int) -> None:
    """Nothing is taken while it comes, so that it must fit as a whole."""
    room = (longest + 3) // 4 * 4
    sent = [
        bytes(room),
        bytes(room + 4),
        bytes(longest),
        bytes(3 * room),
        Bad(3 * room),
        b"\1",
        bytes(room + 5),
        b"",
    ]
    bench = WordBench(DatagramQueue(longest), stalls=0)
    gate = bench.dut.o.stream
    got: list[tuple[int, bool]] = []

    async def late(ctx: Any) -> None:
        for _ in sent:
            while not ctx.get(bench.dut.known):
                await ctx.tick()
            count = 0
            ctx.set(gate.ready, 1)
            while True:
                _, _, valid, item = await ctx.tick().sample(gate.valid, gate.payload)
                if valid and item.end:
                    got.append((count, bool(item.bad)))
                    break
                count += valid
            ctx.set(gate.ready, 0)

    bench.send("i", sent, [{}] * len(sent))
    bench.drive(late)
    bench.count("drop_long")
    bench.run()
    assert [bad for _, bad in got] == [False, True, False, True, True, False, True, False]
    assert [count for (count, bad) in got if not bad] == [room // 4, (longest + 3) // 4, 1, 0]
    assert max(count for count, _ in got) == room // 4  # nothing of what is behind what did not fit
    assert bench.counts["drop_long"] == 3


def test_a_word_leaves_four_cycles_after_its_last_octet() -> None:
    bench = WordBench(DatagramQueue(LONGEST), stalls=0)
    i, o = bench.dut.i.stream, bench.dut.o.stream
    times: dict[str, int] = {}

    async def process(ctx: Any) -> None:
        ctx.set(o.ready, 1)
        ctx.set(i.valid, 1)
        for cycle in range(12):
            if cycle == 4:
                ctx.set(i.valid, 0)
            _, _, valid, ready, out = await ctx.tick().sample(i.valid, i.ready, o.valid)
            if valid and ready:
                times["in"] = cycle
            if out:
                times.setdefault("out", cycle)

    bench.drive(process)
    bench.run()
    assert times["out"] - times["in"] <= 4


def test_a_queue_for_less_than_a_word_is_refused() -> None:
    with pytest.raises(ValueError, match="4 octets or more, not 3"):
        DatagramQueue(3)
