"""Our master and Debian's rosmaster get the same calls: their answers and what they tell nodes must agree.

Compared are status codes, values and faults, not the wording of messages. Where ours differs on purpose, the test
says so.
"""

from __future__ import annotations

import pathlib
import random
import socket
import threading
import xmlrpc.client
import xmlrpc.server
from collections.abc import Iterator
from typing import Any

import pytest

from interop.ros1 import Master, wait_until
from roslet.io.select import Reactor
from roslet.master.server import MasterServer

Call = tuple[str, list[Any]]

A, B = "http://127.0.0.1:2/", "http://127.0.0.1:3/"  # nobody listens there
ROSRPC = "rosrpc://127.0.0.1:4"

SCRIPT: list[Call] = [
    ("getPid", ["/x"]),
    ("getUri", ["/x"]),
    ("getSystemState", ["/x"]),
    ("getTopicTypes", ["/x"]),
    ("getPublishedTopics", ["/x", ""]),
    ("getParamNames", ["/x"]),
    # parameters
    ("setParam", ["/ns/n", "a", 1]),
    ("setParam", ["/ns/n", "~b", "text"]),
    ("setParam", ["/ns/n", "/c/d/e", [1, 2.5, True, "x", ["y"]]]),
    ("setParam", ["/ns/n", "tree", {"k": {"l": 1, "m": {}}, "n": "o"}]),
    ("setParam", ["/ns/n", "/bytes", xmlrpc.client.Binary(b"\x00\x01")]),
    ("setParam", ["/ns/n", "", 1]),
    ("setParam", ["/ns/n", 5, 1]),
    ("setParam", ["/ns/n", "nil", None]),
    ("setParam", ["/ns/n", "/", 1]),
    ("setParam", ["/ns/n"]),
    ("setParam", []),
    ("setParam", [7, "a", 1]),
    ("setParam", ["/ns/n", "a", 1, 2]),
    ("getParam", ["/ns/n", "a"]),
    ("getParam", ["/ns/n", "~b"]),
    ("getParam", ["/ns/n", "/"]),
    ("getParam", ["/ns/n", "/ns/"]),
    ("getParam", ["/ns/n", "//ns//tree/k"]),
    ("getParam", ["/ns/n", "none"]),
    ("getParam", ["/ns/n", "a/below/a/value"]),
    ("getParam", ["/ns/n", ""]),
    ("getParam", ["", "/ns/a"]),
    ("getParam", ["relative_caller", "/ns/a"]),
    ("hasParam", ["/ns/n", "a"]),
    ("hasParam", ["/ns/n", "none"]),
    ("hasParam", ["/ns/n", "/ns"]),
    ("hasParam", ["/ns/n", ""]),
    ("searchParam", ["/ns/n", "a"]),
    ("searchParam", ["/ns/n/deep/down", "a"]),
    ("searchParam", ["/ns/n", "tree/anything"]),
    ("searchParam", ["/ns/n", "tree/"]),
    ("searchParam", ["/other/n", "ns"]),
    ("searchParam", ["/other/n", "a"]),
    ("searchParam", ["/ns/n", "/ns/a"]),
    ("searchParam", ["/ns/n", "/none"]),
    ("searchParam", ["/ns/n", "~b"]),
    ("searchParam", ["/ns/n", ""]),
    ("searchParam", ["ns", "a"]),
    ("searchParam", ["/", "ns"]),
    ("getParamNames", ["/x"]),
    ("setParam", ["/x", "/ns/a/b", 3]),
    ("getParam", ["/x", "/ns/a"]),
    ("deleteParam", ["/x", "/ns/a"]),
    ("deleteParam", ["/x", "/ns/a"]),
    ("deleteParam", ["/x", "/none/at/all"]),
    ("deleteParam", ["/x", "/"]),
    ("deleteParam", ["/x", "/ns/tree"]),
    ("getParamNames", ["/x"]),
    ("subscribeParam", ["/n", A, "/c/d"]),
    ("subscribeParam", ["/n", A, "/unset"]),
    ("subscribeParam", ["/n", A, "relative"]),
    ("subscribeParam", ["/n", "no uri", "/c/d"]),
    ("subscribeParam", ["/n", A]),
    ("lookupNode", ["/x", "/n"]),
    ("unsubscribeParam", ["/n", A, "/c/d"]),
    ("unsubscribeParam", ["/n", A, "/never"]),
    ("unsubscribeParam", ["/n", A, "/unset"]),
    ("unsubscribeParam", ["/n", A, "relative"]),
    ("lookupNode", ["/x", "/n"]),
    ("setParam", ["/x", "/", {"fresh": {"start": 1}}]),
    ("getParam", ["/x", "/"]),
    # topics
    ("registerSubscriber", ["/s", "/t", "std_msgs/String", A]),
    ("registerSubscriber", ["/s", "/any", "*", A]),
    ("getTopicTypes", ["/x"]),
    ("registerPublisher", ["/p", "/t", "std_msgs/Int32", B]),
    ("registerPublisher", ["/p", "/any", "*", B]),
    ("registerPublisher", ["/p", "/any", "a/B", B]),
    ("registerPublisher", ["/p", "/any", "*", B]),
    ("registerPublisher", ["/ns/p2", "t", "a/B", B]),
    ("registerPublisher", ["/ns/p2", "~t", "a/B", B]),
    ("registerPublisher", ["/p", "/t", "std_msgs/Int32", B]),
    ("getTopicTypes", ["/x"]),
    ("getPublishedTopics", ["/x", ""]),
    ("getPublishedTopics", ["/x", "/ns"]),
    ("getPublishedTopics", ["/x", "/ns/"]),
    ("getPublishedTopics", ["/ns/x", "p2"]),
    ("getPublishedTopics", ["/x", "/nothing"]),
    ("getPublishedTopics", ["/x", 3]),
    ("getSystemState", ["/x"]),
    ("registerSubscriber", ["/s2", "/t", "*", A]),
    ("registerPublisher", ["/p", "/t", "no_package", B]),
    ("registerPublisher", ["/p", "/t", "a/b/c", B]),
    ("registerPublisher", ["/p", "/t", "", B]),
    ("registerPublisher", ["/p", "/", "a/B", B]),
    ("registerPublisher", ["/p", "", "a/B", B]),
    ("registerPublisher", ["/p", "http://x", "a/B", B]),
    ("registerPublisher", ["/p", "a b", "a/B", B]),
    ("registerPublisher", ["/p", "/t", "a/B", "ftp://x"]),
    ("registerPublisher", ["/p", "/t", "a/B", ""]),
    ("registerPublisher", ["/p", "/t", "a/B"]),
    ("registerPublisher", ["/p", "/odd-name.x", "a/B", B]),
    ("unregisterPublisher", ["/p", "/t", A]),
    ("unregisterPublisher", ["/nobody", "/t", B]),
    ("unregisterPublisher", ["/p", "/t", B]),
    ("unregisterPublisher", ["/p", "/t", B]),
    ("unregisterSubscriber", ["/s2", "/t", A]),
    ("unregisterSubscriber", ["/s2", "/t", A]),
    ("lookupNode", ["/x", "/s2"]),
    ("lookupNode", ["/x", "/s"]),
    ("lookupNode", ["/ns/x", "p2"]),
    ("lookupNode", ["/x", ""]),
    ("lookupNode", ["/x", "a:b"]),
    ("lookupNode", ["/x", "/"]),
    ("getTopicTypes", ["/x"]),
    # services
    ("registerService", ["/v", "/srv", ROSRPC, A]),
    ("registerService", ["/v", "~srv", ROSRPC, A]),
    ("lookupService", ["/x", "/srv"]),
    ("lookupService", ["/x", "/v/srv"]),
    ("lookupService", ["/x", "/none"]),
    ("lookupService", ["/x", ""]),
    ("registerService", ["/v2", "/srv", ROSRPC + "0", B]),
    ("lookupService", ["/x", "/srv"]),
    ("getSystemState", ["/x"]),
    ("unregisterService", ["/v", "/srv", ROSRPC]),
    ("unregisterService", ["/v2", "/srv", ROSRPC]),
    ("unregisterService", ["/v2", "/srv", ROSRPC + "0"]),
    ("unregisterService", ["/nobody", "/srv", ROSRPC]),
    ("registerService", ["/v", "/srv", "not a uri", A]),
    # a node of the same name under another URI
    ("registerPublisher", ["/p", "/t", "a/B", B]),
    ("registerService", ["/p", "/p_srv", ROSRPC, B]),
    ("subscribeParam", ["/p", B, "/fresh"]),
    ("registerSubscriber", ["/p", "/elsewhere", "a/B", A]),
    ("getSystemState", ["/x"]),
    ("lookupNode", ["/x", "/p"]),
    ("lookupService", ["/x", "/p_srv"]),
    ("unregisterSubscriber", ["/p", "/elsewhere", B]),
    ("lookupNode", ["/x", "/p"]),
    # what a master is not asked
    ("getBusStats", ["/x"]),
    ("getPublications", ["/x"]),
    ("publisherUpdate", ["/x", "/t", []]),
    ("no_such_method", []),
    (
        "system.multicall",
        [[{"methodName": "getPid", "params": ["/x"]}, {"methodName": "none", "params": []}]],
    ),
    ("system.multicall", [[]]),
    ("getUri", []),
    ("getPid", [3]),
]


@pytest.fixture
def masters(tmp_path: pathlib.Path) -> Iterator[tuple[str, str]]:
    """The URIs of Debian's and ours, both fresh."""
    debian = Master("debian", tmp_path)
    loop = Reactor()
    try:
        with MasterServer("127.0.0.1", 0, loop) as ours:
            yield debian.uri, ours.uri
    finally:
        loop.close()
        debian.stop()


def ask(master: str, method: str, params: list[Any]) -> Any:
    """The answer, made comparable: no wording, lists without order where the API gives none."""
    proxy = xmlrpc.client.ServerProxy(master, allow_none=True)
    try:
        reply = getattr(proxy, method)(*params)
    except xmlrpc.client.Fault:
        return "fault"
    finally:
        proxy("close")()
    if method == "system.multicall":
        return ["fault" if isinstance(one, dict) else comparable("getPid", one[0]) for one in reply]
    return comparable(method, reply)


def comparable(method: str, reply: list[Any]) -> Any:
    code, message, value = reply
    assert isinstance(message, str)
    if code == 1 and method in ("getPid", "getUri"):
        return code, type(value)
    if code == 1 and method == "getSystemState":
        return code, [sorted([name, sorted(nodes)] for name, nodes in part) for part in value]
    if code == 1 and method in ("getTopicTypes", "getPublishedTopics", "getParamNames"):
        return code, sorted(value)
    return code, value


def test_a_script_of_calls_is_answered_alike(masters: tuple[str, str]) -> None:
    debian, ours = masters
    differences = []
    for line, (method, params) in enumerate(SCRIPT):
        theirs, mine = ask(debian, method, params), ask(ours, method, params)
        if theirs != mine:
            differences.append(f"{line}: {method}{params}\n  rosmaster {theirs}\n  roslet    {mine}")
    assert not differences, "\n".join(differences)


NODES = ["/a", "/ns/b", "/ns/c"]
APIS = [A, B]
TOPICS = ["/t", "u", "~v"]
KEYS = ["/k", "/k/l", "/k/l/m", "n", "~o", "/"]
VALUES: list[Any] = [1, "x", {"l": 2}, {"l": {"m": 3}}, {}, [1, 2]]


def random_call(source: random.Random) -> Call:
    node, api, topic = source.choice(NODES), source.choice(APIS), source.choice(TOPICS)
    key, value = source.choice(KEYS), source.choice(VALUES)
    return source.choice(
        [
            ("registerPublisher", [node, topic, source.choice(["*", "a/B", "c/D"]), api]),
            ("unregisterPublisher", [node, topic, api]),
            ("registerSubscriber", [node, topic, source.choice(["*", "a/B", "c/D"]), api]),
            ("unregisterSubscriber", [node, topic, api]),
            ("registerService", [node, topic, ROSRPC, api]),
            ("unregisterService", [node, topic, ROSRPC]),
            ("lookupService", [node, topic]),
            ("lookupNode", [node, source.choice(NODES)]),
            ("getSystemState", [node]),
            ("getTopicTypes", [node]),
            ("getPublishedTopics", [node, source.choice(["", "/ns", "/"])]),
            ("setParam", [node, key, value]),
            ("getParam", [node, key]),
            ("deleteParam", [node, key]),
            ("hasParam", [node, key]),
            ("searchParam", [node, key]),
            ("getParamNames", [node]),
            ("subscribeParam", [node, api, key]),
            ("unsubscribeParam", [node, api, key]),
        ]
    )


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_random_calls_are_answered_alike(masters: tuple[str, str], seed: int) -> None:
    debian, ours = masters
    source = random.Random(seed)
    done: list[Call] = []
    for _ in range(400):
        method, params = random_call(source)
        done.append((method, params))
        theirs, mine = ask(debian, method, params), ask(ours, method, params)
        assert theirs == mine, f"seed {seed}, after {done[-8:]}"


class Slave:
    """A node's slave API that notes what it is told, as (method, parameters)."""

    def __init__(self) -> None:
        self.calls: list[Call] = []
        handler = xmlrpc.server.SimpleXMLRPCRequestHandler
        self._server = xmlrpc.server.SimpleXMLRPCServer(
            ("127.0.0.1", 0), handler, logRequests=False, allow_none=True
        )
        self._server.register_instance(self)
        host, port = self._server.server_address[:2]
        self.uri = f"http://{host!s}:{port}/"
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.02,), daemon=True)
        self._thread.start()

    def _dispatch(self, method: str, params: tuple[Any, ...]) -> list[Any]:
        self.calls.append((method, list(params)))
        return [1, "", 0]

    def take_until_marked(self, master: str) -> list[Call]:
        """What it was told up to now: a call of its own, sent behind, tells that everything has been delivered."""
        ask(master, "registerSubscriber", ["/mark", "/mark", "a/B", self.uri])
        for method, publishers in (("registerPublisher", [self.uri]), ("unregisterPublisher", [])):
            kind = ["a/B"] if publishers else []
            ask(master, method, ["/mark_p", "/mark", *kind, self.uri])
            mark = ("publisherUpdate", ["/master", "/mark", publishers])
            wait_until(lambda mark=mark: mark in self.calls, "the mark is delivered")  # type: ignore[misc]
        taken, self.calls = self.calls, []
        return [call for call in taken if "/mark" not in call[1]]

    def close(self) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join(5)


def free_uri() -> str:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"http://127.0.0.1:{probe.getsockname()[1]}/"


TOLD: list[Call] = [
    ("registerSubscriber", ["/s", "/t", "a/B", "SLAVE"]),
    ("registerPublisher", ["/p1", "/t", "a/B", A]),
    ("registerPublisher", ["/p2", "/t", "a/B", B]),
    ("unregisterPublisher", ["/p1", "/t", A]),
    ("unregisterPublisher", ["/p1", "/t", A]),
    ("subscribeParam", ["/s", "SLAVE", "/ns"]),
    ("subscribeParam", ["/s", "SLAVE", "/ns/a/b"]),
    ("setParam", ["/x", "/ns", {"a": {"b": 1}}]),
    ("setParam", ["/x", "/ns/a/b", 2]),
    ("setParam", ["/x", "/ns/other", [1]]),
    ("setParam", ["/s", "/ns/other", "own change"]),
    ("setParam", ["/x", "/unrelated", 1]),
    ("deleteParam", ["/x", "/ns/a"]),
    ("setParam", ["/x", "/", {"ns": {"a": {"b": 4}}}]),
    ("unsubscribeParam", ["/s", "SLAVE", "/ns"]),
    ("setParam", ["/x", "/ns/a/c", 5]),
    ("registerSubscriber", ["/s", "/t", "a/B", "OTHER"]),
]


def test_nodes_are_told_the_same(masters: tuple[str, str]) -> None:
    """At the end the node is replaced by another of its name.

    Ours says once what rosmaster says twice to a node that subscribes both a parameter and one around it.
    """
    told = []
    for master in masters:
        slave = Slave()
        other = free_uri()
        try:
            lines = []
            for method, params in TOLD:
                given = [slave.uri if one == "SLAVE" else other if one == "OTHER" else one for one in params]
                assert ask(master, method, given)[0] == 1
                caused = slave.take_until_marked(master)
                lines.append((method, sorted(set(map(repr, caused)))))
            told.append(lines)
        finally:
            slave.close()
    for theirs, mine in zip(*told, strict=True):
        assert theirs == mine
