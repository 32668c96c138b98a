"""Samples arrive once and in order, or are told lost, over networks that lose, double and reorder."""

# ruff: noqa: B023 - every lambda here is called before its loop goes on

import pytest

from engine.rtps.network import BEST_EFFORT, LATCHED, RELIABLE, Network, body, matched, numbers, pair
from roslet.engine.rtps import events
from roslet.engine.rtps.history import HistoryFull
from roslet.wire.rtps import qos
from roslet.wire.rtps.data import Data
from roslet.wire.rtps.guid import ENTITYID_UNKNOWN
from roslet.wire.rtps.heartbeat import Heartbeat

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


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
    assert other.participant._common.assembling.left == other.participant.limits.assembly_bytes


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


def test_a_reader_may_be_deleted_by_its_sink_while_samples_wait_for_an_earlier_one() -> None:
    network = Network()
    one, other = network.host(), network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    found: list[int] = []

    def sink(proxy: "Any", value: "Any", time: "int | None") -> None:
        found.append(value.sequence)
        other.participant.delete_reader(reader, network.now)

    reader = other.participant.create_reader("t", "T", RELIABLE, 0.0, sink=sink)
    assert network.run(5, lambda: bool(writer.proxies and reader.proxies))
    network.run(0.5)
    (proxy,) = reader.proxies.values()
    for sequence in (2, 3):
        value = Data(ENTITYID_UNKNOWN, writer.entity_id, sequence, b"\0\1\0\0")
        reader.handle_data(proxy, value, None, network.now)
    reader.handle_heartbeat(proxy, Heartbeat(ENTITYID_UNKNOWN, writer.entity_id, 4, 4, 99), network.now)
    assert found == [2]
    assert other.of(events.SamplesLost) == []
    assert other.participant._common.holding.left == other.participant.limits.all_held_bytes


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
