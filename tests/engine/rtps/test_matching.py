"""Which endpoints go together, and what each end is told of it."""

import pytest

from engine.rtps.network import Host, Network
from engine.rtps.test_participants import BEST_EFFORT, RELIABLE, pair
from roslet.engine.rtps import events
from roslet.wire.rtps import locator, qos

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
