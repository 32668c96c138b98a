"""What we send, roscpp understands: messages, our services, parameters that we set; on both masters."""

from __future__ import annotations

import pytest

from interop import exchange
from interop.cases import CASES, Case
from interop.ros1 import Peer
from roslet import Node


@pytest.mark.parametrize("case", CASES, ids=str)
def test_every_message_arrives_whole_and_in_order(node: Node, roscpp: Peer, case: Case, topic: str) -> None:
    exchange.send(node, roscpp, case, topic)


def test_a_subscriber_of_another_type_is_refused(node: Node, roscpp: Peer, topic: str) -> None:
    exchange.mismatch_to_peer(node, roscpp, topic)


def test_a_latched_message_reaches_a_late_subscriber(node: Node, roscpp: Peer, topic: str) -> None:
    exchange.latched_to_peer(node, roscpp, topic)


@pytest.mark.parametrize("size", [10, 1400, 20_000])
def test_messages_arrive_over_udpros(node: Node, roscpp: Peer, topic: str, size: int) -> None:
    exchange.datagrams_to_peer(node, roscpp, topic, size)


@pytest.mark.parametrize("persistent", [False, True], ids=["one call a connection", "persistent"])
def test_it_calls_our_service(node: Node, roscpp: Peer, topic: str, persistent: bool) -> None:
    exchange.calls_to_us(node, roscpp, topic, persistent)


def test_it_reads_the_parameters_we_set(node: Node, roscpp: Peer, topic: str) -> None:
    exchange.parameters_to_peer(node, roscpp, topic)
