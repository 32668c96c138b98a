"""QoS that is enforced: resource limits, blocking, instances, DEADLINE, LIFESPAN, LIVELINESS; and the bounds for peers."""

# ruff: noqa: B023 - every lambda here is called before its loop goes on

import pytest

from engine.rtps.network import LATCHED, RELIABLE, Network, body, leased, matched, numbers, pair
from roslet.engine.rtps import events
from roslet.engine.rtps.history import HistoryFull
from roslet.engine.rtps.instances import ALIVE, NOT_ALIVE_DISPOSED, NOT_ALIVE_NO_WRITERS, STATES
from roslet.engine.rtps.limits import Limits
from roslet.wire.rtps import header, inline_qos, qos
from roslet.wire.rtps.data import FLAG_D, Data
from roslet.wire.rtps.data_frag import DataFrag

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython

KEEP_ALL = RELIABLE.replace(history=(qos.KEEP_ALL, 1))
SECOND = 1000000000


def key(number: int) -> bytes:
    return bytes(15) + bytes([number])


def keyed(network: "Any", offered: "Any" = RELIABLE, requested: "Any" = RELIABLE) -> "Any":
    one, other = network.host(), network.host()
    writer = one.participant.create_writer("t", "T", offered, 0.0, keyed=True)
    reader = other.participant.create_reader("t", "T", requested, 0.0, keyed=True)
    assert matched(network, writer, reader)
    network.run(1)
    return one, other, writer, reader


def put(writer: "Any", network: "Any", instance: int, number: int = 0) -> None:
    said = inline_qos.InlineQos(key(instance)).emit()
    writer.write(body(number), network.now, None, said, key(instance))


def changes(host: "Any") -> "Any":
    return [(one.key[15], STATES[one.state]) for one in host.of(events.InstanceChanged)]


def test_instances_live_are_disposed_and_live_again() -> None:
    network = Network()
    _, other, writer, reader = keyed(network)
    put(writer, network, 1)
    put(writer, network, 2)
    put(writer, network, 1)
    network.run(0.1)
    assert changes(other) == [(1, "ALIVE"), (2, "ALIVE")]
    writer.dispose(key(1), network.now)
    writer.unregister(key(2), network.now)
    network.run(0.1)
    assert changes(other)[2:] == [(1, "NOT_ALIVE_DISPOSED"), (2, "NOT_ALIVE_NO_WRITERS")]
    put(writer, network, 1)
    network.run(0.1)
    assert changes(other)[4:] == [(1, "ALIVE")]
    # The end of an instance is handed over too, without FLAG_D.
    flags = [bool(one.flags & FLAG_D) for one in other.of(events.SampleReceived)]
    assert flags == [True, True, True, False, False, True]
    assert (ALIVE, NOT_ALIVE_DISPOSED, NOT_ALIVE_NO_WRITERS) == (1, 2, 4)
    assert len(reader.instances) == 1


def test_an_instance_has_no_writers_when_the_last_one_is_gone() -> None:
    network = Network()
    one, other, writer, reader = keyed(network)
    third = network.host()
    second = third.participant.create_writer("t", "T", RELIABLE, network.now, keyed=True)
    assert network.run(5, lambda: len(reader.proxies) == 2 and bool(second.proxies))
    put(writer, network, 1)
    put(second, network, 1)
    put(second, network, 2)
    network.run(0.1)
    one.participant.delete_writer(writer, network.now)
    network.run(0.1)
    assert changes(other) == [(1, "ALIVE"), (2, "ALIVE")]
    third.participant.close(network.now)
    network.run(0.1)
    assert sorted(changes(other)[2:]) == [(1, "NOT_ALIVE_NO_WRITERS"), (2, "NOT_ALIVE_NO_WRITERS")]
    assert len(reader.instances) == 0


def test_a_reader_takes_no_more_instances_than_its_limit_until_one_ends() -> None:
    for limits, policies in (
        (Limits(instances=2), KEEP_ALL),
        (Limits(), KEEP_ALL.replace(resource_limits=(-1, 2, -1))),
    ):
        network = Network()
        one, other = network.host(), network.host(limits=limits)
        writer = one.participant.create_writer("t", "T", KEEP_ALL, 0.0, keyed=True)
        reader: Any = other.participant.create_reader("t", "T", policies, 0.0, keyed=True)
        assert matched(network, writer, reader)
        network.run(1)
        for instance in (1, 2, 3):
            put(writer, network, instance, instance)
        network.run(1)
        assert numbers(other) == [1, 2]
        assert other.of(events.SampleRejected)[0] == events.SampleRejected(
            reader.entity_id, writer.data.guid, key(3)
        )
        assert other.participant.counters["instances-full"] > 0
        assert not writer.acknowledged(3)
        # The end of an instance makes room, once it gets through to the reader.
        reader.instances.note(key(1), inline_qos.STATUS_DISPOSED, writer.data.guid, network.now)
        assert network.run(5, lambda: writer.acknowledged(3))
        assert numbers(other) == [1, 2, 3]


def test_a_writer_has_no_more_samples_and_instances_than_its_limits() -> None:
    cases = [
        ((3, -1, -1), [1, 2, 3], 4),
        ((-1, 2, -1), [1, 2, 1], 3),
        ((-1, -1, 2), [1, 1, 2], 1),
    ]
    for limits, fits, too_much in cases:
        network = Network()
        _, other, writer, _ = keyed(network, KEEP_ALL.replace(resource_limits=limits), KEEP_ALL)
        for instance in fits:
            assert not writer.full(100, key(instance))
            put(writer, network, instance)
        assert writer.full(100, key(too_much))
        with pytest.raises(HistoryFull):
            put(writer, network, too_much)
        assert writer.last == len(fits)
        network.run(1)
        put(writer, network, too_much)
        network.run(1)
        assert len(other.of(events.SampleReceived)) == 4


def test_keep_last_holds_no_more_samples_than_the_limit() -> None:
    network = Network()
    host = network.host()
    policies = LATCHED.replace(history=(qos.KEEP_LAST, 5), resource_limits=(4, 2, 3))
    writer = host.participant.create_writer("t", "T", policies, 0.0, keyed=True)
    for _ in range(5):
        put(writer, network, 1)
    assert writer.history.numbers() == [3, 4, 5]
    for _ in range(3):
        put(writer, network, 2)
    assert writer.history.numbers() == [5, 6, 7, 8]
    with pytest.raises(HistoryFull):
        put(writer, network, 3)


def test_a_full_writer_tells_when_there_is_room() -> None:
    for how in ("asked", "raised"):
        network = Network()
        one, other, writer, reader = pair(network, KEEP_ALL.replace(resource_limits=(5, -1, -1)), RELIABLE)
        assert matched(network, writer, reader)
        for number in range(5):
            writer.write(body(number), network.now)
        if how == "asked":
            assert writer.full(12)
        else:
            with pytest.raises(HistoryFull):
                writer.write(body(9), network.now)
        assert one.of(events.WriterReady) == []
        assert network.run(1, lambda: bool(one.of(events.WriterReady)))
        assert not writer.full(12)
        network.run(1)
        assert one.of(events.WriterReady) == [events.WriterReady(writer.entity_id)]
        assert numbers(other) == list(range(5))


def test_a_keep_all_writer_holds_no_more_octets_than_its_limit() -> None:
    network = Network()
    one, other = network.host(limits=Limits(backlog_bytes=100000)), network.host()
    writer = one.participant.create_writer("t", "T", KEEP_ALL, 0.0)
    reader = other.participant.create_reader("t", "T", KEEP_ALL, 0.0)
    assert matched(network, writer, reader)
    writer.write(body(0, 60000), network.now)
    assert writer.full(60000)
    assert not writer.full(40000)
    assert network.run(1, lambda: not writer.full(60000))


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


def test_deadlines_are_those_of_instances() -> None:
    network = Network()
    policies = RELIABLE.replace(deadline=SECOND // 2)
    one, other, writer, reader = keyed(network, policies, policies)
    for number in range(10):
        put(writer, network, 1)
        if number < 4:
            put(writer, network, 2)
        network.run(0.2)
    for host, local in ((one, writer), (other, reader)):
        missed = host.of(events.DeadlineMissed)
        assert {event.key for event in missed} == {key(2)}
        assert 2 <= len(missed) <= 3
        assert missed[0] == events.DeadlineMissed(local.entity_id, key(2))
    writer.dispose(key(2), network.now)
    writer.dispose(key(1), network.now)
    network.run(0.1)
    before = len(one.of(events.DeadlineMissed)), len(other.of(events.DeadlineMissed))
    network.run(3)
    assert (len(one.of(events.DeadlineMissed)), len(other.of(events.DeadlineMissed))) == before


def test_a_sample_that_comes_after_its_lifespan_is_not_delivered() -> None:
    network = Network()
    _, other, writer, reader = pair(network, RELIABLE.replace(lifespan=SECOND), RELIABLE)
    assert matched(network, writer, reader)
    network.run(5)
    writer.write(body(1), network.now, time=int((network.now - 2) * SECOND))
    writer.write(body(2), network.now, time=int((network.now - 0.5) * SECOND))
    network.run(1)
    assert numbers(other) == [2]
    assert other.participant.counters == {"sample-expired": 1}
    assert writer.acknowledged(2)


def test_our_own_writer_that_does_not_assert_itself_is_told_to_us() -> None:
    for kind in (qos.MANUAL_BY_PARTICIPANT, qos.MANUAL_BY_TOPIC):
        network = Network()
        one, _, writer, reader = pair(network, leased(kind, 1.0), leased(kind, 1.0))
        assert matched(network, writer, reader)
        network.run(0.7)
        writer.write(body(1), network.now)
        network.run(0.9)
        assert one.of(events.LivelinessLost) == []
        network.run(0.2)
        assert one.of(events.LivelinessLost) == [events.LivelinessLost(writer.entity_id, writer.data.guid)]
        if kind == qos.MANUAL_BY_TOPIC:
            writer.assert_liveliness(network.now)
        else:
            one.participant.assert_liveliness(network.now)
        network.run(0.1)
        assert len(one.of(events.LivelinessRegained)) == 1


def test_one_manual_writer_of_a_participant_that_writes_keeps_the_others_alive() -> None:
    network = Network()
    policies = leased(qos.MANUAL_BY_PARTICIPANT, 1.0)
    one, other, writer, reader = pair(network, policies, policies)
    silent = one.participant.create_writer("u", "T", policies, 0.0)
    watched = other.participant.create_reader("u", "T", policies, 0.0)
    assert matched(network, writer, reader)
    assert network.run(5, lambda: bool(silent.proxies and watched.proxies))
    for number in range(10):
        writer.write(body(number), network.now)
        network.run(0.4)
    assert one.of(events.LivelinessLost) == other.of(events.LivelinessLost) == []
    network.run(2)
    assert len(other.of(events.LivelinessLost)) == 2


def hostile(limits: "Any") -> "Any":
    """A victim with one reader, matched with a good writer and five of a peer that is none."""
    network = Network()
    victim, good, bad = network.host(limits=limits), network.host(), network.host()
    reader = victim.participant.create_reader("t", "T", KEEP_ALL, 0.0)
    writer = good.participant.create_writer("t", "T", KEEP_ALL, 0.0)
    others = [bad.participant.create_writer("t", "T", KEEP_ALL, 0.0) for _ in range(5)]
    assert network.run(5, lambda: len(reader.proxies) == 6 and bool(writer.proxies))
    network.run(1)
    front = header.own(bad.participant.guid_prefix)
    network.remove(bad)
    return network, victim, reader, writer, others, front


def test_no_peer_takes_all_of_the_room_for_fragments() -> None:
    limits = Limits(assembly_bytes=300000, peer_bytes=100000)
    network, victim, reader, writer, others, front = hostile(limits)
    for one in others:
        for sequence in range(1, 9):
            piece = DataFrag(reader.entity_id, one.entity_id, sequence, 1, 1, 1000, 60000, bytes(1000))
            victim.participant.receive_datagram(front + piece.emit(), ("10.0.0.9", 1), network.now)
    assert (
        victim.participant._common.assembling.left == 239940
    )  # a sample, and an octet for each of its fragments
    assert victim.participant.counters["assembly-bytes-full"] == 39
    writer.write(body(7, 90000), network.now)
    assert network.run(5, lambda: writer.acknowledged(1))
    assert numbers(victim) == [7]
    assert network.run(30, lambda: len(reader.proxies) == 1)
    assert victim.participant._common.assembling.left == 300000


def test_no_peer_takes_all_of_the_room_for_samples_that_came_too_early() -> None:
    limits = Limits(all_held_bytes=300000, peer_bytes=100000)
    network, victim, reader, writer, others, front = hostile(limits)
    for one in others:
        for sequence in range(2, 12):
            early = Data(reader.entity_id, one.entity_id, sequence, bytes(9000)).emit()
            victim.participant.receive_datagram(front + early, ("10.0.0.9", 1), network.now)
    assert victim.participant._common.holding.left == 300000 - 99000
    assert victim.participant.counters["held-bytes-full"] == 39
    network.loss = 0.3
    for number in range(30):
        writer.write(body(number, 2000), network.now)
    assert network.run(10, lambda: writer.acknowledged(30))
    assert numbers(victim) == list(range(30))
    network.loss = 0.0
    assert network.run(40, lambda: len(reader.proxies) == 1)
    assert victim.participant._common.holding.left == 300000


def test_a_participant_has_no_more_endpoints_than_the_limit() -> None:
    network = Network()
    victim = network.host(limits=Limits(endpoints=5))
    one, other = network.host(), network.host()
    for number in range(9):
        one.participant.create_writer("t%d" % number, "T", RELIABLE, 0.0)
    network.run(1)
    other.participant.create_writer("u", "T", RELIABLE, network.now)
    network.run(1)
    assert len(victim.participant.endpoints) == 6
    assert victim.participant.counters == {"endpoints-full": 4}


def test_endpoints_that_have_nothing_to_do_are_not_looked_at() -> None:
    network = Network()
    one, other = network.host(), network.host()
    for number in range(40):
        one.participant.create_writer("t%d" % number, "T", RELIABLE, 0.0)
        other.participant.create_reader("t%d" % number, "T", RELIABLE, 0.0)
    assert network.run(5, lambda: len(other.of(events.EndpointMatched)) == 40)
    network.run(2)
    for host in (one, other):
        # The next announcement, and the end of the other's lease.
        assert host.participant._schedule.live == 2
    writer = next(iter(one.participant.writers.values()))
    writer.write(body(1), network.now)
    network.run(0.001)
    assert one.participant._schedule.live == 3
