"""Sequence and fragment numbers that are wrong, or at their limit: hand-made, with the reason that is counted."""

import pytest

from engine.rtps import hand
from engine.rtps.hand import LAST, PREFIX, READER, SOURCE, WRITER
from engine.rtps.victim import BODY, RELIABLE, met, offered, sedp
from roslet.engine.rtps.limits import Limits

pytestmark = pytest.mark.micropython


def test_numbers_at_their_limit_are_taken_and_answered() -> None:
    victim, reader = met()
    victim.take(
        hand.message(hand.heartbeat(WRITER, LAST - 2, LAST, 2)),
        hand.message(hand.data(WRITER, LAST, BODY)),
        hand.message(hand.data(WRITER, LAST - 2, BODY)),
        hand.message(hand.data(WRITER, LAST - 1, BODY)),
    )
    assert [number for number, _ in victim.samples()] == [LAST - 2, LAST - 1, LAST]
    for count in range(3, 6):
        victim.now += 1.0
        victim.take(hand.message(hand.heartbeat(WRITER, LAST - 2, LAST, count)))
    victim.take(hand.message(hand.heartbeat(WRITER, LAST, LAST - 1, 6)))
    assert len(reader.proxies) == 1


@pytest.mark.parametrize("sequence", [0, -1, -LAST - 1])
def test_numbers_below_one_are_dropped(sequence: int) -> None:
    victim, _ = met()
    victim.take(
        hand.message(hand.data(WRITER, sequence, BODY)),
        hand.message(hand.data_frag(WRITER, sequence, 1, 1, 8, 8, bytes(8))),
        hand.message(hand.gap(WRITER, sequence, hand.number_set(1, 0, ()))),
        hand.message(hand.heartbeat(WRITER, sequence, 5, 9)),
    )
    assert victim.samples() == []
    expected = {"data-invalid": 1, "data-frag-invalid": 1, "gap-invalid": 1, "heartbeat-invalid": 1}
    assert victim.counters == expected


def test_a_gap_at_the_limit_ends_at_the_limit() -> None:
    victim, _ = met()
    words = (0xFFFFFFFF,) * 8
    victim.take(
        hand.message(hand.gap(WRITER, LAST - 1, hand.number_set(LAST, 256, words))),
        hand.message(hand.gap(WRITER, 1, hand.number_set(LAST, 256, words))),
        hand.message(hand.heartbeat(WRITER, LAST, LAST, 2)),
    )
    for count in range(3, 6):
        victim.now += 1.0
        victim.take(hand.message(hand.heartbeat(WRITER, 1, LAST, count)))
    assert victim.samples() == []


def test_an_acknowledgement_beyond_the_last_sample_acknowledges_no_more_than_that() -> None:
    victim, writer = offered()
    writer.write(BODY, 0.0)
    victim.take(hand.message(hand.acknack(READER, writer.entity_id, hand.number_set(LAST, 0, ()), 1)))
    assert writer.acknowledged(1)
    writer.write(BODY, 0.0)
    assert not writer.acknowledged(2)
    words = (0xFFFFFFFF,) * 8
    everything = hand.number_set(LAST, 256, words)
    victim.take(hand.message(hand.acknack(READER, writer.entity_id, everything, 2)))
    assert victim.turn() == []


@pytest.mark.parametrize("bits", [257, 0x100000, 0xFFFFFFFF])
def test_sets_of_more_than_256_numbers_are_dropped(bits: int) -> None:
    victim, writer = offered()
    reader = victim.participant.create_reader("t", "T", RELIABLE, 0.0)
    victim.take(sedp(hand.endpoint(PREFIX + WRITER)))
    words = (0xFFFFFFFF,) * 9
    many = hand.number_set(1, bits, words)
    victim.take(
        hand.message(hand.acknack(READER, writer.entity_id, many, 1)),
        hand.message(hand.gap(WRITER, 1, many)),
        hand.message(hand.nack_frag(READER, writer.entity_id, 1, 1, bits, words, 1)),
    )
    assert victim.counters == {"number-set-too-large": 3}
    assert reader.proxies[PREFIX + WRITER].next == 1


def test_a_set_that_is_longer_than_its_submessage_is_dropped() -> None:
    victim, writer = offered()
    victim.take(hand.message(hand.acknack(READER, writer.entity_id, hand.number_set(1, 256, (1,)), 1)))
    assert victim.counters == {"number-set-truncated": 1}


def test_a_heartbeat_that_ends_before_it_begins_is_dropped() -> None:
    victim, reader = met()
    victim.take(hand.message(hand.heartbeat(WRITER, 9, 7, 5)))
    assert victim.counters == {"heartbeat-invalid": 1}
    assert reader.proxies[PREFIX + WRITER].next == 1
    # Of one less than the first it says that there is nothing.
    victim.take(hand.message(hand.heartbeat(WRITER, 9, 8, 6)))
    assert victim.counters == {"heartbeat-invalid": 1}
    assert reader.proxies[PREFIX + WRITER].next == 9


def test_a_heartbeat_that_promises_everything_costs_one_request() -> None:
    victim, _ = met()
    victim.now = 1.0
    victim.turn()
    victim.participant.receive_datagram(hand.message(hand.heartbeat(WRITER, 1, LAST, 2)), SOURCE, 1.0)
    sent = victim.turn()
    assert len(sent) == 1
    assert len(sent[0][0]) < 128


@pytest.mark.parametrize(
    ("first", "count", "size", "total", "octets", "reason"),
    [
        (1, 1, 1, 0xFFFFFFFF, 1, "sample-too-large"),
        (0xFFFFFFFF, 1, 1, 0xFFFFFFFF, 1, "sample-too-large"),
        (1, 0xFFFF, 8, 16, 16, "data-frag-invalid"),
        (0xFFFFFFFF, 0xFFFF, 8, 16, 16, "data-frag-invalid"),
        (0, 1, 8, 16, 8, "data-frag-invalid"),
        (1, 0, 8, 16, 8, "data-frag-invalid"),
        (1, 1, 0, 16, 8, "data-frag-invalid"),
        (1, 1, 8, 0, 8, "data-frag-invalid"),
        (1, 0xFFFF, 0xFFFF, 0xFFFE0001, 100, "data-frag-truncated"),
        (1, 1, 8, 16, 7, "data-frag-truncated"),
    ],
)
def test_fragments_that_cannot_be_are_dropped(
    first: int, count: int, size: int, total: int, octets: int, reason: str
) -> None:
    victim, reader = met()
    victim.take(hand.message(hand.data_frag(WRITER, 1, first, count, size, total, bytes(octets))))
    assert victim.counters == {reason: 1}
    assert reader.proxies[PREFIX + WRITER].assemblies == {}


def test_of_overlapping_fragments_the_first_counts() -> None:
    victim, _ = met()
    whole = b"\0\1\0\0" + bytes(range(28))
    victim.take(
        hand.message(hand.data_frag(WRITER, 1, 1, 2, 8, 32, whole[:16])),
        hand.message(hand.data_frag(WRITER, 1, 2, 2, 8, 32, b"\xff" * 8 + whole[16:24])),
        hand.message(hand.data_frag(WRITER, 1, 1, 1, 8, 32, b"\xff" * 8)),
        hand.message(hand.data_frag(WRITER, 1, 4, 1, 8, 32, whole[24:])),
        hand.message(hand.data_frag(WRITER, 1, 4, 1, 8, 32, b"\xff" * 8)),
    )
    assert victim.samples() == [(1, whole)]
    assert victim.counters == {"sample-repeated": 1}


def test_fragments_of_another_division_do_not_mix() -> None:
    victim, _ = met()
    whole = b"\0\1\0\0" + bytes(range(28))
    victim.take(
        hand.message(hand.data_frag(WRITER, 1, 1, 2, 8, 32, whole[:16])),
        hand.message(hand.data_frag(WRITER, 1, 2, 1, 16, 32, b"\xff" * 16)),
        hand.message(hand.data_frag(WRITER, 1, 3, 1, 8, 24, b"\xff" * 8)),
        hand.message(hand.data_frag(WRITER, 1, 3, 2, 8, 32, whole[16:])),
    )
    assert victim.samples() == [(1, whole)]
    assert victim.counters == {"fragment-of-another-size": 2}


def test_what_is_put_together_at_once_is_bounded() -> None:
    limits = Limits(assemblies=3, sample_bytes=4000, assembly_bytes=10000)
    victim, reader = met(limits=limits)
    for sequence in (9, 8, 7, 6, 5):
        victim.take(hand.message(hand.data_frag(WRITER, sequence, 1, 1, 1000, 4000, bytes(1000))))
    proxy = reader.proxies[PREFIX + WRITER]
    assert sum([one.size for one in proxy.assemblies.values()]) <= 10000
    assert len(proxy.assemblies) <= 3
    assert victim.counters["assembly-bytes-full"] >= 1
    victim.take(hand.message(hand.data_frag(WRITER, 4, 1, 1, 1000, 4001, bytes(1000))))
    assert victim.counters["sample-too-large"] == 1
    victim.take(hand.departure())
    assert victim.participant._common.assembling.left == 10000


def test_a_request_for_fragments_that_are_not_there_is_no_flood() -> None:
    victim, writer = offered(fragment_size=1000)
    writer.write(b"\0\1\0\0" + bytes(2500), 0.0)
    victim.now += 1.0
    victim.turn()
    everything = (0xFFFFFFFF,) * 8
    sent = []
    for count in range(1, 20):
        request = hand.nack_frag(READER, writer.entity_id, 1, 2, 256, everything, count)
        victim.participant.receive_datagram(hand.message(request), SOURCE, victim.now)
        sent += victim.turn()
    # Fragments 2 and 3, and the heartbeat behind them, for each.
    assert len(sent) <= 3 * 19


@pytest.mark.parametrize("sequence", [2, 77, LAST])
def test_fragments_of_a_sample_that_is_yet_to_be_written_are_not_declared_a_gap(sequence: int) -> None:
    victim, writer = offered(fragment_size=1000)
    writer.write(b"\0\1\0\0" + bytes(2500), 0.0)
    victim.now += 1.0
    victim.turn()
    request = hand.nack_frag(READER, writer.entity_id, sequence, 1, 32, (0xFFFFFFFF,), 99)
    victim.participant.receive_datagram(hand.message(request), SOURCE, victim.now)
    assert victim.turn() == []
    assert victim.counters == {"nack-frag-of-unwritten-sample": 1}


def test_repeated_counts_are_not_answered_again() -> None:
    victim, writer = offered()
    writer.write(BODY, 0.0)
    victim.now += 1.0
    victim.turn()
    request = hand.message(hand.acknack(READER, writer.entity_id, hand.number_set(1, 1, (1 << 31,)), 5))
    victim.participant.receive_datagram(request, SOURCE, victim.now)
    assert len(victim.turn()) >= 1
    victim.participant.receive_datagram(request, SOURCE, victim.now)
    assert victim.turn() == []
    assert victim.counters == {"acknack-repeated": 1}
