"""What every ROS 2 peer is put through in each direction; the test files name the peer and the direction:

class TestExchange(ros2_exchange.Exchange):
    talker, listener = "kilted", "roslet"
"""

from __future__ import annotations

import itertools
import time
from dataclasses import dataclass
from typing import Any, ClassVar

import pytest

from interop.ros2_peers import Pair, Peer, wait_until

STRING, UINT32 = "std_msgs/msg/String", "std_msgs/msg/UInt32"
# Seconds for calls that are answered in milliseconds, where nobody else uses the machine.
CALL = 15.0
_numbers = itertools.count()


@dataclass(frozen=True)
class Case:
    type: str
    size: int  # octets or elements; -1 is the non-ASCII string
    count: int = 5

    def __str__(self) -> str:
        return f"{self.type.split('/')[2]}-{self.size}"


CASES = [
    *(Case(STRING, size) for size in (-1, 1, 256, 65536)),
    Case(STRING, 1 << 20, 3),
    Case("geometry_msgs/msg/PointStamped", 0, 20),
    Case("sensor_msgs/msg/Image", 0),
    Case("sensor_msgs/msg/Image", 640 * 480 * 3, 3),
    Case("sensor_msgs/msg/PointCloud2", (2 << 20) // 16, 3),
    Case("diagnostic_msgs/msg/DiagnosticArray", 20),
]
# Of types that the wheels of rclpy do not have; nor have they a generator that could make them.
OTHER_CASES = [
    Case("tf2_msgs/msg/TFMessage", 30),
    Case("probe_msgs/msg/Probe", 0),
    Case("probe_msgs/msg/Probe", 9),
]


def name() -> str:
    """A topic or service that no other test uses."""
    return f"/name_{next(_numbers)}"


def connect(
    pair: Pair, topic: str, type_name: str, offered: Any = None, requested: Any = None, size: int = 0
) -> None:
    """Publisher and subscription of a topic, under its name, each of which counts the other."""
    pair.listener.ask("subscription", topic, topic, type_name, size, requested or {})
    pair.talker.ask("publisher", topic, topic, type_name, offered or {})
    pair.talker.wait(1, "matched", topic)
    pair.listener.wait(1, "matched", topic)


def disconnect(pair: Pair, topic: str) -> None:
    """Both go, and the other sees it."""
    pair.talker.ask("close", topic)
    pair.listener.wait(0, "matched", topic)
    pair.listener.ask("close", topic)


# -- QoS: what is offered and what is requested

LEVELS = {"reliability": ("best_effort", "reliable"), "durability": ("volatile", "transient_local")}
KINDS = [
    {"reliability": reliability, "durability": durability}
    for reliability in LEVELS["reliability"]
    for durability in LEVELS["durability"]
]


def _enough(offered: dict[str, Any], requested: dict[str, Any]) -> bool:
    return all(of.index(offered[one]) >= of.index(requested[one]) for one, of in LEVELS.items())


COMPATIBLE = [(offered, requested) for offered in KINDS for requested in KINDS if _enough(offered, requested)]

# Offered, requested, and the policies that do not match.
INCOMPATIBLE: list[tuple[dict[str, Any], dict[str, Any], list[str]]] = [
    *(
        (
            offered,
            requested,
            [one for one, of in LEVELS.items() if of.index(offered[one]) < of.index(requested[one])],
        )
        for offered in KINDS
        for requested in KINDS
        if not _enough(offered, requested)
    ),
    ({}, {"deadline": 1.0}, ["deadline"]),
    ({"deadline": 2.0}, {"deadline": 1.0}, ["deadline"]),
    ({}, {"liveliness": "manual_by_topic"}, ["liveliness"]),
    ({}, {"lease": 1.0}, ["liveliness"]),
    ({"lease": 2.0}, {"lease": 1.0}, ["liveliness"]),
]


def spell(offered: dict[str, Any], requested: dict[str, Any]) -> str:
    """A test's name."""
    words = [" ".join(str(value) for value in one.values()) or "defaults" for one in (offered, requested)]
    return f"{words[0]} for {words[1]}"


def _told(end: Peer, topic: str, fact: str) -> int:
    return [one[0] for one in end.ask("events", topic)].count(fact)


class Exchange:
    """The tests of a file; `pair` is of conftest.py. In the services it is the listener that serves."""

    talker: ClassVar[str]
    listener: ClassVar[str]

    @pytest.mark.parametrize("case", CASES, ids=str)
    def test_every_message_arrives_whole_and_in_order(self, pair: Pair, case: Case) -> None:
        topic = name()
        connect(pair, topic, case.type, size=case.size)
        pair.talker.ask("publish", topic, 0, case.count, case.size, 0.01)
        pair.listener.wait([list(range(case.count)), []], "heard", topic)
        disconnect(pair, topic)

    @pytest.mark.parametrize(("offered", "requested"), COMPATIBLE, ids=[spell(*one) for one in COMPATIBLE])
    def test_what_is_offered_is_enough_for(
        self, pair: Pair, offered: dict[str, Any], requested: dict[str, Any]
    ) -> None:
        """They match. A listener that comes late hears the last ones where both are transient-local, and nothing of before
        where not; what is published from then on it hears, and nothing is told to be incompatible."""
        topic = name()
        pair.talker.ask("publisher", topic, topic, UINT32, {**offered, "depth": 3})
        pair.talker.ask("publish", topic, 0, 5, 0, 0.0)
        pair.listener.ask("subscription", topic, topic, UINT32, 0, {**requested, "depth": 50})
        pair.talker.wait(1, "matched", topic)
        pair.listener.wait(1, "matched", topic)
        kept = {"reliability": "reliable", "durability": "transient_local"}
        if requested == kept:
            pair.listener.wait([[2, 3, 4], []], "heard", topic)
        pair.talker.ask("publish", topic, 5, 20, 0, 0.01)
        wait_until(lambda: 24 in pair.listener.ask("heard", topic)[0], "the last message arrives")
        heard, wrong = pair.listener.ask("heard", topic)
        assert wrong == []
        assert heard == sorted(set(heard))
        if pair.talker.kind == "cyclone" and offered["durability"] == "transient_local":
            # Cyclone sends what it keeps to whoever asks, and volatile readers of rclpy hear that too.
            assert heard[0] >= 2
        elif requested["durability"] == "volatile":
            assert heard[0] >= 5
        if requested["reliability"] == "reliable":
            assert [one for one in heard if one >= 5] == list(range(5, 25))
        assert not [
            one
            for end in (pair.talker, pair.listener)
            for one in end.ask("events", topic)
            if one[0] == "incompatible"
        ]
        disconnect(pair, topic)

    @pytest.mark.parametrize(
        ("offered", "requested", "policies"), INCOMPATIBLE, ids=[spell(*one[:2]) for one in INCOMPATIBLE]
    )
    def test_both_ends_are_told_that_it_is_not_enough_and_why(
        self, pair: Pair, offered: dict[str, Any], requested: dict[str, Any], policies: list[str]
    ) -> None:
        """Both ends are told, with a policy that is why (roslet: with all of them), and nothing arrives."""
        self.check_incompatible(pair, offered, requested, policies, pair.talker, pair.listener)

    def check_incompatible(
        self,
        pair: Pair,
        offered: dict[str, Any],
        requested: dict[str, Any],
        policies: list[str],
        *ends: Peer,
    ) -> None:
        """These ends are told why, and nothing arrives."""
        topic = name()
        pair.listener.ask("subscription", topic, topic, STRING, 8, requested)
        pair.talker.ask("publisher", topic, topic, STRING, offered)
        for end in ends:
            found: list[str] = []

            def told(end: Peer = end, found: list[str] = found) -> bool:
                found[:] = [one[1] for one in end.ask("events", topic) if one[0] == "incompatible"]
                return bool(found)

            wait_until(told, f"{end.kind} is told that they are incompatible")
            if end.kind == "roslet":
                assert sorted(found) == sorted(policies)
            else:
                assert set(found) <= set(policies)
        pair.talker.ask("publish", topic, 0, 3, 8, 0.01)
        assert pair.talker.ask("matched", topic) == pair.listener.ask("matched", topic) == 0
        assert pair.listener.ask("heard", topic) == [[], []]
        pair.talker.ask("close", topic)
        pair.listener.ask("close", topic)

    def test_a_missed_deadline_is_told_at_both_ends(self, pair: Pair) -> None:
        """A publisher that pauses misses its deadline: both ends are told."""
        topic = name()
        connect(pair, topic, UINT32, {"deadline": 0.3}, {"deadline": 0.3})
        pair.talker.ask("publish", topic, 0, 10, 0, 0.05)
        pair.listener.wait([list(range(10)), []], "heard", topic)
        for end in (pair.listener, pair.talker):
            wait_until(lambda end=end: _told(end, topic, "deadline"), f"{end.kind} is told of the deadline")  # type: ignore[misc]
        disconnect(pair, topic)

    def test_what_has_outlived_its_lifespan_is_not_heard(self, pair: Pair) -> None:
        """What is too old for its publisher no late listener hears."""
        topic = name()
        kept = {"durability": "transient_local", "depth": 10}
        pair.talker.ask("publisher", topic, topic, UINT32, {**kept, "lifespan": 0.5})
        pair.talker.ask("publish", topic, 0, 3, 0, 0.0)
        time.sleep(0.8)
        pair.talker.ask("publish", topic, 3, 2, 0, 0.0)
        pair.listener.ask("subscription", topic, topic, UINT32, 0, kept)
        wait_until(lambda: 4 in pair.listener.ask("heard", topic)[0], "what is still good arrives")
        assert pair.listener.ask("heard", topic) == [[3, 4], []]
        disconnect(pair, topic)

    def test_liveliness_that_is_not_asserted_is_lost_and_regained(self, pair: Pair) -> None:
        """A publisher that has to assert its liveliness itself and does not is lost to both ends, and regained."""
        topic = name()
        qos = {"liveliness": "manual_by_topic", "lease": 0.4}
        connect(pair, topic, UINT32, qos, qos)
        pair.talker.ask("publish", topic, 0, 1, 0, 0.0)
        pair.listener.wait([[0], []], "heard", topic)
        for end in (pair.listener, pair.talker):
            wait_until(lambda end=end: _told(end, topic, "lost"), f"{end.kind} is told of the liveliness")  # type: ignore[misc]
        before = _told(pair.listener, topic, "alive")
        pair.talker.ask("publish", topic, 1, 1, 0, 0.0)
        wait_until(
            lambda: _told(pair.listener, topic, "alive") > before, "the listener is told that it is back"
        )
        disconnect(pair, topic)

    @pytest.mark.parametrize("nap", [0.0, 0.002], ids=["quick", "slow"])
    def test_keep_all_loses_nothing_for_a_listener_that_is(self, pair: Pair, nap: float) -> None:
        """Reliable and keep-all: as fast as it goes, and nothing is lost, also where the listener needs `nap` for each."""
        topic = name()
        qos, size, count = {"history": "keep_all"}, 1000, 1000
        pair.listener.ask("subscription", topic, topic, STRING, size, qos, nap)
        pair.talker.ask("publisher", topic, topic, STRING, qos)
        pair.talker.wait(1, "matched", topic)
        pair.listener.wait(1, "matched", topic)
        pair.talker.ask("publish", topic, 0, count, size, 0.0)
        pair.listener.wait([list(range(count)), []], "heard", topic)
        disconnect(pair, topic)

    def test_every_call_gets_its_own_answer(self, pair: Pair) -> None:
        """One after the other, many in flight, and of a megabyte; every call gets its own answer."""
        for type_name in ("std_srvs/srv/SetBool", "std_srvs/srv/Trigger", "sensor_msgs/srv/SetCameraInfo"):
            service = name()
            pair.listener.ask("service", service, service, type_name)
            pair.talker.ask("client", service, service, type_name)
            pair.talker.wait(True, "ready", service)
            for i in range(3):
                assert pair.talker.ask("call", service, i, 1, 0, CALL) == []
            # As many at once as the history of a server of rclpy holds.
            for i in range(5):
                assert pair.talker.ask("call", service, 10 * i, 10, 0, CALL) == []
            if type_name == "sensor_msgs/srv/SetCameraInfo":
                assert pair.talker.ask("call", service, 3, 2, 1 << 20, CALL) == []
            pair.talker.ask("close", service)
            pair.listener.ask("close", service)

    def test_a_server_may_go_and_come_back(self, pair: Pair) -> None:
        """A server that goes is noticed; a call after it is back gets its answer."""
        service = name()
        pair.talker.ask("client", service, service, "std_srvs/srv/SetBool")
        for i in range(3):
            pair.listener.ask("service", service, service, "std_srvs/srv/SetBool")
            pair.talker.wait(True, "ready", service)
            assert pair.talker.ask("call", service, i, 3, 0, CALL) == []
            pair.listener.ask("close", service)
            pair.talker.wait(False, "ready", service)
        pair.talker.ask("close", service)


class CycloneExchange(Exchange):
    """With what is spelled by hand at Cyclone's end."""

    @pytest.mark.parametrize("case", OTHER_CASES, ids=str)
    def test_every_message_of_a_user_arrives_whole_and_in_order(self, pair: Pair, case: Case) -> None:
        self.test_every_message_arrives_whole_and_in_order(pair, case)

    def check_strange(self, pair: Pair, policy: str) -> None:
        """A policy of Cyclone's end that neither rclpy nor a node of ours can be told: both ends name it."""
        self._check_strange(pair, policy, pair.talker, pair.listener)

    def _check_strange(self, pair: Pair, policy: str, *ends: Peer) -> None:
        offered, requested = (
            {"strange": [policy]} if end.kind == "cyclone" else {} for end in (pair.talker, pair.listener)
        )
        self.check_incompatible(pair, offered, requested, [policy], *ends)

    def test_a_partition_that_no_node_is_in_is_told_at_our_end(self, pair: Pair) -> None:
        """To DDS, and so to Cyclone, another partition is no incompatibility but another topic, as it were."""
        self._check_strange(
            pair, "partition", *[end for end in (pair.talker, pair.listener) if end.kind == "roslet"]
        )
