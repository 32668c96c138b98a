"""CycloneDDS (its Python wheel, with the names of ROS and the service header of its rmw) publishes and calls, roslet serves.

The user-defined type, loaded from .msg by roslet, is spelled by hand at the other end.
"""

from __future__ import annotations

import pytest

from interop.ros2_exchange import CycloneExchange, name
from interop.ros2_peers import Pair, wait_until


class TestExchange(CycloneExchange):
    talker, listener = "cyclone", "roslet"

    @pytest.mark.parametrize("policy", ["latency_budget", "ownership", "representation"])
    def test_both_ends_are_told_of_a_policy_that_no_node_has(self, pair: Pair, policy: str) -> None:
        self.check_strange(pair, policy)

    def test_instances_of_a_keyed_topic_come_and_go(self, pair: Pair) -> None:
        """ROS 2 messages have no keys, so a node has no such subscription: it is the participant's reader that sees them."""
        topic = name()
        pair.talker.ask("keyed", topic, topic)
        pair.listener.ask("keyed", topic, topic, "probe_msgs::msg::dds_::Keyed_")
        pair.talker.wait(1, "matched", topic)
        for instance, value in (("a", 1), ("bcd", 2), ("a", -3)):
            pair.talker.ask("write_keyed", topic, instance, value)
        pair.talker.ask("dispose_keyed", topic, "a")
        pair.talker.ask("unregister_keyed", topic, "bcd")
        # A string, and an int32 where it is not the key alone.
        front, a, b = b"\0\1\0\0", b"\2\0\0\0a\0\0\0", b"\4\0\0\0bcd\0"
        expected = [a + b"\1\0\0\0", b + b"\2\0\0\0", a + b"\xfd\xff\xff\xff", a, b]
        wait_until(lambda: len(pair.listener.ask("heard_keyed", topic)) == 9, "all samples and states")
        heard = pair.listener.ask("heard_keyed", topic)
        samples = [bytes.fromhex(one[1]) for one in heard if one[0] == "sample"]
        assert [
            one[:2] + b"\0\0" + one[4 : 4 + len(body)] for one, body in zip(samples, expected, strict=True)
        ] == [front + body for body in expected]
        # Alive twice, disposed twice: a writer that unregisters disposes, unless told otherwise.
        assert [one[1:] for one in heard if one[0] == "instance"] == [
            [1, "a"],
            [1, "bcd"],
            [2, "a"],
            [2, "bcd"],
        ]
