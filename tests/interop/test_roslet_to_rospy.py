"""What we send, rospy understands: messages, our services, parameters that we set; on both masters."""

from __future__ import annotations

import pytest

from interop import exchange
from interop.cases import CASES, Case
from interop.ros1 import Peer
from roslet import Node


@pytest.mark.parametrize("case", CASES, ids=str)
def test_every_message_arrives_whole_and_in_order(node: Node, rospy: Peer, case: Case, topic: str) -> None:
    exchange.send(node, rospy, case, topic)


def test_a_subscriber_of_another_type_is_refused(node: Node, rospy: Peer, topic: str) -> None:
    exchange.mismatch_to_peer(node, rospy, topic)


def test_a_latched_message_reaches_a_late_subscriber(node: Node, rospy: Peer, topic: str) -> None:
    exchange.latched_to_peer(node, rospy, topic)


@pytest.mark.parametrize("persistent", [False, True], ids=["one call a connection", "persistent"])
def test_it_calls_our_service(node: Node, rospy: Peer, topic: str, persistent: bool) -> None:
    exchange.calls_to_us(node, rospy, topic, persistent)


def test_it_reads_the_parameters_we_set(node: Node, rospy: Peer, topic: str) -> None:
    exchange.parameters_to_peer(node, rospy, topic)
