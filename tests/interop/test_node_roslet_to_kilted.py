"""A roslet node publishes and calls, rclpy (kilted, Fast DDS) hears and serves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest

from interop import ros2_exchange as exchange
from interop.ros2_peers import Host, Pair


@pytest.fixture(scope="module")
def pair(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Pair]:
    with Host(tmp_path_factory.mktemp("kilted")) as host:
        yield Pair(host, "roslet", "kilted")


@pytest.mark.parametrize("case", exchange.CASES, ids=str)
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
