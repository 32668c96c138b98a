"""Which endpoints go together, and what each end is told of it."""

import pytest

from engine.rtps.network import Host, Network
from engine.rtps.test_participants import BEST_EFFORT, RELIABLE, pair
from roslet.engine.rtps import events
from roslet.wire.rtps import locator, qos
from roslet.wire.rtps.data import Data
from roslet.wire.rtps.guid import ENTITYID_UNKNOWN
from roslet.wire.rtps.heartbeat import Heartbeat

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


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
