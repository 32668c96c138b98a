"""Latched topics: a subscriber that comes late gets the last message, over each transport."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from roslet import Node, QoS
from roslet.master.server import MasterServer

LATCHED = QoS(depth=1, durability="transient_local")


@pytest.fixture
def network() -> Iterator[str]:
    with MasterServer(port=0) as master:
        yield f"ros1://127.0.0.1:{master.port}"


@pytest.mark.parametrize("reliability", ["reliable", "best_effort"])
def test_a_late_subscriber_gets_the_last_message_once(network: str, reliability: str) -> None:
    with Node("early", network=network) as early, Node("late", network=network) as late:
        publisher = early.publisher("map", "std_msgs/String", qos=LATCHED)
        publisher.publish(data="first")
        publisher.publish(data="last")
        subscription = late.subscribe("map", "std_msgs/String", qos=QoS(reliability=reliability))
        assert subscription.take(timeout=5).data == "last"
        publisher.publish(data="next")
        assert subscription.take(timeout=5).data == "next"
        assert subscription.take(timeout=0.1) is None


def test_a_late_subscriber_of_the_same_node_gets_the_last_message(network: str) -> None:
    with Node("only", network=network) as node:
        node.publisher("map", "std_msgs/String", qos=LATCHED).publish(data="last")
        assert node.subscribe("map", "std_msgs/String").take(timeout=5).data == "last"
