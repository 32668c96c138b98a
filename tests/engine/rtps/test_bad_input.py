"""What comes from the network and is wrong, odd or hostile: hand-made, one case a test, with the reason that is counted."""

import pytest

from engine.rtps import hand
from engine.rtps.hand import (
    ANYONE,
    HOST,
    PREFIX,
    PUBLICATIONS_READER,
    PUBLICATIONS_WRITER,
    READER,
    SOURCE,
    SPDP_WRITER,
    SUBSCRIPTIONS_READER,
    SUBSCRIPTIONS_WRITER,
    WRITER,
)
from roslet.engine.rtps import events
from roslet.engine.rtps.limits import Limits
from roslet.engine.rtps.participant import Participant
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps.qos import Qos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython

RELIABLE = Qos((qos.RELIABLE, 100000000), history=(qos.KEEP_LAST, 10))
LATCHED = Qos((qos.RELIABLE, 100000000), qos.TRANSIENT_LOCAL, (qos.KEEP_LAST, 10))
LAST = 0x7FFFFFFFFFFFFFFF
BODY = b"\0\1\0\0body"
OWN = b"\x01\x52" + bytes(10)


class Victim:
    """A participant, driven by hand. `meet` makes it know the peer of `hand` with a writer of topic t."""

    def __init__(self, **fields: "Any") -> None:
        meta, user = locator.udp4("10.0.0.1", 7410), locator.udp4("10.0.0.1", 7411)
        self.participant = Participant(OWN, 0, (meta,), (user,), (("239.255.0.1", 7400),), **fields)
        self.now = 0.0
        self.events: list[Any] = []
        self.participant.start(0.0)
        self.turn()

    @property
    def counters(self) -> "dict[str, int]":
        return self.participant.counters

    def turn(self) -> "list[tuple[bytes, tuple[Any, ...]]]":
        """What a runtime does after each datagram; returns what was sent."""
        self.participant.handle_deadline(self.now)
        sent = [
            (b"".join([bytes(part) for part in parts]), addresses)
            for parts, addresses in self.participant.datagrams_to_send(self.now)
        ]
        self.events += self.participant.take_events()
        return sent

    def take(self, *datagrams: bytes, source: "tuple[str, int]" = SOURCE) -> None:
        for datagram in datagrams:
            self.participant.receive_datagram(datagram, source, self.now)
            self.turn()

    def of(self, kind: type) -> "list[Any]":
        return [event for event in self.events if isinstance(event, kind)]

    def samples(self) -> "list[tuple[int, bytes]]":
        return [(one.sequence, bytes(one.payload)) for one in self.of(events.SampleReceived)]

    def meet(self, e: str = "<") -> None:
        self.take(hand.spdp(e=e), sedp(hand.endpoint(PREFIX + WRITER, "t", "T", e), e=e))


def sedp(said: bytes, sequence: int = 1, writer: bytes = PUBLICATIONS_WRITER, e: str = "<") -> bytes:
    """An announcement of an endpoint, and the heartbeat that goes with it."""
    return hand.message(
        hand.data(writer, sequence, said, e=e), hand.heartbeat(writer, 1, sequence, sequence, e=e)
    )


def met(e: str = "<", **fields: "Any") -> "tuple[Victim, Any]":
    """A victim with a reliable reader of t that has matched the peer's writer and knows where it begins."""
    victim = Victim(**fields)
    reader = victim.participant.create_reader("t", "T", RELIABLE, 0.0)
    victim.meet(e)
    victim.take(hand.message(hand.heartbeat(WRITER, 1, 0, 1, e=e)))
    assert len(victim.of(events.EndpointMatched)) == 1
    assert victim.counters == {}
    return victim, reader


def offered(**fields: "Any") -> "tuple[Victim, Any]":
    """A victim with a transient-local writer of t that has matched the peer's reader."""
    victim = Victim(**fields)
    writer = victim.participant.create_writer("t", "T", LATCHED, 0.0)
    victim.take(hand.spdp(), sedp(hand.endpoint(PREFIX + READER), 1, SUBSCRIPTIONS_WRITER))
    assert list(writer.proxies) == [PREFIX + READER]
    assert victim.counters == {}
    return victim, writer


# -- odd, and right


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


# -- sequence numbers


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


# -- fragments


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
    assert victim.participant._budget.left == 10000


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


# -- discovery


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


# -- floods


def test_a_flood_of_participants_stops_at_the_bound() -> None:
    victim = Victim(limits=Limits(participants=20))
    for number in range(500):
        victim.take(hand.spdp(b"\7\7" + number.to_bytes(10, "big")))
    assert len(victim.participant.spdp.remotes) == 20
    assert victim.counters == {"participants-full": 480}
    # Those that were known before are served; when the flood's leases have run out, others get in.
    victim.now = 19.0
    victim.take(hand.spdp(b"\7\7" + (3).to_bytes(10, "big")))
    victim.now = 21.0
    victim.turn()
    victim.take(hand.spdp())
    assert len(victim.participant.spdp.remotes) == 2


def test_a_flood_of_endpoints_stops_at_the_bound() -> None:
    victim = Victim(limits=Limits(endpoints=20))
    reader = victim.participant.create_reader("t", "T", RELIABLE, 0.0)
    victim.take(hand.spdp())
    for number in range(1, 301):
        said = hand.endpoint(PREFIX + number.to_bytes(3, "big") + b"\3")
        victim.take(hand.message(hand.data(PUBLICATIONS_WRITER, number, said)))
        if number == 1:
            victim.take(hand.message(hand.heartbeat(PUBLICATIONS_WRITER, 1, 1, 1)))
    assert len(victim.participant.endpoints) == len(reader.proxies) == 20
    assert victim.counters == {"endpoints-full": 280}


def test_samples_that_come_too_early_are_held_to_the_bound() -> None:
    victim, reader = met(limits=Limits(held_samples=10, held_bytes=1000))
    for sequence in range(2, 40):
        victim.take(hand.message(hand.data(WRITER, sequence, BODY)))
    proxy = reader.proxies[PREFIX + WRITER]
    assert len(proxy.held) == 10
    assert victim.counters == {"held-samples-full": 28}
    victim.take(hand.message(hand.data(WRITER, 1, BODY)))
    assert [number for number, _ in victim.samples()] == list(range(1, 12))
    victim.take(hand.message(hand.data(WRITER, 13, b"\0\1\0\0" + bytes(2000))))
    assert proxy.held_bytes == 0


def test_samples_of_no_octets_that_come_too_early_are_held_and_forgotten() -> None:
    victim, reader = met()
    for sequence in (3, 4, 5):
        victim.take(hand.message(hand.data(WRITER, sequence, b"", flags=0)))
    assert len(reader.proxies[PREFIX + WRITER].held) == 3
    victim.take(hand.departure())
    assert reader.proxies == {}
    assert victim.counters == {}


def test_events_that_nobody_takes_stop_at_the_bound() -> None:
    victim, _ = met(limits=Limits(events=5))
    for sequence in range(1, 30):
        victim.participant.receive_datagram(hand.message(hand.data(WRITER, sequence, BODY)), SOURCE, 0.0)
    assert len(victim.participant.take_events()) == 5
    assert victim.counters == {"events-full": 24}


def test_one_datagram_of_requests_is_answered_once() -> None:
    victim, writer = offered()
    for _ in range(10):
        writer.write(b"\0\1\0\0" + bytes(1000), 0.0)
    victim.now += 1.0
    victim.turn()
    everything = hand.number_set(1, 256, (0xFFFFFFFF,) * 8)
    requests = [hand.acknack(READER, writer.entity_id, everything, count) for count in range(1, 900)]
    datagram = hand.message(*requests)
    victim.participant.receive_datagram(datagram, SOURCE, victim.now)
    sent = sum([len(one) for one, _ in victim.turn()])
    # Ten samples once, and a heartbeat for each request.
    assert sent <= 2 * len(datagram) + 11000


def test_an_index_of_readers_that_never_were_is_not_kept() -> None:
    victim, writer = offered()
    for number in range(1000):
        reader = number.to_bytes(3, "big") + b"\4"
        if reader != READER:
            none = hand.number_set(1, 0, ())
            victim.take(hand.message(hand.acknack(reader, writer.entity_id, none, 1)))
            victim.take(hand.message(hand.acknack(reader, PUBLICATIONS_WRITER, none, 1, ">")))
    assert list(writer.proxies) == [PREFIX + READER]
    assert victim.counters["acknack-of-unmatched-reader"] == 1998


def test_acknowledgements_for_anyone_are_for_nobody() -> None:
    victim, writer = offered()
    writer.write(BODY, 0.0)
    victim.take(hand.message(hand.acknack(ANYONE, writer.entity_id, hand.number_set(2, 0, ()), 1)))
    assert not writer.acknowledged(1)
    victim.take(hand.message(hand.heartbeat(PUBLICATIONS_WRITER, 1, 0, 1, PUBLICATIONS_READER)))
    assert victim.counters == {"acknack-of-unmatched-reader": 1}


# -- spoofed sources: RTPS has no authentication. These say what another address cannot do; docs/ros2-scaling.md what it can.

ELSEWHERE = ("10.0.0.66", 7410)


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
