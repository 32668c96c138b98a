"""What the master answers and whom it tells, without sockets."""

from __future__ import annotations

from typing import Any

import pytest

from roslet.engine.ros1 import rpc
from roslet.errors import Fault
from roslet.master.core import API, Master, Notification

A, B, C = "http://a:1/", "http://b:2/", "http://c:3/"


@pytest.fixture
def master() -> Master:
    return Master("http://master:11311/", 42)


def ask(master: Master, method: str, *params: Any) -> Any:
    """The value of a successful call."""
    return rpc.unpack_reply(master.call(method, params))


def told(master: Master) -> list[tuple[str, str, list[Any]]]:
    """What is to be delivered: (node, method, parameters after the caller's name)."""
    return [(one.api, one.method, one.params[1:]) for one in master.take_notifications()]


def test_a_publisher_learns_the_subscribers_and_they_the_whole_list(master: Master) -> None:
    assert ask(master, "registerSubscriber", "/sub", "/t", "std_msgs/String", A) == []
    assert ask(master, "registerPublisher", "/p1", "/t", "std_msgs/String", B) == [A]
    assert ask(master, "registerPublisher", "/p2", "/t", "std_msgs/String", C) == [A]
    assert told(master) == [(A, "publisherUpdate", ["/t", [B]]), (A, "publisherUpdate", ["/t", [B, C]])]
    assert ask(master, "registerSubscriber", "/s2", "/t", "*", C) == [B, C]
    assert ask(master, "unregisterPublisher", "/p1", "/t", B) == 1
    assert told(master) == [(A, "publisherUpdate", ["/t", [C]]), (C, "publisherUpdate", ["/t", [C]])]
    assert ask(master, "unregisterPublisher", "/p1", "/t", B) == 0
    assert told(master) == []


def test_names_are_resolved_for_the_caller(master: Master) -> None:
    ask(master, "registerPublisher", "/ns/node", "relative", "a/B", A)
    ask(master, "registerPublisher", "/ns/node", "~private", "a/B", A)
    ask(master, "registerPublisher", "/ns/node", "/global//x/", "a/B", A)
    assert [name for name, _ in ask(master, "getTopicTypes", "/x")] == [
        "/ns/relative",
        "/ns/node/private",
        "/global/x",
    ]
    assert ask(master, "getPublishedTopics", "/ns/other", "node") == [["/ns/node/private", "a/B"]]
    assert ask(master, "lookupNode", "/ns/other", "node") == A


def test_the_type_of_a_topic_is_the_publishers_and_not_a_star(master: Master) -> None:
    ask(master, "registerSubscriber", "/s", "/t", "*", A)
    assert ask(master, "getTopicTypes", "/x") == []
    ask(master, "registerPublisher", "/p", "/t", "*", B)
    assert ask(master, "getTopicTypes", "/x") == [["/t", "*"]]
    ask(master, "registerPublisher", "/p", "/t", "a/B", B)
    ask(master, "registerSubscriber", "/s", "/t", "c/D", A)
    ask(master, "registerPublisher", "/p", "/t", "*", B)
    assert ask(master, "getTopicTypes", "/x") == [["/t", "a/B"]]


def test_the_state_lists_publishers_subscribers_and_services(master: Master) -> None:
    ask(master, "registerPublisher", "/p", "/t", "a/B", A)
    ask(master, "registerSubscriber", "/s", "/t", "a/B", B)
    ask(master, "registerService", "/v", "/srv", "rosrpc://c:4", C)
    assert ask(master, "getSystemState", "/x") == [[["/t", ["/p"]]], [["/t", ["/s"]]], [["/srv", ["/v"]]]]


def test_a_service_belongs_to_who_registered_it_last(master: Master) -> None:
    ask(master, "registerService", "/v1", "/srv", "rosrpc://a:4", A)
    ask(master, "registerService", "/v2", "/srv", "rosrpc://b:4", B)
    assert ask(master, "lookupService", "/x", "/srv") == "rosrpc://b:4"
    assert ask(master, "unregisterService", "/v1", "/srv", "rosrpc://a:4") == 0
    assert ask(master, "unregisterService", "/v2", "/srv", "rosrpc://b:4") == 1
    assert master.call("lookupService", ["/x", "/srv"])[0] == -1


def test_a_second_node_of_a_name_ends_the_first_and_drops_what_it_registered(master: Master) -> None:
    ask(master, "registerSubscriber", "/sub", "/t", "a/B", C)
    ask(master, "registerPublisher", "/twin", "/t", "a/B", A)
    ask(master, "registerService", "/twin", "/srv", "rosrpc://a:4", A)
    ask(master, "subscribeParam", "/twin", A, "/key")
    told(master)
    ask(master, "registerSubscriber", "/twin", "/other", "a/B", B)
    shutdown, update = told(master)
    assert shutdown[:2] == (A, "shutdown")
    assert "new node registered with same name" in shutdown[2][0]
    assert update == (C, "publisherUpdate", ["/t", []])
    assert ask(master, "lookupNode", "/x", "/twin") == B
    assert ask(master, "getSystemState", "/x") == [[], [["/t", ["/sub"]], ["/other", ["/twin"]]], []]
    assert master.call("lookupService", ["/x", "/srv"])[0] == -1
    ask(master, "setParam", "/x", "/key", 1)
    assert told(master) == []
    # The first one's own unregistering, as it ends, takes nothing from the second.
    assert ask(master, "unregisterSubscriber", "/twin", "/other", A) == 0
    assert ask(master, "lookupNode", "/x", "/twin") == B


def test_a_node_is_known_as_long_as_it_has_a_registration(master: Master) -> None:
    ask(master, "registerPublisher", "/n", "/t", "a/B", A)
    ask(master, "subscribeParam", "/n", A, "/key")
    ask(master, "unregisterPublisher", "/n", "/t", A)
    assert ask(master, "lookupNode", "/x", "/n") == A
    ask(master, "unsubscribeParam", "/n", A, "/key")
    assert master.call("lookupNode", ["/x", "/n"])[0] == -1


def test_registering_twice_is_registering_once(master: Master) -> None:
    for _ in range(2):
        ask(master, "registerPublisher", "/p", "/t", "a/B", A)
        ask(master, "registerSubscriber", "/s", "/t", "a/B", B)
    assert ask(master, "getSystemState", "/x")[0] == [["/t", ["/p"]]]
    assert ask(master, "registerSubscriber", "/s2", "/t", "a/B", C) == [A]


def test_several_nodes_of_one_process_are_told_once(master: Master) -> None:
    ask(master, "registerSubscriber", "/s1", "/t", "a/B", A)
    ask(master, "registerSubscriber", "/s2", "/t", "a/B", A)
    ask(master, "registerPublisher", "/p", "/t", "a/B", B)
    assert told(master) == [(A, "publisherUpdate", ["/t", [B]])]


def test_parameters_are_set_read_found_and_deleted(master: Master) -> None:
    ask(master, "setParam", "/ns/n", "gains", {"p": 1, "i": [0.5, "x"]})
    assert ask(master, "getParam", "/ns/n", "gains/p") == 1
    assert ask(master, "getParam", "/x", "/ns") == {"gains": {"p": 1, "i": [0.5, "x"]}}
    assert ask(master, "hasParam", "/ns/n", "gains") is True
    assert ask(master, "searchParam", "/ns/n", "gains") == "/ns/gains"
    assert ask(master, "getParamNames", "/x") == ["/ns/gains/p", "/ns/gains/i"]
    assert ask(master, "deleteParam", "/ns/n", "gains/p") == 0
    assert ask(master, "hasParam", "/ns/n", "gains/p") is False
    for method in ("getParam", "deleteParam", "searchParam"):
        assert master.call(method, ["/ns/n", "none"])[0] == -1


def test_a_subscriber_of_a_parameter_is_told_but_not_of_its_own_change(master: Master) -> None:
    assert ask(master, "subscribeParam", "/n", A, "/k") == {}
    ask(master, "setParam", "/other", "/k", 1)
    assert told(master) == [(A, "paramUpdate", ["/k/", 1])]
    ask(master, "setParam", "/n", "/k", 2)
    assert told(master) == []
    assert ask(master, "subscribeParam", "/n", A, "/k") == 2
    ask(master, "deleteParam", "/n", "/k")
    assert told(master) == [(A, "paramUpdate", ["/k/", {}])]
    ask(master, "unsubscribeParam", "/n", A, "/k")
    ask(master, "setParam", "/other", "/k", 3)
    assert told(master) == []


def test_a_node_that_refuses_an_update_is_not_told_again_and_nothing_else_is_forgotten(
    master: Master,
) -> None:
    ask(master, "registerPublisher", "/n", "/t", "a/B", A)
    ask(master, "subscribeParam", "/n", A, "/k")
    ask(master, "subscribeParam", "/n", A, "/k2")
    ask(master, "setParam", "/x", "/k", 1)
    (update,) = master.take_notifications()
    master.notification_answered(update, [-1, "not subscribed", 0])
    ask(master, "setParam", "/x", "/k", 2)
    ask(master, "setParam", "/x", "/k2", 2)
    assert told(master) == [(A, "paramUpdate", ["/k2/", 2])]
    assert ask(master, "lookupNode", "/x", "/n") == A


@pytest.mark.parametrize("reply", [None, [], "no reply", [0, "", 0], [1, "", 0]])
def test_other_answers_to_notifications_change_nothing(master: Master, reply: Any) -> None:
    ask(master, "subscribeParam", "/n", A, "/k")
    master.notification_answered(Notification(A, "paramUpdate", "/k/", ["/master", "/k/", 1]), reply)
    master.notification_answered(Notification(A, "publisherUpdate", "/t", ["/master", "/t", []]), [-1, "", 0])
    ask(master, "setParam", "/x", "/k", 1)
    assert len(told(master)) == 1


@pytest.mark.parametrize("method", sorted(API))
def test_every_method_answers_bad_calls_with_its_own_kind_of_value(master: Master, method: str) -> None:
    kinds, otherwise = API[method]
    for params in ([], ["/x"] * (len(kinds) + 2), [5] * (len(kinds) + 1)):
        code, message, value = master.call(method, params)
        assert code == -1
        assert method in message or "caller_id" in message
        assert value == otherwise


@pytest.mark.parametrize(
    ("method", "params"),
    [
        ("registerPublisher", ["/t:x", "a/B", A]),
        ("registerPublisher", ["a topic", "a/B", A]),
        ("registerPublisher", ["/", "a/B", A]),
        ("registerPublisher", ["", "a/B", A]),
        ("registerPublisher", ["/t", "no_package", A]),
        ("registerPublisher", ["/t", "a/b/C", A]),
        ("registerPublisher", ["/t", 7, A]),
        ("registerPublisher", ["/t", "a/B", "ftp://a"]),
        ("registerService", ["/s", "tcp://x", A]),
        ("setParam", ["", 1]),
        ("setParam", [7, 1]),
        ("setParam", ["/k", None]),
        ("setParam", ["/", 1]),
        ("getPublishedTopics", [None]),
        ("lookupNode", [""]),
    ],
)
def test_a_bad_argument_is_the_callers_fault(master: Master, method: str, params: list[Any]) -> None:
    code, _, value = master.call(method, ["/n", *params])
    assert (code, value) == (-1, API[method][1])
    assert told(master) == []


def test_a_search_without_meaning_is_a_failure(master: Master) -> None:
    assert master.call("searchParam", ["/n", "~x"])[0] == 0
    assert master.call("searchParam", ["not_global", "x"])[0] == 0


def test_what_a_master_does_not_have_is_a_fault(master: Master) -> None:
    with pytest.raises(Fault, match="publisherUpdate"):
        master.call("publisherUpdate", ["/x", "/t", []])
    with pytest.raises(Fault):
        master.call("__init__", ["/x"])


def test_it_tells_who_it_is_and_stops_when_asked(master: Master) -> None:
    assert ask(master, "getUri", "/x") == "http://master:11311/"
    assert ask(master, "getPid", "/x") == 42
    assert not master.stopping
    assert ask(master, "shutdown", "/x", "enough") == 0
    assert master.stopping


def test_a_multicall_reaches_every_method(master: Master) -> None:
    calls = [{"methodName": "setParam", "params": ["/x", f"/p{n}", n]} for n in range(3)]
    results = rpc.dispatch(master.methods(), "system.multicall", [calls])
    assert [result[0][0] for result in results] == [1, 1, 1]
    assert ask(master, "getParam", "/x", "/") == {"p0": 0, "p1": 1, "p2": 2}
