"""Announcements that are wrong or odd, and what another address may not do in a peer's name.

RTPS has no authentication: the last say what another address cannot do; docs/ros2-scaling.md says what it can.
"""

import pytest

from engine.rtps import hand
from engine.rtps.hand import (
    HOST,
    LAST,
    PREFIX,
    PUBLICATIONS_WRITER,
    READER,
    SPDP_WRITER,
    SUBSCRIPTIONS_READER,
    SUBSCRIPTIONS_WRITER,
    WRITER,
)
from engine.rtps.victim import BODY, RELIABLE, Victim, met, offered, sedp
from roslet.engine.rtps import events
from roslet.engine.rtps.limits import Limits

pytestmark = pytest.mark.micropython

ELSEWHERE = ("10.0.0.66", 7410)


def test_an_endpoint_without_locators_is_reached_at_its_participants() -> None:
    _, writer = offered()
    assert writer.proxies[PREFIX + READER].addresses == ((HOST, 7411),)


def test_an_endpoint_that_nothing_reaches_gets_nothing() -> None:
    victim = Victim()
    writer = victim.participant.create_writer("t", "T", RELIABLE, 0.0)
    nowhere = hand.payload(
        hand.parameter(0x50, PREFIX + hand.PARTICIPANT), hand.parameter(0x58, b"\x3f\x0c\0\0")
    )
    victim.take(
        hand.message(hand.data(SPDP_WRITER, 1, nowhere)),
        sedp(hand.endpoint(PREFIX + READER), 1, SUBSCRIPTIONS_WRITER),
    )
    writer.write(BODY, 0.0)
    for _ in range(40):
        victim.now += 0.1
        assert [one for one in victim.turn() if one[1] != (("239.255.0.1", 7400),)] == []
    assert victim.counters == {}


def test_announcements_of_one_participant_take_no_more_than_its_share() -> None:
    victim = Victim(limits=Limits(discovery_share=200000))
    octets = (64000).to_bytes(4, "little") + b"u" * 64000
    large = hand.parameter(0x2C, octets)
    victim.take(hand.spdp())
    for number in range(1, 8):
        said = hand.endpoint(PREFIX + bytes((0, 0, number, 3)), "t", "T", "<", large)
        victim.take(hand.message(hand.data(PUBLICATIONS_WRITER, number, said, length=0)))
    assert len(victim.participant.endpoints) == 3
    assert victim.counters == {"discovery-bytes-full": 4}
    # What it says anew takes the place of what it said before; what it takes back makes room.
    small = hand.endpoint(PREFIX + bytes((0, 0, 1, 3)), "t", "T")
    victim.take(hand.message(hand.data(PUBLICATIONS_WRITER, 8, small)))
    said = hand.endpoint(PREFIX + bytes((0, 0, 9, 3)), "t", "T", "<", large)
    victim.take(hand.message(hand.data(PUBLICATIONS_WRITER, 9, said, length=0)))
    assert len(victim.participant.endpoints) == 4
    assert victim.counters == {"discovery-bytes-full": 4}
    victim.take(hand.departure())
    assert victim.participant.endpoints == {} and victim.participant._matching._budget.left == 64 << 20


@pytest.mark.parametrize(
    ("said", "reason"),
    [
        (hand.endpoint(PREFIX + WRITER, ""), "endpoint-without-topic"),
        (hand.endpoint(PREFIX + WRITER, "t", ""), "endpoint-without-type"),
        (hand.payload(hand.parameter(0x5A, PREFIX + WRITER)), "endpoint-without-topic"),
        (
            hand.payload(hand.parameter(0x5A, PREFIX + WRITER), hand.parameter(0x05, b"")),
            "endpoint-without-topic",
        ),
        (hand.payload(hand.parameter(0x05, hand.text("t"))), "endpoint-without-guid"),
        (hand.payload(), "endpoint-without-guid"),
        (hand.endpoint(PREFIX + b"\0\0\1\xc1"), "endpoint-kind-unknown"),
        (hand.endpoint(PREFIX + READER), "endpoint-of-another-participant"),
        (hand.endpoint(b"\7" * 12 + WRITER), "endpoint-of-another-participant"),
        (hand.endpoint(PREFIX + WRITER)[:-4], "parameter-list-unterminated"),
        (b"\0\1\0\0" + bytes(8), "payload-not-a-parameter-list"),
        (b"\0\3", "payload-truncated"),
        (b"", "payload-truncated"),
        (hand.payload(hand.parameter(0x7123, b"")), "parameter-not-understood"),
        (b"\0\3\0\0\x05\0\xff\x7f" + bytes(8), "parameter-truncated"),
        (hand.payload(*[hand.parameter(0, b"")] * 600), "too-many-parameters"),
        (
            hand.payload(hand.parameter(0x5A, PREFIX + WRITER), hand.parameter(5, b"\xff\xff\xff\xff")),
            "parameter-truncated",
        ),
    ],
)
def test_endpoints_that_say_too_little_are_dropped(said: bytes, reason: str) -> None:
    victim = Victim()
    victim.participant.create_reader("t", "T", RELIABLE, 0.0)
    victim.take(hand.spdp(), sedp(said))
    assert victim.participant.endpoints == {}
    assert victim.counters == {reason: 1}
    # The next one is not harmed.
    victim.take(sedp(hand.endpoint(PREFIX + WRITER), 2))
    assert list(victim.participant.endpoints) == [PREFIX + WRITER]


def test_parameters_of_no_octets_are_as_good_as_absent() -> None:
    victim = Victim()
    empty = [hand.parameter(pid, b"") for pid in (0x2C, 0x2F, 0x1D, 0x62, 0, 0x15)]
    victim.take(hand.spdp(PREFIX, HOST, "<", 1, *empty))
    victim.take(sedp(hand.endpoint(PREFIX + WRITER, "t", "T", "<", *empty)))
    assert list(victim.participant.endpoints) == [PREFIX + WRITER]
    assert victim.counters == {}


def test_an_endpoint_with_64_kib_of_user_data_is_an_endpoint() -> None:
    victim = Victim()
    victim.participant.create_reader("t", "T", RELIABLE, 0.0)
    size = 64000
    octets = size.to_bytes(4, "little") + b"u" * size
    said = hand.endpoint(PREFIX + WRITER, "t", "T", "<", hand.parameter(0x2C, octets))
    victim.take(hand.spdp(), hand.message(hand.data(PUBLICATIONS_WRITER, 1, said, length=0)))
    victim.take(hand.message(hand.heartbeat(PUBLICATIONS_WRITER, 1, 1, 1)))
    assert victim.participant.endpoints[PREFIX + WRITER].qos.user_data == b"u" * size
    assert len(victim.of(events.EndpointMatched)) == 1
    # A count beyond the parameter allocates nothing.
    lie = hand.parameter(0x2C, b"\xff\xff\xff\xff" + bytes(8))
    victim.take(sedp(hand.endpoint(PREFIX + b"\0\0\x12\x03", "t", "T", "<", lie), 2))
    assert victim.counters == {"parameter-truncated": 1}


@pytest.mark.parametrize(
    ("said", "reason"),
    [
        (hand.payload(), "participant-without-guid"),
        (hand.payload(hand.parameter(0x50, bytes(16))), "participant-without-guid"),
        (hand.participant(b"\7" * 12), "participant-of-another-prefix"),
        (
            hand.participant(PREFIX, HOST, "<", hand.parameter(0x0F, b"\7\0\0\0")),
            "participant-of-another-domain",
        ),
        (
            hand.participant(PREFIX, HOST, "<", hand.parameter(0x4014, hand.text("lab"))),
            "participant-of-another-domain",
        ),
        (hand.payload(hand.parameter(0x50, PREFIX)), "parameter-truncated"),
    ],
)
def test_participants_that_are_none_of_ours_are_dropped(said: bytes, reason: str) -> None:
    victim = Victim()
    victim.take(hand.message(hand.data(SPDP_WRITER, 1, said)))
    assert victim.participant.spdp.remotes == {}
    assert victim.counters == {reason: 1}


def test_another_address_cannot_redirect_or_end_a_participant() -> None:
    victim, reader = met()
    before = victim.participant.spdp.remotes[PREFIX].metatraffic
    status = hand.parameters(hand.parameter(0x70, PREFIX + WRITER), hand.parameter(0x71, b"\0\0\0\3"))
    disposal = hand.data(
        PUBLICATIONS_WRITER, 2, hand.payload(hand.parameter(0x5A, PREFIX + WRITER)), qos=status, flags=8
    )
    away = hand.endpoint(PREFIX + WRITER, "t", "T", "<", hand.parameter(0x2F, hand.locator("10.0.0.66", 7)))
    lies = [
        hand.spdp(PREFIX, "10.0.0.66", "<", 2),
        hand.departure(),
        hand.message(disposal),
        sedp(away, 2),
        hand.message(hand.heartbeat(PUBLICATIONS_WRITER, LAST, LAST, 9)),
        hand.message(hand.gap(PUBLICATIONS_WRITER, 1, hand.number_set(LAST, 0, ()))),
        hand.message(hand.data_frag(PUBLICATIONS_WRITER, 2, 1, 1, 8, 8, bytes(8))),
        hand.message(
            hand.acknack(SUBSCRIPTIONS_READER, SUBSCRIPTIONS_WRITER, hand.number_set(LAST, 0, ()), 9)
        ),
        hand.message(hand.info_src(PREFIX), hand.data(SPDP_WRITER, 3, b""), prefix=b"\7" * 12),
    ]
    victim.take(*lies, source=ELSEWHERE)
    assert victim.counters == {"discovery-from-another-address": len(lies) + 1}  # one has a heartbeat, too
    assert victim.participant.spdp.remotes[PREFIX].metatraffic == before
    assert reader.proxies[PREFIX + WRITER].addresses == ((HOST, 7411),)
    assert victim.of(events.EndpointUnmatched) == victim.of(events.ParticipantLost) == []
    # And what the real one says is heard.
    victim.take(sedp(hand.endpoint(PREFIX + b"\0\0\x12\3"), 2), hand.departure())
    assert len(victim.of(events.EndpointMatched)) == 2
    assert len(victim.of(events.ParticipantLost)) == 1


def test_another_address_cannot_keep_a_dead_participant_alive() -> None:
    victim, _ = met()
    for _ in range(25):
        victim.now += 1.0
        victim.take(hand.message(hand.heartbeat(WRITER, 1, 0, 1)), source=ELSEWHERE)
    assert len(victim.of(events.ParticipantLost)) == 1


def test_a_participant_that_has_moved_is_found_again_within_half_its_lease() -> None:
    victim, reader = met()
    sequence = 1
    while victim.now < 10.5:
        sequence += 1
        victim.now += 1.5
        victim.take(hand.spdp(PREFIX, "10.0.0.66", "<", sequence), source=ELSEWHERE)
    assert victim.participant.spdp.remotes[PREFIX].metatraffic == (("10.0.0.66", 7410),)
    assert reader.proxies[PREFIX + WRITER].addresses == (("10.0.0.66", 7411),)
    assert victim.of(events.ParticipantLost) == []


def test_a_participant_speaks_from_each_of_its_addresses_and_from_loopback() -> None:
    victim, _ = met()
    more = hand.parameter(0x31, hand.locator("172.16.0.9", 7411))
    victim.take(hand.spdp(PREFIX, HOST, "<", 2, more))
    for number, host in enumerate((HOST, "172.16.0.9", "127.0.0.1")):
        said = hand.endpoint(PREFIX + bytes((0, 1, number, 3)))
        victim.take(sedp(said, 2 + number), source=(host, 55555))
    assert victim.counters == {}
    assert len(victim.of(events.EndpointMatched)) == 4
