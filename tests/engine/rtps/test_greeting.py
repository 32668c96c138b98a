"""A reader and a writer that have matched, and do not know yet of each other where they are. Runs on MicroPython."""

import struct

import pytest

from engine.rtps import hand
from engine.rtps.hand import PREFIX, WRITER
from engine.rtps.network import Network, body, pair
from engine.rtps.victim import RELIABLE, Victim, sedp

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


def test_a_reader_that_has_said_nothing_yet_is_told_where_we_are_before_each_of_the_first_samples() -> None:
    """Cyclone drops samples of a writer whose heartbeat it has not seen; the first may have come before the announcement."""
    network = Network()
    one, _, writer, _ = pair(network, RELIABLE, RELIABLE)
    assert network.run(5, lambda: bool(writer.proxies))
    one.participant.datagrams_to_send(network.now)
    sent = []
    for number in range(3):
        writer.write(body(number), network.now)
        sent += [
            b"".join([bytes(part) for part in parts])
            for parts, _ in one.participant.datagrams_to_send(network.now)
        ]
    # A datagram with INFO_DST and HEARTBEAT, one with INFO_TS and DATA, and so on.
    assert [(datagram[20], datagram[36] if datagram[20] == 0x0E else datagram[32]) for datagram in sent] == [
        (0x0E, 0x07),
        (0x09, 0x15),
    ] * 3
    assert [datagram[36 + 24] for datagram in sent[::2]] == [0, 1, 2]  # the last number at each
