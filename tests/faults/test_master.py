"""Masters that are not there, come late, or are restarted; peers that die."""

from __future__ import annotations

import subprocess
import sys
import time
from typing import Any

import pytest

import roslet
from node.test_services import _environment
from nodes import Nodes, serve, wait_until
from roslet.master.server import MasterServer

STRING = "std_msgs/String"


def state(master: MasterServer) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for part in master.call("getSystemState", "/test")[2]:
        for name, who in part:
            found.setdefault(name, []).extend(who)
    return {name: sorted(who) for name, who in found.items() if name != "/rosout"}


def test_a_node_that_starts_before_its_master_says_so_and_works_when_it_comes(
    capfd: pytest.CaptureFixture[str],
) -> None:
    with MasterServer(port=0) as probe:
        port = probe.port
    network = f"ros1://127.0.0.1:{port}"
    begin = time.monotonic()
    a = roslet.Node("a", network=network, arguments=["_rate:=5"])
    b = roslet.Node("b", network=network)
    try:
        publisher = a.publisher("chatter", STRING)
        got: list[Any] = []
        b.subscribe("chatter", STRING, got.append)
        a.service("empty", "std_srvs/Empty", lambda request: None)
        assert time.monotonic() - begin < 3, "nothing waits for it longer than a moment"
        client = b.client("empty", "std_srvs/Empty")
        assert not client.wait(0.2)
        with pytest.raises(roslet.Unreachable):
            b.get_parameter("/x")
        text = capfd.readouterr().err
        assert (
            text.count(f"cannot reach the master at http://127.0.0.1:{port}") == 2
            and "waiting for it" in text
        )
        with MasterServer(port=port) as master:
            wait_until(lambda: publisher.subscriber_count == 1, "they find each other")
            publisher.publish(data="x")
            wait_until(lambda: got, "the message arrives")
            assert state(master) == {"/chatter": ["/a", "/b"], "/empty": ["/a"]}
            wait_until(lambda: master.call("getParam", "/test", "/a/rate")[2] == 5, "its parameter is set")
            a.close()
            b.close()
            assert state(master) == {}
    finally:
        a.close()
        b.close()


def test_after_a_restart_of_the_master_everything_is_registered_again() -> None:
    first = MasterServer(port=0)
    network = f"ros1://127.0.0.1:{first.port}"
    a, b = roslet.Node("a", network=network), roslet.Node("b", network=network)
    a.log.quiet = b.log.quiet = True
    try:
        publisher = a.publisher("chatter", STRING)
        got: list[str] = []
        b.subscribe("chatter", STRING, lambda message: got.append(message.data))
        a.service("empty", "std_srvs/Empty", lambda request: None)
        seen: list[Any] = []
        b.on_parameter("/p", seen.append)
        assert publisher.wait_for_subscribers(1, 3)
        before = state(first)
        first.close()
        serve(0.3)
        with MasterServer(port=first.port) as second:
            for index in range(60):
                publisher.publish(data=str(index))
                serve(0.05)
            assert state(second) == before == {"/chatter": ["/a", "/b"], "/empty": ["/a"]}
            assert got == [str(index) for index in range(60)], "no message was lost meanwhile"
            second.call("setParam", "/test", "/p", 7)
            wait_until(lambda: seen == [7], "the parameter is watched again")
            a.close()
            b.close()
    finally:
        a.close()
        b.close()
        first.close()


def peer(master: MasterServer, program: str) -> subprocess.Popen[bytes]:
    text = f"import roslet, time\nnode = roslet.Node('peer', network='ros1://127.0.0.1:{master.port}')\n{program}"
    process = subprocess.Popen(
        [sys.executable, "-c", text], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=_environment()
    )
    assert process.stdout is not None and process.stdout.readline() == b"ready\n"
    return process


PUBLISH = """
publisher = node.publisher('chatter', 'std_msgs/String')
print('ready', flush=True)
while True:
    publisher.publish(data='x' * 1_000_000)
    node.sleep(0.001)
"""


def test_a_publisher_killed_in_full_swing_is_found_again_when_it_returns(
    make: Nodes, master: MasterServer
) -> None:
    a = make("a")
    sizes: set[int] = set()
    count = [0]

    def callback(message: Any) -> None:
        count[0] += 1
        sizes.add(len(message.data))

    subscription = a.subscribe("chatter", STRING, callback)
    for _ in range(2):
        process = peer(master, PUBLISH)
        try:
            have = count[0]
            wait_until(lambda have=have: count[0] > have + 20, "messages come")  # type: ignore[misc]
        finally:
            process.kill()
            process.wait()
        wait_until(lambda: subscription.publisher_count == 0, "its end is seen")
    assert sizes == {1_000_000}, "nothing but whole messages"
    assert set(a.counters) <= {"publisher-lost", "frame-truncated"}


def test_a_subscriber_killed_in_full_swing_leaves_the_publisher_well(
    make: Nodes, master: MasterServer
) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    for history in range(2):
        process = peer(
            master,
            "node.subscribe('chatter', 'std_msgs/String', lambda m: None)\nprint('ready', flush=True)\nnode.spin()",
        )
        try:
            wait_until(lambda: publisher.subscriber_count == 1, "it is connected")
            for index in range(50):
                publisher.publish(data="x" * 3_000_000)
                if index == 25:
                    process.kill()
        finally:
            process.kill()
            process.wait()
        wait_until(lambda: publisher.subscriber_count == 0, "its end is seen")
        assert history in (0, 1)
    assert set(a.counters) <= {"send-queue-full", "queued-for-lost-subscriber"}


def test_a_subscriber_killed_while_publishing_in_a_callback_does_not_hang_the_loop(
    make: Nodes, master: MasterServer
) -> None:
    """The publishing thread is the loop itself, so nobody else will close the connection meanwhile."""
    for qos in (roslet.QoS(), roslet.QoS(history="keep_all")):
        a = make("a", anonymous=True)
        publisher = a.publisher("chatter", STRING, qos=qos)
        process = peer(
            master,
            "node.subscribe('chatter', 'std_msgs/String', lambda m: None)\nprint('ready', flush=True)\ntime.sleep(60)",
        )
        try:
            wait_until(lambda publisher=publisher: publisher.subscriber_count == 1, "it is connected")  # type: ignore[misc]
            sent = [0]

            def publish(
                publisher: roslet.Publisher = publisher, process: Any = process, sent: list[int] = sent
            ) -> None:
                sent[0] += 1
                if sent[0] == 2:
                    process.kill()
                    process.wait()
                publisher.publish(data="x" * 6_000_000)

            begin = time.monotonic()
            if qos.history == "keep_all":
                a.timer(0.05, process.kill, once=True)
                time.sleep(0.06)
            a.timer(0.01, publish)
            wait_until(lambda sent=sent: sent[0] >= 5, "the loop goes on")  # type: ignore[misc]
            wait_until(lambda publisher=publisher: publisher.subscriber_count == 0, "its end is seen")  # type: ignore[misc]
            assert time.monotonic() - begin < 5
        finally:
            process.kill()
            process.wait()
            a.close()
