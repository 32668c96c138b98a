"""What a message may look like, rightly and not: hand-made, one case a test, with the reason that is counted."""

import pytest

from engine.rtps import hand
from engine.rtps.hand import PREFIX, PUBLICATIONS_WRITER, READER, WRITER
from engine.rtps.victim import BODY, OWN, RELIABLE, Victim, met
from roslet.engine.rtps import events

pytestmark = pytest.mark.micropython


@pytest.mark.parametrize("e", ["<", ">"])
def test_both_byte_orders_are_taken_everywhere(e: str) -> None:
    victim, _ = met(e)
    victim.take(
        hand.message(hand.info_ts(7, e), hand.data(WRITER, 1, BODY, e=e)),
        hand.message(hand.gap(WRITER, 2, hand.number_set(4, 1, (1 << 31,), e), e)),
        hand.message(hand.data_frag(WRITER, 5, 1, 1, 8, 12, b"\0\1\0\0fra", e)[:-3] + b"frag"),
        hand.message(hand.data_frag(WRITER, 5, 2, 1, 8, 12, b"ment", e)),
    )
    assert victim.samples()[0] == (1, BODY)
    assert victim.of(events.SampleReceived)[0].time == 7000000000


def test_an_invalidated_time_is_no_time() -> None:
    victim, _ = met()
    victim.take(
        hand.message(
            hand.info_ts(7),
            hand.data(WRITER, 1, BODY),
            hand.INFO_TS_INVALID,
            hand.data(WRITER, 2, BODY),
            hand.info_ts(8),
            hand.data(WRITER, 3, BODY),
        ),
        hand.message(hand.data(WRITER, 4, BODY)),
    )
    times = [one.time for one in victim.of(events.SampleReceived)]
    assert times == [7000000000, None, 8000000000, None]
    assert victim.counters == {}


def test_a_length_of_zero_means_to_the_end_of_the_message() -> None:
    victim, _ = met()
    long = b"\0\1\0\0" + bytes(60000)
    victim.take(hand.message(hand.info_ts(1), hand.data(WRITER, 1, long, length=0)))
    assert victim.samples() == [(1, long)]
    # In the middle it takes what follows with it.
    victim.take(hand.message(hand.data(WRITER, 2, BODY, length=0), hand.data(WRITER, 3, BODY)))
    assert [number for number, _ in victim.samples()] == [1, 2]
    assert victim.samples()[1][1].startswith(BODY)
    assert victim.counters == {}


def test_pad_and_time_of_no_octets_end_nothing() -> None:
    victim, _ = met()
    pad = hand.submessage(1, 0, b"")
    victim.take(hand.message(pad, hand.INFO_TS_INVALID, pad, pad, hand.data(WRITER, 1, BODY)))
    assert victim.samples() == [(1, BODY)]
    assert victim.counters == {}


def test_submessages_of_unknown_kinds_are_skipped() -> None:
    victim, _ = met()
    strange = hand.submessage(0x80, 0, bytes(12)) + hand.submessage(0x33, 0, bytes(4), ">")
    victim.take(hand.message(strange, hand.data(WRITER, 1, BODY)))
    assert victim.samples() == [(1, BODY)]
    assert victim.counters == {}


def test_what_lies_before_inline_qos_is_skipped() -> None:
    victim, _ = met()
    status = hand.parameters(hand.parameter(0x71, b"\0\0\0\1"))
    victim.take(
        hand.message(hand.data(WRITER, 1, BODY, skipped=bytes(8))),
        hand.message(hand.data(WRITER, 2, BODY, skipped=bytes(400), qos=status)),
    )
    assert victim.samples() == [(1, BODY), (2, BODY)]
    assert bytes(victim.of(events.SampleReceived)[1].inline_qos) == status
    assert victim.counters == {}


@pytest.mark.parametrize(
    ("to_qos", "reason"), [(15, "data-invalid"), (0, "data-invalid"), (40, "data-truncated")]
)
def test_inline_qos_that_begins_nowhere_is_dropped(to_qos: int, reason: str) -> None:
    victim, _ = met()
    victim.take(hand.message(hand.data(WRITER, 1, BODY, to_qos=to_qos)))
    assert victim.samples() == []
    assert victim.counters == {reason: 1}


def test_a_sample_for_nobody_in_particular_goes_to_every_matched_reader() -> None:
    victim = Victim()
    readers = [victim.participant.create_reader("t", "T", RELIABLE, 0.0) for _ in range(2)]
    stranger = victim.participant.create_reader("u", "T", RELIABLE, 0.0)
    victim.meet()
    victim.take(
        hand.message(hand.heartbeat(WRITER, 1, 0, 1)),
        hand.message(hand.data(WRITER, 1, BODY)),
        hand.message(hand.data(WRITER, 2, BODY, readers[0].entity_id)),
        hand.message(hand.data(WRITER, 2, BODY, stranger.entity_id)),
    )
    got = sorted([(one.local, one.sequence) for one in victim.of(events.SampleReceived)])
    assert got == [(readers[0].entity_id, 1), (readers[0].entity_id, 2), (readers[1].entity_id, 1)]


def test_what_is_for_another_participant_is_not_for_us() -> None:
    victim, _ = met()
    elsewhere = hand.info_dst(b"\7" * 12)
    victim.take(
        hand.message(elsewhere, hand.data(WRITER, 1, b"\0\1\0\0no")),
        hand.message(elsewhere, hand.info_dst(OWN), hand.data(WRITER, 1, BODY)),
        hand.message(elsewhere, hand.info_dst(bytes(12)), hand.data(WRITER, 2, BODY)),
    )
    assert victim.samples() == [(1, BODY), (2, BODY)]


def test_a_source_may_be_named_in_the_message() -> None:
    victim, _ = met()
    relayed = hand.message(hand.info_src(PREFIX), hand.data(WRITER, 1, BODY), prefix=b"\7" * 12)
    victim.take(relayed)
    assert victim.samples() == [(1, BODY)]


@pytest.mark.parametrize(
    ("datagram", "reason"),
    [
        (b"", "message-truncated"),
        (b"RTPS\x02\x03\x01\x0f" + bytes(11), "message-truncated"),
        (b"RTPX\x02\x03\x01\x0f" + bytes(12), "not-rtps"),
        (b"RTPS\x01\x03\x01\x0f" + bytes(12), "version-unsupported"),
        (b"RTPS\x03\x00\x01\x0f" + bytes(12), "version-unsupported"),
        (hand.message(b"\x15\x05\x10"), "submessage-truncated"),
        (hand.message(hand.submessage(0x15, 4, bytes(20), "<", 21)), "submessage-too-long"),
        (hand.message(hand.submessage(0x33, 0, b"", ">", 1)), "submessage-too-long"),
        (hand.message(hand.INFO_TS_INVALID * 5000), "too-many-submessages"),
        (hand.message(b"\x09\x01\0\0"), "info-ts-truncated"),
        (hand.message(hand.submessage(0x0E, 0, bytes(8))), "info-dst-truncated"),
        (hand.message(hand.submessage(0x0C, 0, bytes(8))), "info-src-truncated"),
        (hand.message(hand.submessage(7, 0, bytes(27))), "heartbeat-truncated"),
        (hand.message(hand.submessage(0x15, 0x0C, bytes(20))), "data-invalid"),
        (hand.message(hand.data(b"\0\0\7\3", 1, BODY)), "data-of-unmatched-writer"),
        (hand.message(hand.heartbeat(b"\0\0\7\3", 1, 1, 1)), "submessage-of-unmatched-writer"),
        (
            hand.message(hand.acknack(READER, b"\0\0\7\3", hand.number_set(1, 0, ()), 1)),
            "acknack-of-unknown-writer",
        ),
        (
            hand.message(hand.acknack(READER, PUBLICATIONS_WRITER, hand.number_set(1, 0, ()), 1)),
            "acknack-of-unmatched-reader",
        ),
        (hand.message(hand.nack_frag(READER, b"\0\0\7\3", 1, 1, 0, (), 1)), "nack-frag-of-unknown-writer"),
        (
            hand.message(hand.nack_frag(READER, PUBLICATIONS_WRITER, 1, 1, 0, (), 1)),
            "nack-frag-of-unmatched-reader",
        ),
        (
            hand.message(hand.acknack(READER, WRITER, hand.number_set(0, 1, (0,)), 1)),
            "number-set-base-invalid",
        ),
    ],
)
def test_messages_that_are_none_are_counted(datagram: bytes, reason: str) -> None:
    victim = Victim()
    victim.take(datagram)
    assert victim.counters == {reason: 1}
    assert victim.events == []


def test_what_came_before_a_fault_stays_valid() -> None:
    victim, _ = met()
    victim.take(
        hand.message(hand.data(WRITER, 1, BODY), hand.heartbeat(WRITER, 0, 0, 5), hand.data(WRITER, 2, BODY))
    )
    assert victim.samples() == [(1, BODY)]
    assert victim.counters == {"heartbeat-invalid": 1}
