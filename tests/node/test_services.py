"""Services and their clients over loopback."""

from __future__ import annotations

import asyncio
import threading
import time
from typing import Any

import pytest

import roslet
from nodes import Nodes, descriptors, ros1, wait_until

ADD = "rospy_tutorials/AddTwoInts"


def offered(make: Nodes) -> tuple[roslet.Node, roslet.Node, roslet.Service]:
    """A server that spins in a thread, and a client's node."""
    server, user = make("server"), make("user")
    service = server.service("add", ADD, lambda request: {"sum": request.a + request.b})
    server.start()
    return server, user, service


def test_a_call_gets_its_response(make: Nodes) -> None:
    _, user, service = offered(make)
    client = user.client("add", ADD)
    assert client.wait(2)
    assert client.call(a=1, b=2, timeout=3).sum == 3
    assert client.call({"a": 3, "b": 4}, timeout=3).sum == 7
    assert client.call(client.type.Request(a=5, b=6), timeout=3).sum == 11
    assert service.calls == 3


def test_a_call_that_is_not_persistent_leaves_no_connection(make: Nodes) -> None:
    server, user, _ = offered(make)
    client = user.client("add", ADD)
    client.call(a=1, b=2, timeout=3)
    time.sleep(0.05)
    before = descriptors()
    for _ in range(30):
        client.call(a=1, b=2, timeout=3)
    wait_until(lambda: descriptors() <= before, "no descriptor is left")
    assert ros1(server).engine.services["/add"].links == []


def test_a_persistent_client_keeps_one_connection_and_several_calls_in_flight(make: Nodes) -> None:
    server, user, _ = offered(make)
    with user.client("add", ADD, persistent=True) as client:
        client.call(a=0, b=0, timeout=3)
        futures = [client.call_async(a=index, b=index) for index in range(50)]
        assert [future.result(3).sum for future in futures] == [2 * index for index in range(50)]
        assert len(ros1(server).engine.services["/add"].links) == 1
    wait_until(
        lambda: ros1(server).engine.services["/add"].links == [], "the connection ends with the client"
    )
    with pytest.raises(roslet.NodeClosed):
        client.call(a=1, b=1)


def test_a_persistent_client_connects_again_after_the_server_came_back(make: Nodes) -> None:
    server, user, _ = offered(make)
    client = user.client("add", ADD, persistent=True)
    assert client.call(a=1, b=1, timeout=3).sum == 2
    server.close()
    with pytest.raises((roslet.Fault, roslet.ServiceFailed)):
        client.call(a=1, b=1, timeout=3)
    again = make("server")
    again.service("add", ADD, lambda request: {"sum": 42})
    again.start()
    assert client.call(a=1, b=1, timeout=3).sum == 42


def test_what_a_handler_raises_reaches_the_caller_as_text(make: Nodes) -> None:
    server, user, _ = offered(make)

    def handler(request: Any) -> Any:
        if request.a == 1:
            raise ValueError("one is not allowed: \u00fc \udcff")
        if request.a == 2:
            raise ValueError
        if request.a == 3:
            return "nonsense"
        if request.a == 4:
            return {"sum": "text"}
        return None

    server.service("odd", ADD, handler)
    client = user.client("odd", ADD, persistent=True)
    for a, text in (
        (1, "one is not allowed: \u00fc \\?"),
        (2, "ValueError"),
        (3, "a response is rospy_tutorials/AddTwoIntsResponse, not str"),
        (4, "sum"),
    ):
        with pytest.raises(roslet.ServiceFailed, match=text):
            client.call(a=a, timeout=3)
    assert client.call(a=5, timeout=3).sum == 0, "None is an empty response; the service has survived"
    assert server.counters["handler-raised"] == 4


def test_a_service_that_is_not_there_says_so_at_once(make: Nodes) -> None:
    user = make("user")
    client = user.client("nothing", ADD)
    with pytest.raises(roslet.Fault, match="provider"):
        client.call(a=1, b=1, timeout=3)
    begin = time.monotonic()
    assert not client.wait(0.3)
    assert 0.2 < time.monotonic() - begin < 1.0


def test_a_call_that_is_not_answered_times_out_and_is_forgotten(make: Nodes) -> None:
    server, user = make("server"), make("user")
    release = threading.Event()

    def handler(request: Any) -> None:
        release.wait(5)

    server.service("slow", ADD, handler)
    server.start()
    client = user.client("slow", ADD)
    with pytest.raises(roslet.CallTimeout, match=r"service /slow: no response within 0\.2 s"):
        client.call(timeout=0.2)
    release.set()
    wait_until(
        lambda: (
            not any(
                kind == "out" and "ServiceClientLink" in type(stream.machine).__name__
                for stream, kind in ros1(user).shell.streams.items()
            )
        ),
        "the connection is given up",
    )


def test_a_wrong_type_is_refused_with_both_md5sums(make: Nodes) -> None:
    server, user, _ = offered(make)
    client = user.client("add", "std_srvs/Empty")
    with pytest.raises(
        roslet.HandshakeRefused, match="has md5sum 6a2e34150c00229791cc89ff309fff21, the client expects"
    ):
        client.call(timeout=3)
    assert server.counters == {"md5sum-mismatch": 1}
    with pytest.raises(TypeError, match="takes std_srvs/EmptyRequest"):
        client.call(5)  # type: ignore[arg-type, unused-ignore]


def test_a_callback_may_call_a_service_of_another_thread(make: Nodes, master: Any) -> None:
    import subprocess
    import sys

    program = (
        "import roslet\n"
        f"node = roslet.Node('elsewhere', network='ros1://127.0.0.1:{master.port}')\n"
        "node.service('add', 'rospy_tutorials/AddTwoInts', lambda r: {'sum': r.a + r.b})\n"
        "print('ready', flush=True)\n"
        "node.spin()\n"
    )
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, env=_environment())
    try:
        assert process.stdout is not None and process.stdout.readline() == b"ready\n"
        user = make("user")
        client = user.client("add", ADD)
        sums: list[int] = []
        user.subscribe(
            "numbers",
            "std_msgs/Int32",
            lambda message: sums.append(client.call(a=message.data, b=1, timeout=3).sum),
        )
        publisher = user.publisher("numbers", "std_msgs/Int32")
        for index in range(5):
            publisher.publish(data=index)
        wait_until(lambda: len(sums) == 5, "all calls are answered")
        assert sums == [1, 2, 3, 4, 5]
        timer_sums: list[int] = []
        user.timer(0.01, lambda: timer_sums.append(client.call(a=1, b=1, timeout=3).sum), once=True)
        wait_until(lambda: timer_sums == [2], "a timer may call too")
    finally:
        process.kill()
        process.wait()


def _environment() -> dict[str, str]:
    import os
    import pathlib

    source = pathlib.Path(__file__).resolve().parent.parent.parent / "src"
    return {**os.environ, "PYTHONPATH": str(source)}


def test_a_future_can_be_awaited(make: Nodes) -> None:
    _, user, _ = offered(make)
    client = user.client("add", ADD)

    async def main() -> list[int]:
        futures = [client.call_async(a=index, b=1) for index in range(5)]
        return [(await asyncio.wait_for(_wrap(future), 3)).sum for future in futures]

    async def _wrap(future: Any) -> Any:
        return await future

    assert asyncio.run(main()) == [1, 2, 3, 4, 5]


def test_closing_the_node_fails_a_call_under_way(make: Nodes) -> None:
    server, user = make("server"), make("user")
    server.service("slow", ADD, lambda request: time.sleep(1.0))
    server.start()
    future = user.client("slow", ADD).call_async()
    time.sleep(0.2)
    begin = time.monotonic()
    user.close()
    with pytest.raises(roslet.RosletError):
        future.result(2)
    assert time.monotonic() - begin < 0.9


def test_a_closed_service_is_withdrawn(make: Nodes) -> None:
    server, user, service = offered(make)
    service.close()
    service.close()
    wait_until(lambda: user.lookup_service("add") is None, "the master forgets it")
    with pytest.raises(roslet.Fault):
        user.client("add", ADD).call(timeout=3)
    with server.service("add", ADD, lambda request: {"sum": 1}):
        assert user.client("add", ADD).call(timeout=3).sum == 1
    with pytest.raises(roslet.RosletError, match="already offers"), server.service("x", ADD, print):
        server.service("x", ADD, print)


def test_a_done_callback_runs_once_whenever_it_is_added(make: Nodes) -> None:
    _, user, _ = offered(make)
    future = user.client("add", ADD).call_async(a=1, b=1)
    seen: list[int] = []
    future.add_done_callback(lambda done: seen.append(1))
    assert future.result(3).sum == 2 and future.done() and future.exception() is None
    future.add_done_callback(lambda done: seen.append(2))
    assert seen == [1, 2]
