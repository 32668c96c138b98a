"""Too much of anything stops at its bound, is counted, and is not answered again and again."""

import pytest

from engine.rtps import hand
from engine.rtps.hand import ANYONE, PREFIX, PUBLICATIONS_READER, PUBLICATIONS_WRITER, READER, SOURCE, WRITER
from engine.rtps.victim import BODY, RELIABLE, Victim, met, offered
from roslet.engine.rtps.limits import Limits

pytestmark = pytest.mark.micropython


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


def test_no_more_is_asked_for_at_once_than_can_be_held() -> None:
    victim, _ = met(limits=Limits(held_samples=10))
    victim.now = 1.0
    victim.participant.receive_datagram(hand.message(hand.heartbeat(WRITER, 1, 1000, 2)), SOURCE, victim.now)
    asked = b"".join([datagram for datagram, _ in victim.turn()])
    assert hand.number_set(1, 10, (0xFFC00000,)) in asked


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
