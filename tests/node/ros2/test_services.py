"""Services of ROS 2 nodes without any peer: within one process, and between two participants of it."""

from __future__ import annotations

import time
from typing import Any

import pytest

import roslet
from nodes import wait_until
from ros2_nodes import Ros2Nodes
from roslet.engine.rtps.history import HistoryFull
from roslet.node.future import Future
from roslet.node.ros2 import services

SET_BOOL = "std_srvs/srv/SetBool"


def answer(request: Any) -> dict[str, Any]:
    return {"success": request.data, "message": "yes" if request.data else "no"}


@pytest.fixture(params=["one participant", "two participants"])
def two(request: pytest.FixtureRequest, make2: Ros2Nodes) -> tuple[roslet.Node, roslet.Node]:
    arguments = () if request.param == "one participant" else ("--enclave", "/k")
    return make2("server"), make2("client", *arguments)


def test_every_call_gets_its_own_answer(two: tuple[roslet.Node, roslet.Node]) -> None:
    server, caller = two
    service = server.service("/ask", SET_BOOL, answer)
    client = caller.client("/ask", SET_BOOL)
    assert client.wait(timeout=8)
    server.start()
    futures = [client.call_async(data=k % 2 == 0) for k in range(100)]
    assert [future.result(8).success for future in futures] == [k % 2 == 0 for k in range(100)]
    assert service.calls == 100


def test_a_call_waits_for_a_server_and_finds_it(two: tuple[roslet.Node, roslet.Node]) -> None:
    server, caller = two
    client = caller.client("/ask", SET_BOOL)
    future = client.call_async(data=True)
    assert not client.wait(timeout=0)
    server.service("/ask", SET_BOOL, answer)
    server.start()
    assert future.result(8).message == "yes"


def test_a_call_ends_with_its_timeout_and_is_forgotten(two: tuple[roslet.Node, roslet.Node]) -> None:
    """Nobody serves it, then somebody who never answers; the next call is not harmed."""
    server, caller = two
    client = caller.client("/ask", SET_BOOL)
    begin = time.monotonic()
    with pytest.raises(roslet.CallTimeout, match=r"service /ask: no response within 0.2 s"):
        client.call(data=True, timeout=0.2)
    assert 0.2 <= time.monotonic() - begin < 5
    calls: list[bool] = []

    def fail(request: Any) -> dict[str, Any]:
        calls.append(request.data)
        if len(calls) == 1:
            raise ValueError("no")
        return answer(request)

    server.service("/ask", SET_BOOL, fail)
    server.start()
    assert client.wait(timeout=8)
    with pytest.raises(roslet.CallTimeout):
        client.call(data=False, timeout=0.5)
    assert client.call(data=True, timeout=8).message == "yes"
    assert calls == [False, True]  # the one that was given up before there was a server is not among them
    assert server.counters["handler-raised"] == 1


def test_a_server_that_goes_is_noticed_and_one_that_returns_is_used(
    two: tuple[roslet.Node, roslet.Node],
) -> None:
    server, caller = two
    client: Any = caller.client("/ask", SET_BOOL)
    server.start()
    for _ in range(3):
        with server.service("/ask", SET_BOOL, answer):
            assert client.wait(timeout=8)
            assert client.call(data=True, timeout=8).success
        wait_until(lambda: not client.ready(), "it is noticed that the server has gone")


def test_closing_the_node_ends_its_calls(two: tuple[roslet.Node, roslet.Node]) -> None:
    _, caller = two
    client = caller.client("/ask", SET_BOOL)
    future = client.call_async(data=True)
    caller.close()
    with pytest.raises(roslet.NodeClosed):
        future.result(1)
    with pytest.raises(roslet.NodeClosed):
        client.call_async(data=True)


def test_a_predicate_may_ask_whether_a_service_is_there(make2: Ros2Nodes) -> None:
    """It is looked at while another thread has the loop as well."""
    node, other = make2("node"), make2("other")
    client = other.client("/late", "std_srvs/srv/Trigger")
    asked: list[bool] = []

    def there() -> bool:
        asked.append(client.wait(0.0))
        return asked[-1]

    node.start()
    node.timer(0.1, lambda: node.service("/late", "std_srvs/srv/Trigger", lambda request: None), once=True)
    assert other.spin_until(there, 5.0)
    assert asked[0] is False and client.ready()


def test_requests_that_nobody_serves_and_replies_that_nobody_takes_are_counted(
    make2: Ros2Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    server, caller = make2("server"), make2("client", "--enclave", "/k")
    service: Any = server.service("/ask", SET_BOOL, answer)
    client = caller.client("/ask", SET_BOOL)
    assert client.wait(timeout=8)
    monkeypatch.setattr(services, "MAX_REQUESTS", 1)
    calls = [client.call_async(data=True) for _ in range(2)]
    reactor = server.reactor
    assert reactor.run_until(lambda: server.counters.get("requests-full") == 1, 8, user=False)

    def full(*given: Any) -> bool:
        raise HistoryFull("full")

    monkeypatch.setattr(service._server, "reply", full)
    wait_until(lambda: server.counters.get("reply-history-full") == 1, "the reply is dropped")
    assert not any(one.done() for one in calls)


def test_closing_a_client_ends_its_calls(make2: Ros2Nodes) -> None:
    """That which waits for a server, and that which waits for an answer."""
    server, caller = make2("server"), make2("client", "--enclave", "/k")
    client: Any = caller.client("/ask", SET_BOOL)
    waiting = client.call_async(data=True)
    client.close()
    with pytest.raises(roslet.NodeClosed, match="the client of /ask is closed"):
        waiting.result(1)
    asked: list[Any] = []

    def later(request: Any) -> Future[Any]:
        asked.append(request)
        return Future(server.reactor, "never")

    server.service("/ask", SET_BOOL, later)
    client = caller.client("/ask", SET_BOOL)
    assert client.wait(timeout=8)
    sent = client.call_async(data=True)
    wait_until(lambda: asked, "it is asked")
    client.close()
    with pytest.raises(roslet.NodeClosed, match="the client of /ask is closed"):
        sent.result(1)


def test_a_service_of_another_type_is_not_called(two: tuple[roslet.Node, roslet.Node]) -> None:
    server, caller = two
    other = server.service("/ask", "std_srvs/srv/Trigger", lambda request: None)
    client = caller.client("/ask", SET_BOOL)
    future = client.call_async(data=True)
    assert not client.wait(timeout=0.2)
    server.service("/ask", SET_BOOL, answer)
    server.start()
    assert future.result(8).message == "yes"
    assert other.calls == 0 and "malformed-request" not in server.counters
