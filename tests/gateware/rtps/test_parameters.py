"""Parameter lists, word by word. RTPS 2.3, 9.4.2.11 (octets), 9.6.2.2 (meaning)."""

from __future__ import annotations

import struct
import types
from collections.abc import Awaitable, Callable
from typing import Any, NamedTuple

import pytest

from engine.rtps import hand
from gateware.frames import STALLS, Bad
from gateware.rtps.discovering import IP, MASK, address, prefix
from gateware.words import Tables, WordBench, words
from roslet.gateware.rtps import ports
from roslet.gateware.rtps.parameters import READ, Parameters
from roslet.gateware.rtps.tables import Local, OwnMap, PeerMap

PARTICIPANT, PUBLICATION, SUBSCRIPTION = ports.PARTICIPANTS, ports.PUBLICATIONS, ports.SUBSCRIPTIONS
READERS = [Local("rt/abc", "pkg::T_"), Local("rt/abcd", "pkg::T_"), Local("rt/abc", "pkg::U_")]
"""Topics of 6 and 7 octets: with their NUL, one, and none, is missing to whole words."""
WRITERS = [Local("w", "x")]
SENDER = prefix(3)


class Heard(NamedTuple):
    """`read` and `same` when `done`, and the scratch area; or that it was malformed, or neither."""

    read: Any
    same: int
    scratch: list[int]
    malformed: int


class Reader:
    def __init__(self, stalls: int = 0) -> None:
        self.peers, own = PeerMap(1, 1), OwnMap(WRITERS, READERS)
        self.block: Any = Parameters(self.peers, own)
        init = own.init(bytes(12), bytes(4), 0, 0)
        self.bench = WordBench(Tables(self.peers, own, init, block=self.block), stalls, seed=stalls)
        self._malformed = 0
        self.bench.watch(self._watch)
        self.ctx: Any = None

    async def _watch(self, ctx: Any) -> None:
        while True:
            _, _, high = await ctx.tick().sample(self.block.drop_malformed)
            self._malformed += high

    def run(self, script: Callable[[Reader], Awaitable[None]], cycles: int = 100_000) -> None:
        async def process(ctx: Any) -> None:
            self.ctx = ctx
            ctx.set(self.block.domain, 0)
            addresses = {"mac": 0, "ip": address(IP), "gateway": 0, "mask": address(MASK)}
            ctx.set(self.block.addresses, addresses)
            for n, word in enumerate(words(SENDER)):
                ctx.set(self.bench.dut.peers_memory.data[self.peers._scratch + 9 + n], word)
            await ctx.tick()
            await script(self)

        self.bench.drive(process)
        self.bench.run(cycles=cycles)

    def _read(self) -> types.SimpleNamespace:
        read = self.ctx.get(self.block.read)
        return types.SimpleNamespace(**{name: read[name] for name, _ in READ})

    async def hear(self, octets: bytes, kind: int = PUBLICATION) -> Heard:
        ctx, i, random = self.ctx, self.block.i, self.bench.random
        before = self._malformed
        ctx.set(i.meta, {"kind": kind, "known": 1, "slot": 0, "gone": 0, "has_key": 0})
        bad = isinstance(octets, Bad)
        items = [{"data": word, "end": 0, "bad": 0, "padding": 0} for word in words(octets)]
        items.append({"data": 0, "end": 1, "bad": bad, "padding": 0 if bad else -len(octets) % 4})
        heard: Any = None
        for item in items:
            while random.randrange(100) < self.bench.stalls:
                await ctx.tick()
            ctx.set(i.stream.payload, item)
            ctx.set(i.stream.valid, 1)
            while True:
                if item["end"] and heard is None and ctx.get(self.block.done):
                    memory = self.bench.dut.peek(ctx)[self.peers._scratch :]
                    heard = self._read(), ctx.get(self.block.same), memory[:16]
                    await ctx.tick().repeat(random.randrange(1, 4))
                    assert ctx.get(self.block.done) and not ctx.get(i.stream.ready)
                    assert (self._read(), ctx.get(self.block.same)) == heard[:2]
                    ctx.set(self.block.proceed, 1)
                _, _, ready = await ctx.tick().sample(i.stream.ready)
                if ready:
                    break
            ctx.set(self.block.proceed, 0)
            ctx.set(i.stream.valid, 0)
        await ctx.tick()
        read, same, scratch = heard or (None, 0, [])
        return Heard(read, same, scratch, self._malformed - before)


NEITHER = Heard(None, 0, [], 0)
MALFORMED = Heard(None, 0, [], 1)
TOPIC, TYPE = hand.parameter(5, hand.text("rt/abc")), hand.parameter(7, hand.text("pkg::T_"))


def text(length: int, octets: bytes, e: str = "<") -> bytes:
    return struct.pack(e + "I", length) + octets


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("e", "<>")
def test_a_topic_and_a_type_that_are_ours_are_known(e: str, stalls: int) -> None:
    async def script(r: Reader) -> None:
        for topic, type_name, same in (
            ("rt/abc", "pkg::T_", 0b001),
            ("rt/abcd", "pkg::T_", 0b010),
            ("rt/abc", "pkg::U_", 0b100),
            ("rt/abcd", "pkg::U_", 0),
            ("w", "x", 0),
        ):
            said = [hand.parameter(5, hand.text(topic, e), e), hand.parameter(7, hand.text(type_name, e), e)]
            for order in (said, said[::-1]):
                heard = await r.hear(hand.payload(*order, e=e))
                assert heard.same & 0b111 == same, (topic, type_name)
                assert (heard.read.topic, heard.read.type, heard.malformed) == (1, 1, 0)
        texts = hand.parameter(5, hand.text("w", e), e), hand.parameter(7, hand.text("x", e), e)
        heard = await r.hear(hand.payload(*texts, e=e), SUBSCRIPTION)
        assert heard.same & 1 == 1

    Reader(stalls).run(script)


def test_texts_that_differ_anywhere_are_not_ours() -> None:
    ours = b"rt/abc\0"
    others = [ours[:n] + bytes([ours[n] ^ bit]) + ours[n + 1 :] for n in range(7) for bit in (1, 0x80)]
    wrong = [text(7, other + b"\0") for other in others]
    wrong += [
        text(6, b"rt/abc\0\0"),  # without its NUL
        text(6, b"rt/ab\0\0\0"),  # a prefix of ours
        text(8, b"rt/abc\0\0"),  # longer by a NUL
        text(8, b"rt/abcx\0"),
        text(9, b"rt/abc\0\0\0\0\0\0"),
        text(11, b"rt/abc\0\0\0\0\0\0"),
        text(3, b"rt\0\0"),
        text(1, b"\0\0\0\0"),
        text(200, ours + bytes(193)),
    ]
    right = [text(7, b"rt/abc\0\0"), text(7, b"rt/abc\0\xff"), text(7, b"rt/abc\0\0" + b"rest" * 3)]

    async def script(r: Reader) -> None:
        for one in wrong:
            heard = await r.hear(hand.payload(hand.parameter(5, one), TYPE))
            assert heard.same & 0b101 == 0 and not heard.malformed, one
        for one in right:
            assert (await r.hear(hand.payload(hand.parameter(5, one), TYPE))).same & 0b111 == 0b001, one
        # Of the seven octets of the other one: no octet is left to fill the word up.
        for one, same in (
            (text(8, b"rt/abcd\0"), 2),
            (text(8, b"rt/abce\0"), 0),
            (text(8, b"rt/abcd\1"), 0),
            (text(7, b"rt/abcd\0"), 0),
        ):
            assert (await r.hear(hand.payload(hand.parameter(5, one), TYPE))).same & 0b111 == same, one

    Reader().run(script)


def test_a_text_longer_than_its_parameter_or_of_none_is_malformed() -> None:
    async def script(r: Reader) -> None:
        for length in (0, 9, 10, 0xFFFF, 0xFFFD, 0x10007, 0xFFFFFFFF, 0x7FFFFFFF):
            heard = await r.hear(hand.payload(hand.parameter(5, text(length, b"rt/abc\0\0")), TYPE))
            assert heard == MALFORMED, length
        assert await r.hear(hand.payload(hand.parameter(5, struct.pack("<I", 1)), TYPE)) == MALFORMED
        heard = await r.hear(hand.payload(hand.parameter(5, b""), TYPE))  # nothing was said
        assert (heard.read.topic, heard.malformed) == (0, 0)
        assert (await r.hear(hand.payload(TOPIC, TYPE))).same & 0b111 == 1

    Reader().run(script)


def locator(host: str = "10.0.0.5", port: int = 7411, kind: int = 1, e: str = "<") -> bytes:
    return struct.pack(e + "II", kind, port) + bytes(12) + bytes(int(part) for part in host.split("."))


FAR, NEAR, NEAR2 = "192.168.7.7", "10.0.0.5", "10.0.0.6"


@pytest.mark.parametrize("e", "<>")
@pytest.mark.parametrize(
    ("kind", "pid", "at", "flag"),
    [
        (PARTICIPANT, 0x32, 4, "meta"),
        (PARTICIPANT, 0x31, 6, "user"),
        (PUBLICATION, 0x2F, 6, "user"),
        (SUBSCRIPTION, 0x2F, 6, "user"),
    ],
)
def test_of_locators_the_first_in_our_subnet_is_taken_else_the_first(
    kind: int, pid: int, at: int, flag: str, e: str
) -> None:
    cases: list[tuple[list[bytes], tuple[str, int] | None]] = [
        ([locator(NEAR, e=e)], (NEAR, 7411)),
        ([locator(FAR, 9, e=e)], (FAR, 9)),
        ([locator(FAR, 9, e=e), locator(NEAR, 10, e=e)], (NEAR, 10)),
        ([locator(NEAR, 10, e=e), locator(FAR, 9, e=e)], (NEAR, 10)),
        ([locator(NEAR, 10, e=e), locator(NEAR2, 9, e=e)], (NEAR, 10)),
        ([locator(FAR, 10, e=e), locator("1.2.3.4", 9, e=e)], (FAR, 10)),
        (
            [locator(FAR, 1, e=e), locator(NEAR, 2, e=e), locator(NEAR2, 3, e=e), locator(FAR, 4, e=e)],
            (NEAR, 2),
        ),
        ([locator("127.0.0.1", e=e)], None),
        ([locator("127.0.0.1", e=e), locator(FAR, 8, e=e)], (FAR, 8)),
        ([locator("0.0.0.0", e=e)], None),
        ([locator(NEAR, 0, e=e)], None),
        ([locator(NEAR, 65536, e=e)], None),
        ([locator(NEAR, 65535, e=e)], (NEAR, 65535)),
        *[([locator(NEAR, kind=other, e=e)], None) for other in (2, 0, 16, 0x01000000, 0xFFFFFFFF, 0x10001)],
        ([locator(NEAR, kind=2, e=e), locator(FAR, 8, e=e)], (FAR, 8)),
        ([locator(NEAR, 8, e=e)[:20]], None),  # no whole one
    ]

    async def script(r: Reader) -> None:
        for found, expected in cases:
            heard = await r.hear(hand.payload(*(hand.parameter(pid, one, e) for one in found), e=e), kind)
            assert heard.malformed == 0 and getattr(heard.read, flag) == (expected is not None), found
            if expected:
                assert heard.scratch[at : at + 2] == [address(expected[0]), expected[1]], found

    Reader().run(script)


@pytest.mark.parametrize("e", "<>")
def test_what_is_said_is_read_and_what_is_not_has_its_default(e: str) -> None:
    async def script(r: Reader) -> None:
        heard = await r.hear(hand.payload(e=e), PARTICIPANT)
        assert (heard.read.guid, heard.read.meta, heard.scratch[3], heard.read.refused) == (0, 0, 100, 0)
        said = hand.payload(
            hand.parameter(0x50, SENDER + hand.PARTICIPANT, e),
            hand.parameter(2, struct.pack(e + "iI", 7, 1 << 31), e),
            e=e,
        )
        heard = await r.hear(said, PARTICIPANT)
        assert (heard.read.guid, heard.scratch[3]) == (1, 7)
        assert heard.scratch[:3] == words(SENDER)
        for kind, reliable in ((PUBLICATION, 1), (SUBSCRIPTION, 0)):
            heard = await r.hear(hand.payload(e=e), kind)
            assert (heard.read.reliable, heard.read.durability, heard.read.topic) == (reliable, 0, 0)
            for value in (1, 2):
                heard = await r.hear(
                    hand.payload(hand.parameter(0x1A, struct.pack(e + "IiI", value, 0, 0), e), e=e), kind
                )
                assert heard.read.reliable == value - 1
            for value in range(4):
                heard = await r.hear(
                    hand.payload(hand.parameter(0x1D, struct.pack(e + "I", value), e), e=e), kind
                )
                assert heard.read.durability == value
        heard = await r.hear(hand.payload(hand.parameter(0x5A, SENDER + hand.WRITER, e), e=e))
        assert (heard.read.guid, heard.scratch[15]) == (1, words(hand.WRITER)[0])
        # A list without a word about what is gone.
        assert (await r.hear(b"")).read.guid == 0

    Reader(20).run(script)


def test_parameters_of_the_other_kind_say_nothing() -> None:
    async def script(r: Reader) -> None:
        heard = await r.hear(
            hand.payload(hand.parameter(0x50, SENDER + hand.PARTICIPANT), hand.parameter(0x32, locator()))
        )
        assert (heard.read.guid, heard.read.meta, heard.read.user) == (0, 0, 0)
        heard = await r.hear(
            hand.payload(hand.parameter(0x5A, SENDER + hand.WRITER), TOPIC, TYPE), PARTICIPANT
        )
        assert (heard.read.guid, heard.read.topic, heard.read.type) == (0, 0, 0)

    Reader().run(script)


def test_what_is_no_parameter_list_is_malformed() -> None:
    good = hand.payload(TOPIC, TYPE)
    cases = [
        bytes([a, b]) + good[2:]
        for a, b in ((0, 0), (0, 1), (0, 4), (0, 6), (0, 10), (1, 3), (0x80, 2), (0, 0x13))
    ]
    cases += [
        hand.payload(struct.pack("<HH", 0x2C, length) + bytes(4)) for length in (1, 2, 3, 5, 0x7FFF, 0xFFFF)
    ]
    cases += [good[:cut] for cut in range(4, len(good) - 3, 4)]  # no sentinel, or cut in a value
    cases += [
        hand.payload(struct.pack("<HH", 0x8000, 0xFFFC)),
        good[:-4] + struct.pack("<HH", 5, 64) + bytes(60),
    ]
    wrong = [SENDER[:n] + bytes([SENDER[n] ^ 4]) + SENDER[n + 1 :] for n in range(12)]
    cases += [hand.payload(hand.parameter(0x5A, one + hand.WRITER)) for one in wrong]

    async def script(r: Reader) -> None:
        for one in cases:
            assert await r.hear(one) == MALFORMED, one.hex()
            assert await r.hear(Bad(one)) == NEITHER, one.hex()
        assert (await r.hear(good)).same & 0b111 == 1

    Reader(20).run(script)


def test_after_the_sentinel_nothing_is_read() -> None:
    async def script(r: Reader) -> None:
        for sentinel in (b"\1\0\0\0", b"\1\0\x08\0"):
            heard = await r.hear(
                b"\0\3\0\0" + TOPIC + TYPE + sentinel + hand.parameter(5, hand.text("rt/abcd")) + b"\xff" * 8
            )
            assert heard.same & 0b111 == 1 and not heard.malformed

    Reader().run(script)


def test_a_list_cut_at_every_octet_is_done_or_malformed_and_the_next_is_read() -> None:
    good = hand.payload(
        hand.parameter(0x5A, SENDER + hand.WRITER), hand.parameter(0x2F, locator()), TOPIC, TYPE
    )

    async def script(r: Reader) -> None:
        for cut in range(1, len(good) + 1):
            heard = await r.hear(good[:cut])
            # With the sentinel's id the list is whole; the octets missing in a word are zeros.
            assert (heard == MALFORMED) == (cut <= len(good) - 4), cut
            assert await r.hear(Bad(good[:cut])) == NEITHER
        assert (await r.hear(good)).same & 0b111 == 1

    Reader(10).run(script)


def test_a_text_said_twice_must_be_ours_twice() -> None:
    async def script(r: Reader) -> None:
        twice = hand.payload(TOPIC, TYPE, hand.parameter(5, hand.text("rt/abcd")))
        assert (await r.hear(twice)).same & 0b111 == 0
        assert (await r.hear(hand.payload(TOPIC, TOPIC, TYPE))).same & 0b111 == 1

    Reader().run(script)
