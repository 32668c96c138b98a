"""A reader that has matched a writer, and does not know yet where its samples begin. Runs on MicroPython."""

import struct

import pytest

from engine.rtps import hand
from engine.rtps.hand import PREFIX, WRITER
from engine.rtps.test_bad_input import RELIABLE, Victim, sedp

pytestmark = pytest.mark.micropython

READER_ID = b"\0\0\1\4"  # of the first endpoint of a participant, a reader without a key


def matched() -> "tuple[Victim, list[tuple[int, list[int]]]]":
    """A victim with a reliable reader that has matched the writer of eProsima's peer, from which nothing has come; and what
    it asked of it."""
    victim = Victim()
    victim.participant.create_reader("t", "T", RELIABLE, 0.0)
    victim.participant.receive_datagram(hand.spdp(), hand.SOURCE, 0.0)
    victim.participant.receive_datagram(sedp(hand.endpoint(PREFIX + WRITER)), hand.SOURCE, 0.0)
    return victim, asked(victim)


def asked(victim: Victim) -> "list[tuple[int, list[int]]]":
    """(base, numbers) of the requests that go to the peer's writer in this turn."""
    found = []
    for datagram, _ in victim.turn():
        view = memoryview(datagram)
        at = datagram.find(READER_ID + WRITER)
        if at > 0 and view[at - 4] == 0x06:
            high, base, bits = struct.unpack_from("<iII", view, at + 8)
            words = struct.unpack_from("<%dI" % ((bits + 31) // 32), view, at + 20)
            numbers = [base + n for n in range(bits) if words[n // 32] & (0x80000000 >> (n % 32))]
            found.append(((high << 32) + base, numbers))
    return found


def test_fast_dds_is_asked_in_the_form_that_it_answers_at_once() -> None:
    _, requests = matched()
    assert requests == [(0, [])]


def test_the_first_sample_of_all_needs_no_heartbeat() -> None:
    victim, _ = matched()
    for number, body in ((1, b"\0\1\0\0one"), (2, b"\0\1\0\0two")):
        victim.take(hand.message(hand.data(WRITER, number, body)))
    assert victim.samples() == [(1, b"\0\1\0\0one"), (2, b"\0\1\0\0two")]


def test_what_precedes_the_first_that_came_is_asked_for_at_once() -> None:
    victim, _ = matched()
    victim.participant.receive_datagram(
        hand.message(hand.data(WRITER, 4, b"\0\1\0\0four")), hand.SOURCE, victim.now
    )
    assert asked(victim) == [(1, [1, 2, 3])]
    assert victim.samples() == []
    victim.take(hand.message(hand.gap(WRITER, 1, hand.number_set(4, 0, ()))))
    assert victim.samples() == [(4, b"\0\1\0\0four")]
