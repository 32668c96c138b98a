"""What rospy sends, we understand: messages, its services, the parameters that it sets; on both masters."""

from __future__ import annotations

import pytest

from interop import exchange
from interop.cases import CASES, Case
from interop.ros1 import Peer
from roslet import Node


@pytest.mark.parametrize("case", CASES, ids=str)
def test_every_message_arrives_whole_and_in_order(node: Node, rospy: Peer, case: Case, topic: str) -> None:
    exchange.receive(node, rospy, case, topic)


def test_a_subscription_of_any_type_gets_the_bytes(node: Node, rospy: Peer, topic: str) -> None:
    exchange.raw_to_us(node, rospy, topic)


def test_a_publisher_of_another_type_is_refused(node: Node, rospy: Peer, topic: str) -> None:
    exchange.mismatch_to_us(node, rospy, topic)


def test_a_latched_message_reaches_a_late_subscriber(node: Node, rospy: Peer, topic: str) -> None:
    exchange.latched_to_us(node, rospy, topic)


def test_header_numbers_are_consecutive(node: Node, rospy: Peer, topic: str) -> None:
    exchange.sequence_to_us(node, rospy, topic)


def test_a_publisher_that_returns_is_found_again(node: Node, rospy: Peer, topic: str) -> None:
    exchange.peer_returns(node, rospy, topic)


def test_best_effort_falls_back_to_tcpros_where_the_publisher_knows_no_other(
    node: Node, rospy: Peer, topic: str
) -> None:
    exchange.falls_back(node, rospy, topic)


@pytest.mark.parametrize("persistent", [False, True], ids=["one call a connection", "persistent"])
def test_we_call_its_service(node: Node, rospy: Peer, topic: str, persistent: bool) -> None:
    exchange.calls_from_us(node, rospy, topic, persistent)


def test_we_read_the_parameters_it_sets(node: Node, rospy: Peer, topic: str) -> None:
    exchange.parameters_to_us(node, rospy, topic)
