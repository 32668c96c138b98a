"""A roslet node publishes and calls, CycloneDDS (its Python wheel, with the names of ROS and the service header of its rmw)
hears and serves.
"""

from __future__ import annotations

import pytest

from interop.ros2_exchange import CycloneExchange, name
from interop.ros2_peers import Pair


class TestExchange(CycloneExchange):
    talker, listener = "roslet", "cyclone"

    @pytest.mark.parametrize("policy", ["presentation", "ownership", "destination_order", "representation"])
    def test_both_ends_are_told_of_a_policy_that_no_node_has(self, pair: Pair, policy: str) -> None:
        self.check_strange(pair, policy)

    def test_instances_of_a_keyed_topic_come_and_go(self, pair: Pair) -> None:
        """ROS 2 messages have no keys, so it is the participant's writer that has them, not the node."""
        topic = name()
        pair.listener.ask("hear_keyed", topic, topic)
        pair.talker.ask("keyed_writer", topic, topic, "probe_msgs::msg::dds_::Keyed_")
        pair.talker.wait(1, "keyed_matched", topic)
        pair.listener.wait(1, "matched", topic)
        alive, disposed, unregistered = 16, 32, 64
        steps: list[tuple[str, list[object], int]] = [
            ("write_keyed", ["a", 1], alive),
            ("write_keyed", ["bcd", 2], alive),
            ("write_keyed", ["a", -3], alive),
            ("dispose_keyed", ["a"], disposed),
            ("unregister_keyed", ["bcd"], unregistered),
            ("write_keyed", ["a", 4], alive),
        ]
        heard: list[list[object]] = []
        for command, arguments, state in steps:
            pair.talker.ask(command, topic, *arguments)
            instance, *value = arguments
            heard.append([instance, *(value or [None]), state])
            pair.listener.wait(heard, "heard_keyed", topic)
