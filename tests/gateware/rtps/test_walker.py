"""The walk over submessages against a walk by hand: RTPS 2.3, 8.3.4.1 (what is invalid), 8.3.7 (receiver's state), 9.4.5."""

from __future__ import annotations

import random
from typing import Any, NamedTuple

import pytest

from engine.rtps import hand
from gateware.frames import STALLS, Bad
from gateware.words import Tables, WordBench, words
from roslet.gateware.rtps.tables import Local, OwnMap, PeerMap
from roslet.gateware.rtps.walker import Walker

OURS = bytes(range(0x40, 0x4C))
OTHER = bytes(range(0x60, 0x6C))
KNOWN = [hand.PREFIX, bytes(range(0x20, 0x2C)), hand.PREFIX[:11] + b"\xff"]
"""Participants 0 and 1; the third has a slot that is not alive."""
ALIVE = 0b011
REASONS = ("drop_not_rtps", "drop_version", "drop_truncated", "drop_fragment")


class Body(NamedTuple):
    """What the walker gives: `octets` None where the end is bad, and then they do not count."""

    kind: int
    flags: int
    slot: int | None
    octets: bytes | None


def walk(datagram: bytes) -> tuple[list[Body], dict[str, int]]:
    """By hand. Whatever is wrong with the datagram as a whole, bodies that end well have no place in it."""
    counts = dict.fromkeys(REASONS, 0)
    bad = isinstance(datagram, Bad)
    found: list[Body] = []

    def drop(reason: str) -> tuple[list[Body], dict[str, int]]:
        counts[reason] += not bad
        return found, counts

    def sender(prefix: bytes) -> int | None:
        alive = [n for n in range(len(KNOWN)) if ALIVE >> n & 1]
        return next((n for n in alive if KNOWN[n] == prefix), None)

    size = len(datagram)
    if size == 0:
        return drop("drop_truncated")
    if datagram[:4] != b"RTPS":
        return drop("drop_not_rtps")
    if size <= 4:
        return drop("drop_truncated")
    if datagram[4] != 2:
        return drop("drop_version")
    if size <= 16:
        return drop("drop_truncated")
    slot, for_us, at = sender(datagram[8:20]), True, 20
    while at < size:
        header = datagram[at : at + 4] + bytes(3)
        kind, flags = header[0], header[1]
        length = int.from_bytes(header[2:4], "little" if flags & 1 else "big")
        at += 4
        to_end = length == 0 and kind not in (0x01, 0x09)
        end = max(at, size) if to_end else at + length
        body = datagram[at:end]
        if kind in (0x12, 0x13, 0x16):
            counts["drop_fragment"] += for_us
        if kind in (0x06, 0x07, 0x08, 0x15) and for_us:
            whole = not bad and end <= max(size, at)
            found.append(Body(kind, flags, slot, body if whole else None))
        # Of what is not given, a last word of which some octets are there counts as there: nothing follows that is dropped.
        given = kind in (0x06, 0x07, 0x08, 0x15) and for_us
        if end > (size if given else size + -size % 4) and not to_end:
            return drop("drop_truncated")
        if to_end and len(body) <= {0x0E: 8, 0x0C: 16}.get(kind, -1):
            return drop("drop_truncated")
        if kind == 0x0E and len(body) >= 12:
            for_us = body[:12] in (OURS, bytes(12))
        if kind == 0x0C and len(body) >= 20:
            slot = sender(body[8:20])
        at = end
    return found, counts


def bench(stalls: int = 0, seed: int = 0) -> WordBench:
    peers, own = PeerMap(3, 2), OwnMap([], [Local("t", "T")])
    theirs = [0] * peers.depth
    for n, prefix in enumerate(KNOWN):
        at = next(k for k in range(0, peers.depth, 16) if peers._participants == k - 16 * n)
        theirs[at : at + 3] = words(prefix)
    init = own.init(OURS, bytes(4), 0, 0)
    return WordBench(Tables(peers, own, init, theirs=theirs, walker=Walker(peers, own)), stalls, seed)


def run(
    datagrams: list[bytes], stalls: int = 0, cycles: int = 20_000
) -> tuple[list[Body], dict[str, int], list[int]]:
    """What the walker makes of them: bodies, counts, and the slots that were heard."""
    one = bench(stalls, len(datagrams))
    walker = one.dut.walker
    heard: list[int] = []

    async def listen(ctx: Any) -> None:
        ctx.set(walker.alive, ALIVE)
        while True:
            _, _, high, slot = await ctx.tick().sample(walker.heard, walker.heard_slot)
            if high:
                heard.append(slot)

    one.watch(listen)
    one.send_words("walker.i", datagrams, verdict=("walker.known", "walker.good"))
    got = one.receive_words("walker.o")
    one.count(*(f"walker.{name}" for name in REASONS))
    one.run(cycles=cycles, rest=100)
    counts = {name.removeprefix("walker."): count for name, count in one.counts.items()}
    return (
        [
            Body(
                meta.id,
                meta.flags,
                meta.slot if meta.known else None,
                None if isinstance(octets, Bad) else octets,
            )
            for octets, meta in got
        ],
        counts,
        heard,
    )


def check(datagrams: list[bytes], stalls: int = 0) -> dict[str, int]:
    """The walker makes of them what the walk by hand does. The counts."""
    expected: list[Body] = []
    counts = dict.fromkeys(REASONS, 0)
    for datagram in datagrams:
        bodies, more = walk(datagram)
        expected += bodies
        counts = {name: counts[name] + more[name] for name in counts}
    got, counted, heard = run(datagrams, stalls)
    assert got == expected
    assert counted == counts
    assert heard == [body.slot for body in expected if body.octets is not None and body.slot is not None]
    return counts


BEAT = hand.heartbeat(hand.WRITER, 1, 2, 3)
ODD = bytes(range(200, 233))


def data(e: str = "<", **more: Any) -> bytes:
    return hand.data(hand.WRITER, 5, ODD + bytes(3), e=e, **more)


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("e", "<>")
def test_bodies_of_both_endiannesses_are_given_with_what_their_header_says(e: str, stalls: int) -> None:
    message = hand.message(
        data(e),
        hand.heartbeat(hand.WRITER, 1, 2, 3, e=e, flags=2),
        hand.info_ts(5, e),
        hand.gap(hand.WRITER, 1, hand.number_set(2, 0, (), e), e),
        hand.acknack(hand.READER, hand.WRITER, hand.number_set(2, 32, (5,), e), 1, e),
    )
    got, _, _ = run([message], stalls)
    assert [body.kind for body in got] == [0x15, 0x07, 0x08, 0x06]
    assert [body.flags for body in got] == [flag | (e == "<") for flag in (4, 2, 0, 2)]
    assert got[0].octets == data(e)[4:]
    check([message] * 3, stalls)


def test_a_length_of_zero_goes_to_the_end_of_the_message_but_for_pad_and_info_ts() -> None:
    to_end = hand.submessage(0x15, 4, data()[4:] + ODD, length=0)
    pad = hand.submessage(0x01, 0, b"")
    for size in range(4):
        got, counts, _ = run([hand.message(pad, hand.INFO_TS_INVALID, BEAT, to_end + bytes(size))])
        assert [body.kind for body in got] == [0x07, 0x15]
        assert got[1].octets == to_end[4:] + bytes(size)
        assert not any(counts.values())
    # An unknown kind to the end, and INFO_DST and INFO_SRC, which say it with their length.
    check([hand.message(hand.submessage(0x80, 0, bytes(9), length=0))])
    check([hand.message(hand.submessage(0x0E, 0, OURS, length=0)), hand.message(BEAT)])
    check([hand.message(hand.submessage(0x0C, 0, bytes(8) + KNOWN[1], length=0)), hand.message(BEAT)])


def test_unknown_submessages_are_skipped_by_their_length() -> None:
    kinds = [
        kind for kind in range(0, 256, 5) if kind not in (6, 7, 8, 9, 1, 0xC, 0xE, 0x12, 0x13, 0x15, 0x16)
    ]
    check([hand.message(hand.submessage(kind, 0, bytes(4 * (kind % 4) + 4)), BEAT) for kind in kinds])


def test_info_dst_to_us_or_to_everybody_lets_pass_and_to_others_does_not() -> None:
    near = [OURS[:n] + bytes([OURS[n] ^ 1]) + OURS[n + 1 :] for n in range(12)]
    near += [bytes(n) + b"\1" + bytes(11 - n) for n in range(12)]
    messages = [hand.message(hand.info_dst(prefix), BEAT) for prefix in (OURS, bytes(12), OTHER, *near)]
    got, _, _ = run(messages)
    assert len(got) == 2
    check(messages)
    # Each INFO_DST counts from there on; the next message is for all again.
    check([hand.message(hand.info_dst(OTHER), BEAT, hand.info_dst(OURS), data(), hand.info_dst(OTHER), BEAT)])
    check([hand.message(hand.info_dst(OTHER), BEAT), hand.message(data())])
    # More than its prefix, in a later version; and less, which says nothing.
    check(
        [
            hand.message(
                hand.submessage(0x0E, 0, OTHER + bytes(4)), BEAT, hand.submessage(0x0E, 0, OURS[:8]), BEAT
            )
        ]
    )


def test_info_src_says_who_speaks_from_there_on() -> None:
    got, _, heard = run(
        [hand.message(BEAT, hand.info_src(KNOWN[1]), BEAT, hand.info_src(OTHER), BEAT), hand.message(BEAT)]
    )
    assert [body.slot for body in got] == [0, 1, None, 0]
    assert heard == [0, 1, 0]
    check([hand.message(hand.submessage(0x0C, 0, bytes(8) + KNOWN[1] + bytes(8)), BEAT)])
    check([hand.message(hand.submessage(0x0C, 0, bytes(8) + KNOWN[1][:8]), BEAT)])
    check([hand.message(hand.info_src(KNOWN[1]), hand.info_dst(OTHER), BEAT, hand.info_src(KNOWN[0]), BEAT)])


def test_a_participant_is_known_by_all_twelve_octets_while_it_is_alive() -> None:
    near = [KNOWN[1][:n] + bytes([KNOWN[1][n] ^ 0x80]) + KNOWN[1][n + 1 :] for n in range(12)]
    mixed = [KNOWN[0][:4] + KNOWN[1][4:], KNOWN[1][:8] + KNOWN[0][8:]]
    got, _, _ = run([hand.message(BEAT, prefix=prefix) for prefix in (*KNOWN, *near, *mixed)])
    assert [body.slot for body in got] == [0, 1] + [None] * 15


def test_the_senders_prefix_is_written_into_the_scratch_area() -> None:
    one = bench()
    seen: list[list[int]] = []
    dut = one.dut

    async def process(ctx: Any) -> None:
        ctx.set(dut.walker.o.stream.ready, 1)
        for prefix in (OTHER, KNOWN[1]):
            while not (ctx.get(dut.walker.o.stream.valid) and ctx.get(dut.walker.o.stream.payload.end)):
                await ctx.tick()
            memory = dut.peek(ctx)
            seen.append(memory)
            assert words(prefix) == memory[dut.scratch + 9 : dut.scratch + 12]
            await ctx.tick()

    dut.scratch = PeerMap(3, 2)._scratch
    one.drive(process)
    one.send_words("walker.i", [hand.message(BEAT, prefix=OTHER), hand.message(BEAT, prefix=KNOWN[1])],
                   verdict=("walker.known", "walker.good"))  # fmt: skip
    one.run()
    assert len(seen) == 2


def test_a_message_cut_at_every_octet_gives_what_is_before_the_cut_and_is_counted() -> None:
    message = hand.message(
        hand.info_dst(OURS),
        BEAT,
        hand.info_ts(1),
        hand.info_src(KNOWN[1]),
        hand.acknack(hand.READER, hand.WRITER, b"", 1, ">"),
    )
    counts = check([message[:cut] for cut in range(len(message) + 1)], 20)
    assert counts["drop_truncated"] > 80


def test_no_body_of_a_datagram_that_ends_badly_anywhere_ends_well() -> None:
    message = hand.message(BEAT, hand.info_dst(OURS), hand.submessage(0x15, 4, data()[4:], length=0))
    cuts = range(len(message) + 1)
    got, counts, heard = run([Bad(message[:cut]) for cut in cuts] + [hand.message(BEAT)])
    assert [body for body in got if body.octets is not None] == [Body(7, 1, 0, BEAT[4:])]
    assert heard == [0]
    assert not any(counts.values())


@pytest.mark.parametrize("kind", [0x07, 0x0C, 0x0E, 0x80])
def test_a_length_beyond_the_message_ends_it(kind: int) -> None:
    """What lies in it may look like submessages, and is none; also where the length rounded up has 17 bits."""
    messages = []
    for length in (33, 36, 0x7FFC, 0xFFFC, 0xFFFD, 0xFFFF):
        messages += [hand.message(BEAT, hand.submessage(kind, 0, BEAT[4:], length=length))]
        messages += [hand.message(BEAT, hand.submessage(kind, 0, BEAT, length=length))]
    assert check(messages)["drop_truncated"] == len(messages)


def test_fragments_are_counted_if_they_are_for_us() -> None:
    frag = hand.data_frag(hand.WRITER, 1, 1, 1, 8, 16, bytes(8))
    message = hand.message(
        frag, hand.info_dst(OTHER), frag, hand.info_dst(OURS), hand.submessage(0x13, 0, bytes(28)), BEAT
    )
    counts = check([message])
    assert counts["drop_fragment"] == 2


def test_what_is_not_rtps_or_of_another_version_is_dropped_and_counted() -> None:
    wrong = [b"RTPX" + hand.message(BEAT)[4:], b"\0" * 60, b"R", b"RTP", b"RTPS\1\0" + hand.message(BEAT)[6:]]
    wrong += [
        b"RTPS\3\0" + hand.message(BEAT)[6:],
        b"RTPS\2\xff" + hand.message(BEAT)[6:],
        hand.message(BEAT),
    ]
    counts = check(wrong, 30)
    assert (counts["drop_not_rtps"], counts["drop_version"]) == (4, 2)
    assert not any(check([Bad(one) for one in wrong]).values())


def test_a_message_waits_while_it_is_held() -> None:
    one = bench()
    walker = one.dut.walker
    log: list[tuple[int, int]] = []

    async def process(ctx: Any) -> None:
        ctx.set(walker.hold, 1)
        for _ in range(50):
            _, _, idle, ready = await ctx.tick().sample(walker.idle, walker.i.stream.ready)
            log.append((idle, ready))
        ctx.set(walker.hold, 0)

    one.drive(process)
    one.send_words("walker.i", [hand.message(BEAT)], verdict=("walker.known", "walker.good"))
    got = one.receive_words("walker.o")
    one.run(lambda: len(got) == 1)
    assert log == [(1, 0)] * 50


@pytest.mark.parametrize("seed", range(2))
def test_random_messages_are_walked_as_by_hand(seed: int) -> None:
    random_ = random.Random(seed)
    datagrams: list[bytes] = []
    for _ in range(50):
        parts = []
        for _ in range(random_.randrange(6)):
            e = random_.choice("<>")
            kind = random_.choice([6, 7, 8, 9, 0x15, 0x15, 1, 0xC, 0xE, 0x16, 0x80, random_.randrange(256)])
            size = 4 * random_.randrange(10)
            body = random_.choice([OURS, OTHER, bytes(8) + KNOWN[1], bytes(12), b""]) + random_.randbytes(
                size
            )
            length = random_.choice([None] * 8 + [0, 4 * random_.randrange(12), random_.randrange(65536)])
            parts.append(hand.submessage(kind, random_.randrange(128) * 2, body, e, length))
        datagram = hand.message(*parts, prefix=random_.choice([*KNOWN, OTHER]))
        if random_.randrange(4) == 0:
            datagram = datagram[: random_.randrange(len(datagram) + 1)]
        if random_.randrange(8) == 0:
            datagram = Bad(datagram)
        # Lengths of no whole words are of the last submessage alone (9.4.5.1.3): what follows is at whole words.
        if all(length % 4 == 0 for length in lengths(datagram)):
            datagrams.append(datagram)
    assert len(datagrams) > 20
    check(datagrams, random_.choice(STALLS))


def lengths(datagram: bytes) -> list[int]:
    """Of the submessages that the walk meets, but for one that goes beyond the end."""
    found, at = [], 20
    while at + 4 <= len(datagram):
        length = int.from_bytes(datagram[at + 2 : at + 4], "little" if datagram[at + 1] & 1 else "big")
        if (length == 0 and datagram[at] not in (1, 9)) or at + 4 + length > len(datagram):
            break
        found.append(length)
        at += 4 + length
    return found
