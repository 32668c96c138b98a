"""Participants meet, and part, in virtual time."""

# ruff: noqa: B023 - every lambda here is called before its loop goes on

import pytest

from engine.rtps.network import LATCHED, RELIABLE, Network, body, matched, numbers, pair
from roslet.engine.rtps import events
from roslet.wire.rtps import qos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


def test_two_participants_find_each_other_and_their_endpoints() -> None:
    network = Network()
    one, other, writer, reader = pair(network, RELIABLE, RELIABLE)
    assert matched(network, writer, reader)
    assert network.now < 0.2
    network.run(0.5)
    for host in (one, other):
        assert len(host.of(events.ParticipantDiscovered)) == 1
        assert len(host.of(events.EndpointDiscovered)) == 1
        assert len(host.of(events.EndpointMatched)) == 1
        assert host.participant.counters == {}


def test_a_departure_is_known_at_once_and_a_silent_end_by_its_lease() -> None:
    for polite in (True, False):
        network = Network()
        one, other, writer, reader = pair(network, RELIABLE, RELIABLE)
        assert matched(network, writer, reader)
        network.run(5)
        if polite:
            other.participant.close(network.now)
        network.remove(other)
        begin = network.now
        assert network.run(60, lambda: bool(one.of(events.ParticipantLost)))
        assert (network.now - begin < 0.1) == polite
        assert network.now - begin < 21
        (lost,) = one.of(events.ParticipantLost)
        assert lost.expired != polite
        assert len(one.of(events.EndpointUnmatched)) == len(one.of(events.EndpointLost)) == 1
        assert writer.proxies == {}
        assert one.participant.spdp.remotes == {}
        assert one.participant.endpoints == {}
        assert one.participant._by_writer == {}


def test_many_participants_all_meet() -> None:
    network = Network(1, 0.05)
    hosts = [network.host() for _ in range(12)]
    writers = [host.participant.create_writer("t", "T", RELIABLE, 0.0) for host in hosts]
    readers = [host.participant.create_reader("t", "T", RELIABLE, 0.0) for host in hosts]
    assert network.run(20, lambda: all(len(one.proxies) == 12 for one in writers + readers))
    for number, writer in enumerate(writers):
        writer.write(body(number), network.now)
    assert network.run(20, lambda: all(writer.acknowledged(1) for writer in writers))
    for number, host in enumerate(hosts):
        assert sorted(numbers(host)) == list(range(12)), number


def test_a_newcomer_is_greeted_until_it_shows_that_it_knows_us() -> None:
    network = Network()
    network.keep = True
    one = network.host()
    network.run(2.0)
    newcomer = network.host()

    def greetings() -> int:
        """Announcements of the first that go to the newcomer alone."""
        own, theirs = one.participant.guid_prefix, newcomer.participant.guid_prefix
        mine = [seen for seen in network.seen if seen[8:20] == own and b"\x00\x01\x00\xc2" in seen]
        network.seen = []
        return len([seen for seen in mine if theirs in seen[20:]])

    for _ in range(3):
        # It is announced, and hears nothing.
        participant = newcomer.participant
        participant.spdp.change(participant.spdp.own, network.now)
        participant.handle_deadline(network.now)
        for parts, _ in participant.datagrams_to_send(network.now):
            one.participant.receive_datagram(b"".join(parts), (newcomer.address, 7410), network.now)
        network.loss = 1.0
        network.run(0.05)
        assert greetings() == 1
    network.loss = 0.0
    network.run(1.0)
    assert newcomer.participant.spdp.remotes
    greetings()
    network.run(10.0)
    assert greetings() == 0


def test_another_domain_is_not_seen() -> None:
    network = Network()
    one, other = network.host(), network.host()
    elsewhere: Any = other.participant.spdp.own.replace(domain_id=1)
    other.participant.spdp.change(elsewhere, 0.0)
    network.run(5)
    assert one.participant.spdp.remotes == {}
    assert one.participant.counters["participant-of-another-domain"] > 0


def test_random_datagrams_raise_nothing_and_are_counted() -> None:
    network = Network()
    network.keep = True
    one, _, writer, reader = pair(network, RELIABLE, LATCHED.replace(durability=qos.VOLATILE))
    assert matched(network, writer, reader)
    for number in range(20):
        writer.write(body(number, 40), network.now)
    network.run(1)
    victim = network.host(fragment_size=500)
    victim.participant.create_reader("t", "T", RELIABLE, network.now)
    network.run(1)
    state = 12345
    for datagram in network.seen[:150]:
        for _ in range(4):
            broken = bytearray(datagram)
            for _ in range(3):
                state = (state * 1664525 + 1013904223) % (1 << 32)
                broken[20 + (state >> 8) % (len(broken) - 20)] = state & 255
            victim.participant.receive_datagram(broken, ("10.0.0.9", 7410), network.now)
            victim.participant.receive_datagram(
                broken[: (state >> 4) % len(broken)], ("10.0.0.9", 7410), network.now
            )
    assert sum(victim.participant.counters.values()) > 50
    assert one.participant.guid_prefix in victim.participant.spdp.remotes


def test_a_peer_that_comes_back_a_hundred_times_leaves_nothing_behind() -> None:
    network = Network(6)
    one = network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    for turn in range(100):
        other = network.host(lease=1.0)
        # The same place, another GUID: as a process that was killed and started again.
        reader = other.participant.create_reader("t", "T", RELIABLE, network.now)
        assert network.run(5, lambda: bool(reader.proxies and reader.data.guid in writer.proxies))
        writer.write(body(turn), network.now)
        assert network.run(5, lambda: bool(numbers(other)))
        assert numbers(other) == [turn]
        network.remove(other)
    network.run(3)
    participant = one.participant
    left: Any = (participant.spdp.remotes, participant.endpoints, participant._by_writer, writer.proxies)
    assert left == ({}, {}, {}, {})
    assert len(writer.history) == 0
    for builtin in participant.sedp.writers.values():
        assert builtin.proxies == {}
