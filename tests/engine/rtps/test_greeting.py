"""A reader and a writer that have matched, and do not know yet of each other where they are. Runs on MicroPython."""

import struct

import pytest

from engine.rtps import hand
from engine.rtps.hand import PREFIX, READER, SUBSCRIPTIONS_WRITER, WRITER
from engine.rtps.victim import BODY, RELIABLE, Victim, sedp

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

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
    for number, said in ((1, b"\0\1\0\0one"), (2, b"\0\1\0\0two")):
        victim.take(hand.message(hand.data(WRITER, number, said)))
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


# -- a reader that learns of our writer only after samples were sent. Cyclone's, where it is volatile, takes for history, of
# which it has no use, all that the first heartbeat it sees tells of.


def introduced(**fields: "Any") -> "tuple[Victim, Any]":
    """A victim with a volatile writer of t that has matched the peer's reader, which has said nothing."""
    victim = Victim(**fields)
    writer = victim.participant.create_writer("t", "T", RELIABLE, 0.0)
    victim.take(hand.spdp(), sedp(hand.endpoint(PREFIX + READER), 1, SUBSCRIPTIONS_WRITER))
    return victim, writer


def lasts(victim: Victim, writer: "Any") -> "list[int]":
    """The last numbers of the heartbeats that the writer sends in this turn."""
    found = []
    for datagram, _ in victim.turn():
        at = 20
        while at < len(datagram):
            kind, size = datagram[at], struct.unpack_from("<H", datagram, at + 2)[0]
            if kind == 0x07 and datagram[at + 8 : at + 12] == writer.entity_id:
                high, low = struct.unpack_from("<iI", datagram, at + 20)
                found.append((high << 32) + low)
            at = at + 4 + size if size or kind in (0x01, 0x09) else len(datagram)
    return found


def preemptive(writer: "Any", base: int = 1) -> bytes:
    """What Cyclone's reader says as soon as it knows of a writer."""
    body = READER + writer.entity_id + hand.number_set(base, 0, ()) + struct.pack("<I", 0)
    return hand.message(hand.submessage(0x06, 0, body))


@pytest.mark.parametrize("before", [0, 5])
@pytest.mark.parametrize(("size", "count"), [(8, 40), (20000, 20), (300000, 3)])
def test_whatever_heartbeat_a_reader_sees_first_tells_where_it_begins(
    size: int, count: int, before: int
) -> None:
    victim = Victim()
    writer = victim.participant.create_writer("t", "T", RELIABLE, 0.0)
    for _ in range(before):
        writer.write(BODY, 0.0)
    victim.take(hand.spdp())
    victim.participant.receive_datagram(
        sedp(hand.endpoint(PREFIX + READER), 1, SUBSCRIPTIONS_WRITER), hand.SOURCE, 0.0
    )
    turns = [lasts(victim, writer)]
    for number in range(count + 100):
        if number < count:
            writer.write(b"\0\1\0\0" + bytes(size), victim.now)
        victim.now += 0.005
        turns.append(lasts(victim, writer))
    assert [found[0] for found in turns if found] == [before] * len([found for found in turns if found])
    assert max([max(found) for found in turns if found]) == before + count


def test_the_introduction_comes_with_each_of_the_first_samples() -> None:
    victim, writer = introduced()
    found = []
    for _ in range(12):
        writer.write(BODY, victim.now)
        found.append(lasts(victim, writer)[:1])
    assert found == [[0]] * 8 + [[]] * 4


def test_a_reader_that_speaks_for_the_first_time_is_told_where_it_begins_and_then_what_there_is() -> None:
    victim, writer = introduced()
    for _ in range(3):
        writer.write(BODY, victim.now)
    victim.turn()
    victim.participant.receive_datagram(preemptive(writer), hand.SOURCE, victim.now)
    assert lasts(victim, writer) == [0, 3]
    # Behind large samples it is asked for what there is when they are out.
    victim, writer = introduced()
    for _ in range(20):
        writer.write(bytes(100000), victim.now)
    victim.turn()
    victim.participant.receive_datagram(preemptive(writer), hand.SOURCE, victim.now)
    assert lasts(victim, writer)[0] == 0
    # Who has everything is not.
    victim, writer = introduced()
    writer.write(BODY, victim.now)
    victim.turn()
    victim.participant.receive_datagram(preemptive(writer, 2), hand.SOURCE, victim.now)
    assert lasts(victim, writer) == [1]
