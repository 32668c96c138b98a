"""What DATA, HEARTBEAT, GAP and ACKNACK do. RTPS 2.3, 8.3.7 (which are invalid), 8.4.12 (what a reader keeps), 9.4.5
(octets)."""

from __future__ import annotations

import struct
from typing import Any

import pytest

from engine.rtps import hand
from gateware.frames import STALLS, Bad
from gateware.rtps.receiving import ACKED, ASK_FROM, ASK_TO, DROPS, LAST, NEXT_LO, Came, Receiver, whole
from roslet.errors import ProtocolError
from roslet.wire.rtps import message as codec

W = hand.WRITER
CDR_LE, CDR_BE = 0x0001, 0x0000
TEXT = bytes(range(1, 13))
USER0 = 8
"""The first user proxy: behind four builtin ones of each of two participants."""
NOTHING = Came([], [], [], [], False)


def dropped(reason: str) -> Came:
    return NOTHING._replace(drops=[reason])


def data(
    sequence: int, writer: bytes = W, text: bytes = TEXT, e: str = "<", options: int = 0, **more: Any
) -> bytes:
    kind = CDR_LE if e == "<" else CDR_BE
    return hand.data(writer, sequence, struct.pack(">HH", kind, options) + text, e=e, **more)


@pytest.mark.parametrize("stalls", STALLS)
@pytest.mark.parametrize("e", "<>")
def test_data_goes_to_the_reader_that_matches_with_its_representation(e: str, stalls: int) -> None:
    async def script(r: Receiver) -> None:
        r.writer(1, W, wanted=5, slot=1, local=1)
        came = await r.say(data(5, e=e), slot=1)
        assert came.user == [(TEXT, 1, CDR_LE if e == "<" else CDR_BE)]
        assert (came.drops, came.due, came.discovery) == ([], [], [])
        assert r.wanted(1) == 6
        # By its own id, the second reader's; and by another's.
        assert whole(await r.say(data(6, e=e, reader=b"\0\0\2\4"), slot=1))
        assert await r.say(data(7, e=e, reader=b"\0\0\1\4"), slot=1) == dropped("unmatched")
        assert r.wanted(1) == 7

    Receiver(stalls).run(script)


def test_padding_is_what_the_options_say_or_what_the_datagram_lacks() -> None:
    async def script(r: Receiver) -> None:
        r.writer(0, W, reliable=False)
        for sequence in range(1, 4):
            came = await r.say(data(sequence, options=sequence))
            assert came.user == [(TEXT[: len(TEXT) - sequence], 0, CDR_LE)]
        for missing in range(1, 4):
            came = await r.say(data(10 + missing, text=TEXT[:-missing], length=0))
            assert came.user == [(TEXT[:-missing], 0, CDR_LE)]
        assert (await r.say(data(20, options=0xFFFC))).user == [(TEXT, 0, CDR_LE)]
        assert (await r.say(data(21, text=b""))).user == [(b"", 0, CDR_LE)]

    Receiver(30).run(script)


def test_a_reliable_writers_numbers_are_taken_one_after_another() -> None:
    async def script(r: Receiver) -> None:
        r.writer(0, W, wanted=0)
        assert whole(await r.say(data(40)))  # the first of all, whatever its number
        assert r.wanted(0) == 41
        for sequence in (40, 39, 1):
            assert await r.say(data(sequence)) == dropped("old")
        early = await r.say(data(42))
        assert early == dropped("early")._replace(due=[USER0])
        assert whole(await r.say(data(41))) and whole(await r.say(data(42)))
        assert r.wanted(0) == 43

    Receiver().run(script)


def test_of_a_writer_that_does_not_repeat_later_numbers_are_taken() -> None:
    async def script(r: Receiver) -> None:
        r.writer(0, W, reliable=False)
        for sequence in (7, 9, 100):
            assert whole(await r.say(data(sequence)))
            assert r.wanted(0) == sequence + 1
        for sequence in (100, 99, 8, 1):
            assert await r.say(data(sequence)) == dropped("old")

    Receiver().run(script)


@pytest.mark.parametrize("e", "<>")
def test_numbers_go_on_beyond_8_16_and_32_bits(e: str) -> None:
    async def script(r: Receiver) -> None:
        for edge in (1 << 8, 1 << 16, 1 << 31, 1 << 32, 1 << 40, hand.LAST - 2):
            r.writer(0, W, wanted=edge - 1)
            assert await r.say(data(edge, e=e)) == dropped("early")._replace(due=[USER0])
            for sequence in (edge - 1, edge, edge + 1):
                assert whole(await r.say(data(sequence, e=e)))
                assert await r.say(data(sequence, e=e)) == dropped("old")
            assert r.wanted(0) == edge + 2
            # Numbers that agree in their lower half only.
            assert (await r.say(data((edge + 2) ^ 1 << 33, e=e))).drops in (["old"], ["early"])

    Receiver().run(script)


def test_what_lies_before_inline_qos_and_inline_qos_itself_are_skipped() -> None:
    qos = [
        hand.parameters(hand.parameter(0x83, bytes(24))),
        hand.parameters(hand.parameter(0x70, bytes(16)), hand.parameter(0x71, bytes(4))),
        hand.parameters(
            hand.parameter(0x8000, b""), hand.parameter(0, bytes(8)), hand.parameter(0x5, b"\5\0\0\0text\0")
        ),
        hand.parameters(),
    ]

    async def script(r: Receiver) -> None:
        r.writer(0, W)
        sequence = 0
        for skipped in range(0, 20, 4):
            for one in (b"", *qos):
                sequence += 1
                came = await r.say(data(sequence, qos=one, skipped=b"\xee" * skipped))
                assert came.user == [(TEXT, 0, CDR_LE)] and came.drops == []
        big = hand.parameters(hand.parameter(0x83, bytes(24), ">"), e=">")
        assert (await r.say(data(sequence + 1, qos=big, e=">"))).user == [(TEXT, 0, CDR_BE)]

    Receiver(30).run(script)


def test_a_message_that_is_disposed_of_tells_nothing_and_counts() -> None:
    async def script(r: Receiver) -> None:
        r.writer(0, W, wanted=3)
        gone = hand.parameters(hand.parameter(0x71, b"\0\0\0\3"))
        came = await r.say(data(3, qos=gone, flags=8))
        assert came == NOTHING._replace(changed=True) and r.wanted(0) == 4
        assert await r.say(hand.data(W, 4, b"", flags=0)) == NOTHING._replace(changed=True)
        assert r.wanted(0) == 5

    Receiver().run(script)


def test_what_matches_no_reader_of_ours_is_dropped() -> None:
    async def script(r: Receiver) -> None:
        r.writer(0, W, wanted=1, slot=0)
        r.reader(1, hand.READER)
        cases = [
            await r.say(data(1, writer=b"\0\0\x12\3")),
            await r.say(data(1), slot=1),
            await r.say(data(1), slot=None),
            await r.say(data(1, writer=hand.READER)),
            await r.say(hand.heartbeat(b"\0\0\x12\3", 1, 2, 1)),
            await r.say(hand.heartbeat(W, 1, 2, 1), slot=None),
            await r.say(hand.heartbeat(hand.READER, 1, 2, 1)),
            await r.say(hand.gap(W, 1, hand.number_set(5, 0, ())), slot=1),
            await r.say(hand.acknack(W, hand.READER, hand.number_set(1, 0, ()), 1)),
            await r.say(hand.acknack(hand.READER, W, hand.number_set(1, 0, ()), 1), slot=1),
            await r.say(hand.acknack(hand.READER, W, hand.number_set(1, 0, ()), 1), slot=None),
        ]
        assert cases == [dropped("unmatched")] * len(cases)
        r.ctx.set(r.block.matched, 0b110)
        assert await r.say(data(1)) == dropped("unmatched")

    Receiver().run(script)


def test_where_there_is_no_room_a_message_is_dropped_and_still_wanted() -> None:
    async def script(r: Receiver) -> None:
        r.writer(0, W, wanted=1, local=1)
        r.ctx.set(r.block.room, 0b01)
        assert await r.say(data(1)) == dropped("busy")
        r.ctx.set(r.block.room, 0b10)
        assert whole(await r.say(data(1)))

    Receiver().run(script)


INVALID = [
    data(0),
    data(-1),
    data(-(1 << 63)),
    data(1, to_qos=12),
    data(1, to_qos=0),
    data(1, to_qos=18),
    data(1, flags=12),
    hand.data(W, 1, b""),
    data(1, qos=b"\x83\0\xfd\xff" + hand.parameters()),  # goes beyond the end, also where it is rounded up
    hand.heartbeat(W, 0, 5, 1),
    hand.heartbeat(W, -1, 5, 1),
    hand.heartbeat(W, 7, -1, 1),
    hand.heartbeat(W, 7, -(1 << 63), 1),
    hand.gap(W, 0, hand.number_set(5, 0, ())),
    hand.gap(W, -4, hand.number_set(5, 0, ())),
    hand.gap(W, 1, hand.number_set(-1, 0, ())),
    hand.gap(W, 1, hand.number_set(-(1 << 40), 32, (1,))),
    hand.gap(W, 1, hand.number_set(5, 257, (0,) * 9)),
    hand.gap(W, 1, hand.number_set(5, 0xFFFFFFFF, ())),
    hand.acknack(hand.READER, W, hand.number_set(5, 257, (0,) * 9), 1),
    hand.acknack(hand.READER, W, hand.number_set(5, 0x80000001, ()), 1),
    hand.acknack(hand.READER, W, hand.number_set(-1, 0, ()), 1),
]


@pytest.mark.parametrize("wanted", [0, 1])
def test_what_rtps_calls_invalid_is_dropped_and_changes_nothing(wanted: int) -> None:
    async def script(r: Receiver) -> None:
        r.writer(0, W, wanted=wanted)
        r.reader(1, hand.READER)
        for one in INVALID:
            assert await r.say(one) == dropped("invalid"), one.hex()
            assert (await r.say(one, bad=True)).drops == []

    Receiver().run(script)


BODIES = {
    "data": data(5, qos=hand.parameters(hand.parameter(0x71, bytes(4))), skipped=bytes(4)),
    "heartbeat": hand.heartbeat(W, 2, 9, 1),
    "gap": hand.gap(W, 5, hand.number_set(7, 40, (0xC0000000, 0))),
    "acknack": hand.acknack(hand.READER, W, hand.number_set(7, 40, (0xC0000000, 0)), 1),
    "spdp": hand.data(hand.SPDP_WRITER, 1, hand.participant()),
    "sedp": hand.data(hand.PUBLICATIONS_WRITER, 5, hand.endpoint(hand.PREFIX + W)),
}


@pytest.mark.parametrize("name", BODIES)
def test_of_a_body_that_ends_badly_at_any_word_nothing_is_kept(name: str) -> None:
    async def script(r: Receiver) -> None:
        r.writer(0, W, wanted=5)
        r.reader(1, hand.READER)
        r.put(r.builtin(0, 2, NEXT_LO), 5)
        body = BODIES[name]
        for cut in range(0, len(body) - 3, 4):
            came = await r.say(body, bad=True, cut=cut)
            assert not whole(came) and all(isinstance(octets, Bad) for octets, _ in came.discovery)
            assert (came.drops, came.due, came.changed) == ([], [], False), cut
        came = await r.say(body)  # and it is not stuck
        assert came.drops == []
        assert whole(came) or came.discovery or came.changed

    Receiver(20).run(script)


@pytest.mark.parametrize("name", ["data", "heartbeat", "gap", "acknack"])
def test_a_body_that_is_shorter_than_what_it_says_is_dropped(name: str) -> None:
    """By the codec. Only a bitmap that is not all there, or a count, is not missed: nothing follows from them."""
    enough = {"gap": 28, "acknack": 20}

    async def script(r: Receiver) -> None:
        body = BODIES[name]
        for cut in range(0, len(body) - 4 if name != "data" else 36, 4):
            r.writer(0, W, wanted=5)
            r.reader(1, hand.READER)
            try:
                parsed = codec.PARSERS[body[0]](memoryview(body), 4, 4 + cut, body[1])
            except ProtocolError:
                parsed = None
            came = await r.say(body, cut=cut)
            if cut >= enough.get(name, 1 << 16):
                assert came.changed and r.wanted(0) in (5, 7, 9), cut
            elif parsed is None or (name == "data" and not parsed.payload):
                assert came == dropped("invalid"), cut
            else:
                assert came.changed, cut

    Receiver().run(script)


# -- HEARTBEAT


def test_a_heartbeat_is_answered_unless_it_is_final_and_nothing_is_missing() -> None:
    async def script(r: Receiver) -> None:
        for wanted, first, last, final, due in (
            (5, 1, 9, False, True),
            (5, 1, 9, True, True),
            (10, 1, 9, False, True),
            (10, 1, 9, True, False),
            (1, 1, 0, False, True),  # it has nothing at all
            (1, 1, 0, True, False),
        ):
            r.writer(0, W, wanted=wanted)
            came = await r.say(hand.heartbeat(W, first, last, 1, flags=2 if final else 0))
            assert came.due == [USER0] * due and not came.drops, (wanted, first, last, final)
            assert r.wanted(0) == wanted
            assert r.word(r.endpoint(0, LAST)) == last

    Receiver(20).run(script)


@pytest.mark.parametrize("e", "<>")
def test_what_is_before_a_heartbeats_first_is_wanted_no_more(e: str) -> None:
    async def script(r: Receiver) -> None:
        for wanted, first, last, then in (
            (5, 8, 9, 8),
            (5, 5, 9, 5),
            (5, 4, 9, 5),
            (5, 10, 9, 10),  # all is gone
            (5, (1 << 32) + 3, (1 << 32) + 3, (1 << 32) + 3),
            ((1 << 32) - 1, 1 << 32, 1 << 32, 1 << 32),
            ((1 << 32) + 9, 9, (1 << 32) + 9, (1 << 32) + 9),
        ):
            r.writer(0, W, wanted=wanted)
            await r.say(hand.heartbeat(W, first, last, 1, e=e))
            assert r.wanted(0) == then

    Receiver().run(script)


def test_a_volatile_writer_that_was_not_heard_owes_nothing_of_what_its_first_heartbeat_covers() -> None:
    async def script(r: Receiver) -> None:
        for last in (9, 0xFF, 0xFFFFFFFF, 1 << 32):
            r.writer(0, W, wanted=0)
            came = await r.say(hand.heartbeat(W, 1, last, 1, flags=2))
            assert r.wanted(0) == last + 1 and came.due == []
            assert whole(await r.say(data(last + 1)))

    Receiver().run(script)


def test_after_data_what_a_heartbeat_told_of_is_asked_for_when_the_datagram_is_over() -> None:
    async def script(r: Receiver) -> None:
        r.writer(2, W, wanted=5)
        await r.say(hand.heartbeat(W, 1, 7, 1))
        assert (await r.say(data(5))).due == [USER0 + 2]
        assert (await r.say(data(6))).due == [USER0 + 2]
        assert (await r.say(data(7))).due == []

    Receiver().run(script)


# -- GAP


@pytest.mark.parametrize("e", "<>")
def test_a_gap_that_begins_at_what_is_wanted_or_before_is_skipped(e: str) -> None:
    bits = 0xFFFFFFFF
    cases = [
        (5, 5, 8, 0, (), 8),
        (5, 3, 8, 0, (), 8),
        (5, 6, 8, 0, (), 5),  # not yet
        (5, 5, 8, 32, (0xE0000000,), 11),
        (5, 5, 8, 32, (0x60000000,), 8),  # 8 itself is there
        (5, 5, 8, 2, (0xE0000000,), 10),  # bits beyond count for nothing
        (5, 5, 8, 32, (bits,), 40),
        (5, 1, 3, 32, (0x20000000,), 5),
        (9, 5, 8, 0, (), 9),
        (0, 5, 8, 0, (), 0),  # never heard
        (5, 5, (1 << 32) + 1, 0, (), (1 << 32) + 1),
        ((1 << 32) - 2, (1 << 32) - 2, (1 << 32) - 1, 32, (0xC0000000,), (1 << 32) + 1),
        (1 << 32, 1, 5, 0, (), 1 << 32),
    ]

    async def script(r: Receiver) -> None:
        for wanted, start, base, count, set_, then in cases:
            r.writer(0, W, wanted=wanted)
            came = await r.say(hand.gap(W, start, hand.number_set(base, count, set_, e), e))
            assert came.drops == [] and came.user == []
            assert r.wanted(0) == then, (wanted, start, base, count)

    Receiver(20).run(script)


def test_behind_a_first_word_of_ones_a_gap_is_skipped_in_part_and_never_too_much() -> None:
    async def script(r: Receiver) -> None:
        r.writer(0, W, wanted=5)
        await r.say(hand.gap(W, 5, hand.number_set(5, 256, (0xFFFFFFFF,) * 8)))
        assert 5 + 32 <= r.wanted(0) <= 5 + 256

    Receiver().run(script)


# -- ACKNACK


@pytest.mark.parametrize("e", "<>")
def test_an_acknack_tells_what_is_there_and_what_is_asked_for(e: str) -> None:
    async def script(r: Receiver) -> None:
        r.reader(1, hand.READER, slot=1)
        for base, count, final, ask_to, due in (
            (7, 1, True, 7, True),
            (7, 32, True, 38, True),
            (7, 256, True, 262, True),
            (7, 0, True, 7, False),
            (7, 0, False, 7, True),
            ((1 << 32) + 7, 5, True, 11, True),
        ):
            words = (0xFFFFFFFF,) * ((count + 31) // 32)
            body = hand.acknack(hand.READER, W, hand.number_set(base, count, words, e), 1, e)
            came = await r.say(body if final else body[:1] + bytes([body[1] & ~2]) + body[2:], slot=1)
            assert came.due == [USER0 + 1] * due and not came.drops
            base &= 0xFFFFFFFF
            assert r.word(r.endpoint(1, ACKED)) == base
            assert r.word(r.endpoint(1, ASK_FROM)) == base + (count == 0)
            assert r.word(r.endpoint(1, ASK_TO)) == ask_to

    Receiver(20).run(script)


# -- discovery


def test_lists_of_discovery_are_given_with_what_is_known_of_who_says_them() -> None:
    async def script(r: Receiver) -> None:
        said = hand.participant()
        came = await r.say(hand.data(hand.SPDP_WRITER, 1, said), slot=None)
        ((octets, meta),) = came.discovery
        assert octets == said and (meta.kind, meta.known, meta.gone) == (0, 0, 0)
        assert not came.changed and not came.drops
        for writer, proxy, kind in ((hand.PUBLICATIONS_WRITER, 2, 1), (hand.SUBSCRIPTIONS_WRITER, 3, 2)):
            r.put(r.builtin(1, proxy, NEXT_LO), 1)
            said = hand.endpoint(hand.PREFIX + W)
            assert (await r.say(hand.data(writer, 1, said), slot=None)) == dropped("unmatched")
            came = await r.say(hand.data(writer, 1, said), slot=1)
            ((octets, meta),) = came.discovery
            assert octets == said
            assert (meta.kind, meta.known, meta.slot, meta.gone, meta.has_key) == (kind, 1, 1, 0, 0)
            assert r.word(r.builtin(1, proxy, NEXT_LO)) == 2
            assert (await r.say(hand.data(writer, 1, said), slot=1)) == dropped("old")
            assert (await r.say(hand.data(writer, 3, said), slot=1)) == dropped("early")._replace(
                due=[4 + proxy]
            )
            came = await r.say(hand.heartbeat(writer, 1, 4, 1), slot=1)
            assert came.due == [4 + proxy] and r.word(r.builtin(1, proxy, LAST)) == 4

    Receiver(20).run(script)


def test_a_departure_says_so_with_its_key_in_the_scratch_area() -> None:
    key = bytes(range(0x80, 0x90))

    async def script(r: Receiver) -> None:
        for status, gone in (
            (b"\0\0\0\1", 1),
            (b"\0\0\0\2", 1),
            (b"\0\0\0\3", 1),
            (b"\0\0\0\4", 0),
            (b"\3\0\0\0", 0),
        ):
            for with_key in (True, False):
                found = [hand.parameter(0x70, key)] if with_key else []
                qos = hand.parameters(*found, hand.parameter(0x71, status))
                came = await r.say(hand.data(hand.SPDP_WRITER, 2, b"", qos=qos, flags=8))
                ((octets, meta),) = came.discovery
                assert (octets, meta.gone, meta.has_key) == (b"", gone, with_key)
                if with_key:
                    at = r.peers._scratch + 12
                    assert b"".join(r.word(at + n).to_bytes(4, "little") for n in range(4)) == key

    Receiver(20).run(script)


@pytest.mark.parametrize("e", "<>")
def test_acknacks_to_our_discovery_writers_are_kept_with_their_reader(e: str) -> None:
    async def script(r: Receiver) -> None:
        for reader, writer, kind in (
            (hand.PUBLICATIONS_READER, hand.PUBLICATIONS_WRITER, 0),
            (hand.SUBSCRIPTIONS_READER, hand.SUBSCRIPTIONS_WRITER, 1),
        ):
            came = await r.say(hand.acknack(reader, writer, hand.number_set(1, 3, (0,), e), 1, e), slot=1)
            assert came.due == [4 + kind]
            assert r.word(r.builtin(1, kind, ASK_TO)) == 3

    Receiver().run(script)


def test_a_readers_id_is_no_writers_and_the_reverse() -> None:
    """A peer that mixes them up, or means to, must not be believed: each has its own kind of proxy."""

    async def script(r: Receiver) -> None:
        for reader, writer in (
            (hand.PUBLICATIONS_READER, hand.PUBLICATIONS_WRITER),
            (hand.SUBSCRIPTIONS_READER, hand.SUBSCRIPTIONS_WRITER),
        ):
            for one in (
                hand.data(reader, 1, hand.endpoint(hand.PREFIX + W)),
                hand.heartbeat(reader, 1, 9, 1),
                hand.gap(reader, 1, hand.number_set(5, 0, ())),
                hand.acknack(writer, writer, hand.number_set(3, 32, (1,)), 1),
            ):
                assert await r.say(one) == dropped("unmatched"), one.hex()

    Receiver().run(script)


def test_every_reason_has_its_output() -> None:
    found = {
        name.removeprefix("drop_") for name in Receiver().block.signature.members if name.startswith("drop_")
    }
    assert found == set(DROPS)
