"""Participants meet and exchange samples, in virtual time, over networks that lose, double and reorder."""

# ruff: noqa: B023 - every lambda here is called before its loop goes on

import pytest

from engine.rtps.network import Host, Network
from roslet.engine.rtps import events
from roslet.engine.rtps.history import HistoryFull
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps.qos import Qos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython

BLOCKING = 100000000
RELIABLE = Qos((qos.RELIABLE, BLOCKING), history=(qos.KEEP_LAST, 1000))
LATCHED = Qos((qos.RELIABLE, BLOCKING), qos.TRANSIENT_LOCAL, (qos.KEEP_LAST, 5))
BEST_EFFORT = Qos((qos.BEST_EFFORT, BLOCKING), history=(qos.KEEP_LAST, 10))


def body(number: int, size: int = 12) -> bytes:
    return b"\0\1\0\0" + number.to_bytes(4, "little") + bytes([number & 255]) * (size - 8)


def numbers(host: Host) -> "list[int]":
    return [int.from_bytes(one.payload[4:8], "little") for one in host.of(events.SampleReceived)]


def pair(network: Network, offered: "Any", requested: "Any") -> "Any":
    one, other = network.host(), network.host()
    writer = one.participant.create_writer("t", "T", offered, network.now)
    reader = other.participant.create_reader("t", "T", requested, network.now)
    return one, other, writer, reader


def matched(network: Network, writer: "Any", reader: "Any") -> bool:
    return network.run(30, lambda: bool(writer.proxies and reader.proxies))


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


def test_samples_arrive_once_and_in_order() -> None:
    network = Network()
    _, other, writer, reader = pair(network, RELIABLE, RELIABLE)
    assert matched(network, writer, reader)
    for number in range(100):
        writer.write(body(number), network.now)
    network.run(1)
    assert numbers(other) == list(range(100))
    assert writer.acknowledged(100)
    assert len(writer.history) == 0


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize(("loss", "twice", "late"), [(0.1, 0.1, 0.2), (0.3, 0.0, 0.0), (0.3, 0.3, 0.3)])
def test_a_bad_network_loses_nothing_of_a_reliable_topic(
    seed: int, loss: float, twice: float, late: float
) -> None:
    network = Network(seed, loss, twice, late)
    _, other, writer, reader = pair(network, RELIABLE, RELIABLE)
    assert matched(network, writer, reader)
    for number in range(200):
        writer.write(body(number), network.now)
        network.run(0.001)
    assert network.run(60, lambda: writer.acknowledged(200))
    assert numbers(other) == list(range(200))


def test_best_effort_never_goes_backwards() -> None:
    network = Network(5, 0.2, 0.2, 0.3)
    _, other, writer, reader = pair(network, BEST_EFFORT, BEST_EFFORT)
    assert matched(network, writer, reader)
    for number in range(200):
        writer.write(body(number), network.now)
        network.run(0.001)
    network.run(1)
    found = numbers(other)
    assert 80 < len(found) < 190
    assert found == sorted(set(found))
    assert len(writer.history) == 0
    lost = sum([one.count for one in other.of(events.SamplesLost)])
    assert found[-1] - found[0] + 1 == len(found) + lost


def test_a_late_reader_of_a_transient_local_topic_gets_the_last_samples() -> None:
    for loss in (0.0, 0.2):
        network = Network(2, loss)
        one = network.host()
        writer = one.participant.create_writer("t", "T", LATCHED, network.now)
        for number in range(9):
            writer.write(body(number), network.now)
        network.run(1)
        other = network.host()
        reader = other.participant.create_reader("t", "T", LATCHED, network.now)
        assert matched(network, writer, reader)
        assert network.run(30, lambda: writer.acknowledged(9))
        assert numbers(other) == [4, 5, 6, 7, 8]
        assert other.of(events.SamplesLost) == []


def test_a_late_reader_of_a_volatile_topic_starts_with_the_next_sample() -> None:
    for loss in (0.0, 0.2):
        network = Network(4, loss)
        _, early, writer, reader = pair(network, RELIABLE, RELIABLE)
        assert matched(network, writer, reader)
        for number in range(5):
            writer.write(body(number), network.now)
        late = network.host()
        second = late.participant.create_reader("t", "T", RELIABLE, network.now)
        assert network.run(30, lambda: len(writer.proxies) == 2 and bool(second.proxies))
        for number in range(5, 10):
            writer.write(body(number), network.now)
        assert network.run(30, lambda: writer.acknowledged(10))
        assert numbers(early) == list(range(10))
        assert numbers(late) == list(range(5, 10))
        assert late.of(events.SamplesLost) == []


@pytest.mark.parametrize(("loss", "late"), [(0.0, 0.0), (0.2, 0.2)])
def test_large_samples_go_in_fragments(loss: float, late: float) -> None:
    network = Network(3, loss, 0.0, late)
    one, other = network.host(fragment_size=1000), network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    reader = other.participant.create_reader("t", "T", RELIABLE, 0.0)
    assert matched(network, writer, reader)
    sizes = [999, 1000, 1001, 2000, 50000, 400000, 20]
    for number, size in enumerate(sizes):
        writer.write(body(number, size), network.now)
    assert network.run(60, lambda: writer.acknowledged(len(sizes)))
    found = [bytes(event.payload) for event in other.of(events.SampleReceived)]
    assert found == [body(number, size) for number, size in enumerate(sizes)]
    assert other.participant._budget.left == other.participant.limits.assembly_bytes


def test_every_incompatible_policy_is_named_at_both_ends() -> None:
    second = 1000000000
    cases = [
        (BEST_EFFORT, RELIABLE, ("reliability",)),
        (RELIABLE, LATCHED, ("durability",)),
        (RELIABLE.replace(deadline=2 * second), RELIABLE.replace(deadline=second), ("deadline",)),
        (RELIABLE, RELIABLE.replace(liveliness=(qos.AUTOMATIC, second)), ("liveliness",)),
        (RELIABLE, RELIABLE.replace(ownership=qos.EXCLUSIVE), ("ownership",)),
        (RELIABLE, RELIABLE.replace(destination_order=qos.BY_SOURCE_TIMESTAMP), ("destination_order",)),
        (RELIABLE, RELIABLE.replace(presentation=(qos.INSTANCE, False, True)), ("presentation",)),
        (RELIABLE.replace(partition=("a",)), RELIABLE.replace(partition=("b*",)), ("partition",)),
        (RELIABLE.replace(representation=(qos.XCDR2,)), RELIABLE, ("representation",)),
        (BEST_EFFORT, LATCHED, ("reliability", "durability")),
    ]
    for offered, requested, names in cases:
        network = Network()
        one, other, writer, reader = pair(network, offered, requested)
        network.run(1)
        for host, remote in ((one, reader), (other, writer)):
            (event,) = host.of(events.QosIncompatible)
            assert event.policies == names
            assert event.data.guid == remote.data.guid
            assert host.of(events.EndpointMatched) == []


def test_partitions_match_by_pattern() -> None:
    network = Network()
    _, _, writer, reader = pair(
        network, RELIABLE.replace(partition=("ab1",)), RELIABLE.replace(partition=("x", "a*?"))
    )
    assert matched(network, writer, reader)


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


def test_a_deleted_endpoint_unmatches() -> None:
    network = Network(1, 0.2)
    one, other, writer, reader = pair(network, RELIABLE, RELIABLE)
    assert matched(network, writer, reader)
    other.participant.delete_reader(reader, network.now)
    assert network.run(20, lambda: not writer.proxies)
    again = other.participant.create_reader("t", "T", RELIABLE, network.now)
    assert matched(network, writer, again)
    one.participant.delete_writer(writer, network.now)
    assert network.run(20, lambda: not again.proxies)


def test_keep_all_waits_instead_of_losing() -> None:
    network = Network()
    policies = RELIABLE.replace(history=(qos.KEEP_ALL, 1), resource_limits=(10, -1, -1))
    _, other, writer, reader = pair(network, policies, RELIABLE)
    assert matched(network, writer, reader)
    for number in range(10):
        writer.write(body(number), network.now)
    assert writer.full()
    with pytest.raises(HistoryFull):
        writer.write(body(10), network.now)
    assert network.run(5, lambda: not writer.full())
    writer.write(body(10), network.now)
    network.run(1)
    assert numbers(other) == list(range(11))


def test_keep_last_overwrites_and_says_what_was_lost() -> None:
    network = Network()
    _, other, writer, reader = pair(network, RELIABLE.replace(history=(qos.KEEP_LAST, 3)), RELIABLE)
    assert matched(network, writer, reader)
    network.run(1)
    network.loss = 1.0
    for number in range(10):
        writer.write(body(number), network.now)
        network.run(0.0005)
    network.loss = 0.0
    assert network.run(20, lambda: writer.acknowledged(10))
    assert numbers(other) == [7, 8, 9]
    assert sum([one.count for one in other.of(events.SamplesLost)]) == 7


def test_a_partition_that_heals_loses_nothing() -> None:
    network = Network(7, 0.05)
    _, other, writer, reader = pair(network, RELIABLE, RELIABLE)
    assert matched(network, writer, reader)
    network.apart.add(other.address)
    for number in range(50):
        writer.write(body(number), network.now)
        network.run(0.1)
    assert numbers(other) == []
    network.apart.clear()
    assert network.run(20, lambda: writer.acknowledged(50))
    assert numbers(other) == list(range(50))


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


def leased(kind: int, seconds: float) -> "Any":
    return RELIABLE.replace(liveliness=(kind, int(seconds * 1000000000)))


def test_an_automatic_writer_lives_as_long_as_its_participant() -> None:
    network = Network()
    _, other, writer, reader = pair(network, leased(qos.AUTOMATIC, 0.5), leased(qos.AUTOMATIC, 1.0))
    assert matched(network, writer, reader)
    network.run(10)
    assert other.of(events.LivelinessLost) == []
    network.apart.add(other.address)
    network.run(2)
    assert len(other.of(events.LivelinessLost)) == 1
    network.apart.clear()
    network.run(2)
    assert len(other.of(events.LivelinessRegained)) == 1
    assert len(other.of(events.LivelinessLost)) == 1


def test_a_manual_writer_must_say_that_it_lives() -> None:
    for kind in (qos.MANUAL_BY_PARTICIPANT, qos.MANUAL_BY_TOPIC):
        network = Network()
        one, other, writer, reader = pair(network, leased(kind, 1.0), leased(kind, 1.0))
        assert matched(network, writer, reader)
        for number in range(4):
            network.run(0.7)
            if number == 1:
                writer.write(body(1), network.now)
            elif kind == qos.MANUAL_BY_TOPIC:
                writer.assert_liveliness(network.now)
            else:
                one.participant.assert_liveliness(network.now)
        assert other.of(events.LivelinessLost) == []
        network.run(1.5)
        assert len(other.of(events.LivelinessLost)) == 1
        writer.write(body(2), network.now)
        network.run(0.1)
        assert len(other.of(events.LivelinessRegained)) == 1


def test_an_expired_sample_is_not_sent_to_a_late_reader() -> None:
    network = Network()
    one = network.host()
    writer = one.participant.create_writer("t", "T", LATCHED.replace(lifespan=1000000000), network.now)
    writer.write(body(0), network.now)
    network.run(0.7)
    writer.write(body(1), network.now)
    network.run(0.7)
    other = network.host()
    reader = other.participant.create_reader("t", "T", LATCHED, network.now)
    assert matched(network, writer, reader)
    network.run(1)
    assert numbers(other) == [1]
    assert writer.acknowledged(2)


def test_a_missed_deadline_is_told_at_both_ends_each_period() -> None:
    network = Network()
    policies = RELIABLE.replace(deadline=500000000)
    one, other, writer, reader = pair(network, policies, policies)
    assert matched(network, writer, reader)
    network.run(2)
    for number in range(5):
        writer.write(body(number), network.now)
        network.run(0.3)
    assert one.of(events.DeadlineMissed) == other.of(events.DeadlineMissed) == []
    network.run(1.3)
    assert one.of(events.DeadlineMissed) == [events.DeadlineMissed(writer.entity_id)] * 3
    assert other.of(events.DeadlineMissed) == [events.DeadlineMissed(reader.entity_id)] * 3


def test_endpoints_of_one_participant_match_each_other() -> None:
    network = Network(3, 0.2)
    host = network.host()
    participant = host.participant
    writer = participant.create_writer("t", "T", LATCHED, network.now)
    writer.write(body(0), network.now)
    reader = participant.create_reader("t", "T", LATCHED, network.now)
    for number in range(1, 10):
        writer.write(body(number), network.now)
        network.run(0.01)
    assert network.run(20, lambda: writer.acknowledged(10))
    assert numbers(host) == list(range(10))
    assert participant.spdp.remotes == {}
    participant.delete_writer(writer, network.now)
    assert reader.proxies == {}
    assert participant._by_writer == {}
    apart = network.host(match_own=False).participant
    lonely = apart.create_writer("u", "T", RELIABLE, network.now)
    apart.create_reader("u", "T", RELIABLE, network.now)
    network.run(1)
    assert lonely.proxies == {}


def test_two_writers_and_two_readers_share_a_topic() -> None:
    network = Network(9, 0.1, 0.1, 0.1)
    one, other = network.host(), network.host()
    writers = [one.participant.create_writer("t", "T", RELIABLE, 0.0) for _ in range(2)]
    readers = [other.participant.create_reader("t", "T", RELIABLE, 0.0) for _ in range(2)]
    assert network.run(20, lambda: all(len(end.proxies) == 2 for end in writers + readers))
    for number in range(50):
        for writer in writers:
            writer.write(body(number), network.now)
        network.run(0.001)
    assert network.run(20, lambda: all(writer.acknowledged(50) for writer in writers))
    samples = other.of(events.SampleReceived)
    for reader in readers:
        for writer in writers:
            got = [
                one.sequence
                for one in samples
                if (one.local, one.writer) == (reader.entity_id, writer.data.guid)
            ]
            assert got == list(range(1, 51))


def test_sequence_numbers_near_their_limit_work() -> None:
    network = Network(2, 0.2)
    one, other = network.host(), network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    writer.last = 0x7FFFFFFFFFFFFF00
    reader = other.participant.create_reader("t", "T", RELIABLE, 0.0)
    assert matched(network, writer, reader)
    for number in range(50):
        writer.write(body(number), network.now)
    assert network.run(20, lambda: writer.acknowledged(writer.last))
    assert numbers(other) == list(range(50))


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


def test_large_samples_that_were_overwritten_while_they_waited_are_not_sent() -> None:
    for policies in (
        BEST_EFFORT.replace(history=(qos.KEEP_LAST, 2)),
        RELIABLE.replace(history=(qos.KEEP_LAST, 2)),
    ):
        network = Network()
        _, other, writer, reader = pair(network, policies, policies)
        assert matched(network, writer, reader)
        network.run(1)
        before = network.bytes
        for number in range(100):
            writer.write(body(number, 130000), network.now)
        assert network.run(10, lambda: 99 in numbers(other))
        network.run(1)
        assert network.bytes - before < 8 * 130000
        assert not writer._repairs.busy


def test_a_sink_gets_the_samples_in_order_instead_of_events() -> None:
    network = Network(4, 0.2, 0.2, 0.2)
    one, other = network.host(fragment_size=1000), network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    got: Any = []

    def sink(proxy: "Any", value: "Any", time: "int | None") -> None:
        got.append((proxy.guid, value.sequence, bytes(value.payload), time))

    reader = other.participant.create_reader("t", "T", RELIABLE, 0.0, sink=sink)
    assert matched(network, writer, reader)
    sizes = [12, 5000, 12, 12, 1001, 12]
    for number, size in enumerate(sizes):
        writer.write(body(number, size), network.now, time=1000 + number)
    assert network.run(30, lambda: writer.acknowledged(len(sizes)))
    assert got == [
        (writer.data.guid, number + 1, body(number, size), 1000 + number) for number, size in enumerate(sizes)
    ]
    assert other.of(events.SampleReceived) == []


def test_a_sample_for_one_reader_reaches_only_that_one_and_the_others_do_not_wait() -> None:
    for loss in (0.0, 0.3):
        network = Network(8, loss)
        one = network.host(fragment_size=1000)
        writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
        others = [network.host() for _ in range(3)]
        readers = [host.participant.create_reader("t", "T", RELIABLE, 0.0) for host in others]
        assert network.run(30, lambda: len(writer.proxies) == 3 and all(one.proxies for one in readers))
        expected: Any = [[], [], []]
        for number in range(60):
            turn = number % 5
            size = 12 if number % 7 else 3000
            if turn < 3:
                assert writer.write(body(number, size), network.now, to=readers[turn].data.guid) == number + 1
                expected[turn].append(number)
            else:
                writer.write(body(number, size), network.now)
                for one_list in expected:
                    one_list.append(number)
            network.run(0.002)
        begin = network.now
        assert network.run(30, lambda: writer.acknowledged(60))
        assert [numbers(host) for host in others] == expected
        assert loss or network.now - begin < 0.1
        for host in others:
            assert host.of(events.SamplesLost) == []
        assert writer.write(body(0), network.now, to=bytes(16)) == 0
        assert writer.last == 60
        assert one.participant.counters["write-to-unmatched-reader"] == 1


def test_samples_for_one_reader_displace_only_each_other() -> None:
    network = Network()
    one, first, second = network.host(), network.host(), network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE.replace(history=(qos.KEEP_LAST, 1)), 0.0)
    readers = [host.participant.create_reader("t", "T", RELIABLE, 0.0) for host in (first, second)]
    assert network.run(30, lambda: len(writer.proxies) == 2 and all(reader.proxies for reader in readers))
    network.run(1)
    network.loss = 1.0
    writer.write(body(1), network.now, to=readers[0].data.guid)
    writer.write(body(2), network.now, to=readers[1].data.guid)
    network.run(0.01)
    network.loss = 0.0
    assert network.run(10, lambda: writer.acknowledged(2))
    assert (numbers(first), numbers(second)) == ([1], [2])


def test_an_endpoint_may_have_a_locator_of_its_own() -> None:
    network = Network()
    one, other = network.host(), network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    place = locator.udp4(other.address, 9999)
    reader = other.participant.create_reader("t", "T", RELIABLE, 0.0, unicast=(place,))
    assert matched(network, writer, reader)
    assert writer.proxies[reader.data.guid].addresses == ((other.address, 9999),)
    assert writer.proxies[reader.data.guid].data.unicast == (place,)


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
