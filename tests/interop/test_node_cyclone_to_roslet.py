"""CycloneDDS (its Python wheel, with the names of ROS and the service header of its rmw) publishes and calls, roslet serves.

The user-defined type, loaded from .msg by roslet, is spelled by hand at the other end.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from interop import ros2_exchange as exchange
from interop.ros2_peers import Host, Pair, wait_until


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Pair]:
    with Host(tmp_path_factory.mktemp("cyclone")) as host:
        yield Pair(host, "cyclone", "roslet")


@pytest.mark.parametrize("case", [*exchange.CASES, *exchange.OTHER_CASES], ids=str)
def test_every_message_arrives_whole_and_in_order(pair: Pair, case: exchange.Case) -> None:
    exchange.every_message_arrives(pair, case)


@pytest.mark.parametrize(
    ("offered", "requested"), exchange.COMPATIBLE, ids=[exchange.spell(*one) for one in exchange.COMPATIBLE]
)
def test_what_is_offered_is_enough_for(
    pair: Pair, offered: dict[str, Any], requested: dict[str, Any]
) -> None:
    exchange.compatible(pair, offered, requested)


@pytest.mark.parametrize(
    ("offered", "requested", "policies"),
    exchange.INCOMPATIBLE,
    ids=[exchange.spell(*one[:2]) for one in exchange.INCOMPATIBLE],
)
def test_both_ends_are_told_that_it_is_not_enough_and_why(
    pair: Pair, offered: dict[str, Any], requested: dict[str, Any], policies: list[str]
) -> None:
    exchange.incompatible(pair, offered, requested, policies)


def test_a_missed_deadline_is_told_at_both_ends(pair: Pair) -> None:
    exchange.deadline(pair)


def test_what_has_outlived_its_lifespan_is_not_heard(pair: Pair) -> None:
    exchange.lifespan(pair)


def test_liveliness_that_is_not_asserted_is_lost_and_regained(pair: Pair) -> None:
    exchange.liveliness(pair)


@pytest.mark.parametrize("nap", [0.0, 0.002], ids=["quick", "slow"])
def test_keep_all_loses_nothing_for_a_listener_that_is(pair: Pair, nap: float) -> None:
    exchange.keep_all(pair, nap)


def test_every_call_gets_its_own_answer(pair: Pair) -> None:
    exchange.calls(pair)


def test_a_server_may_go_and_come_back(pair: Pair) -> None:
    exchange.server_restarts(pair)


def test_instances_of_a_keyed_topic_come_and_go(pair: Pair) -> None:
    """ROS 2 messages have no keys, so a node has no such subscription: it is the participant's reader that sees them."""
    topic = exchange.name()
    pair.talker.ask("keyed", topic, topic)
    pair.listener.ask("keyed", topic, topic, "probe_msgs::msg::dds_::Keyed_")
    pair.talker.wait(1, "matched", topic)
    for name, value in (("a", 1), ("bcd", 2), ("a", -3)):
        pair.talker.ask("write_keyed", topic, name, value)
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
    assert [one[1:] for one in heard if one[0] == "instance"] == [[1, "a"], [1, "bcd"], [2, "a"], [2, "bcd"]]
