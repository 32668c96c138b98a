"""Which endpoints go together, and what each end is told of it."""

import pytest

from engine.rtps.network import BEST_EFFORT, LATCHED, RELIABLE, Host, Network, body, matched, numbers, pair
from roslet.engine.rtps import events
from roslet.wire.rtps import locator, qos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


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


def test_an_endpoint_may_have_a_locator_of_its_own() -> None:
    network = Network()
    one, other = network.host(), network.host()
    writer = one.participant.create_writer("t", "T", RELIABLE, 0.0)
    place = locator.udp4(other.address, 9999)
    reader = other.participant.create_reader("t", "T", RELIABLE, 0.0, unicast=(place,))
    assert matched(network, writer, reader)
    assert writer.proxies[reader.data.guid].addresses == ((other.address, 9999),)
    assert writer.proxies[reader.data.guid].data.unicast == (place,)


def told(host: Host) -> "list[tuple[str, ...]]":
    return [one.policies for one in host.of(events.QosIncompatible)]


def apart() -> "tuple[Network, Host, Host, Any]":
    """A best-effort writer and a reader that wants reliability, each told once that they do not match."""
    network = Network()
    one, other, writer, _ = pair(network, BEST_EFFORT, RELIABLE)
    network.run(1)
    assert told(one) == told(other) == [("reliability",)]
    return network, one, other, writer


def test_what_does_not_match_is_not_told_again_where_the_peer_moves() -> None:
    network, one, other, _ = apart()
    own = other.participant.spdp.own.replace(default_unicast=(locator.udp4(other.address, 7999),))
    other.participant.move(own, (("239.255.0.1", 7400),), (), network.now)
    network.run(1)
    assert len(one.of(events.ParticipantDiscovered)) == 2
    assert told(one) == told(other) == [("reliability",)]


def test_what_does_not_match_is_not_told_again_where_we_move() -> None:
    network = Network()
    host = network.host()
    host.participant.create_writer("t", "T", BEST_EFFORT, 0.0)
    host.participant.create_reader("t", "T", RELIABLE, 0.0)
    network.run(1)
    before = told(host)
    host.participant.move(host.participant.spdp.own, (("239.255.0.1", 7400),), (), network.now)
    network.run(1)
    assert told(host) == before == [("reliability",)] * 2


def test_what_does_not_match_is_told_again_only_where_it_is_for_another_reason() -> None:
    network, one, other, writer = apart()
    announce = one.participant.sedp.announce
    announce(writer.data.replace(qos=writer.qos.replace(user_data=b"x")), network.now)
    network.run(1)
    assert len(other.of(events.EndpointDiscovered)) == 2
    assert told(other) == [("reliability",)]
    announce(writer.data.replace(qos=writer.qos.replace(ownership=qos.EXCLUSIVE)), network.now)
    network.run(1)
    assert told(other) == [("reliability",), ("reliability", "ownership")]


def test_endpoints_of_no_interest_are_not_kept_and_found_again_when_they_are() -> None:
    network = Network()
    one, other = network.host(), network.host()
    wanted: list[str] = ["t"]
    one.participant.keep_only(lambda found: found.topic in wanted)
    reader = one.participant.create_reader("t", "T", RELIABLE, network.now)
    kept = other.participant.create_writer("t", "T", RELIABLE, network.now)
    late = other.participant.create_writer("late", "T", RELIABLE, network.now)
    assert matched(network, kept, reader)
    network.run(2)
    assert [found.topic for found in one.participant.endpoints.values()] == ["t"]
    assert one.participant.counters["endpoint-not-kept"] >= 1
    wanted.append("late")
    found = one.participant.create_reader("late", "T", RELIABLE, network.now)
    one.participant.spdp.relearn(network.now)
    assert matched(network, late, found)
    assert network.run(30, lambda: bool(reader.proxies))
    late.write(body(1), network.now)
    kept.write(body(2), network.now)
    network.run(2)
    assert sorted(numbers(one)) == [1, 2]
