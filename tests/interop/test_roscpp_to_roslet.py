"""What roscpp sends, we understand: messages, its services, the parameters that it sets; on both masters."""

from __future__ import annotations

import pytest

from interop import exchange
from interop.cases import CASES, Case
from interop.ros1 import Peer
from roslet import Node


@pytest.mark.parametrize("case", CASES, ids=str)
def test_every_message_arrives_whole_and_in_order(node: Node, roscpp: Peer, case: Case, topic: str) -> None:
    exchange.receive(node, roscpp, case, topic)


def test_a_subscription_of_any_type_gets_the_bytes(node: Node, roscpp: Peer, topic: str) -> None:
    exchange.raw_to_us(node, roscpp, topic)


def test_a_publisher_of_another_type_is_refused(node: Node, roscpp: Peer, topic: str) -> None:
    exchange.mismatch_to_us(node, roscpp, topic)


def test_a_latched_message_reaches_a_late_subscriber(node: Node, roscpp: Peer, topic: str) -> None:
    exchange.latched_to_us(node, roscpp, topic)


def test_header_numbers_are_consecutive(node: Node, roscpp: Peer, topic: str) -> None:
    exchange.sequence_to_us(node, roscpp, topic)


def test_a_publisher_that_returns_is_found_again(node: Node, roscpp: Peer, topic: str) -> None:
    exchange.peer_returns(node, roscpp, topic)


@pytest.mark.parametrize("size", [10, 1400, 20_000])
def test_messages_arrive_over_udpros(node: Node, roscpp: Peer, topic: str, size: int) -> None:
    exchange.datagrams_to_us(node, roscpp, topic, size)


@pytest.mark.parametrize("persistent", [False, True], ids=["one call a connection", "persistent"])
def test_we_call_its_service(node: Node, roscpp: Peer, topic: str, persistent: bool) -> None:
    exchange.calls_from_us(node, roscpp, topic, persistent)


def test_we_read_the_parameters_it_sets(node: Node, roscpp: Peer, topic: str) -> None:
    exchange.parameters_to_us(node, roscpp, topic)
