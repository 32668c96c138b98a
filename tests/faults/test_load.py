"""Too much of something: slow readers, connections without number, floods."""

from __future__ import annotations

import resource
import struct
import subprocess
import sys
import threading
import time
from typing import Any

import pytest

import roslet
from faults.test_peers import MD5, STRING, healthy
from nodes import Nodes, Raw, descriptors, entry_of, ports, ros1, serve, string_subscriber, wait_until
from roslet.io import ros1 as shell


def memory() -> int:
    """Bytes of this process that are in memory."""
    with open("/proc/self/statm") as stream:
        return int(stream.read().split()[1]) * resource.getpagesize()


def test_a_slow_reader_costs_a_bounded_queue_and_harms_nobody(make: Nodes) -> None:
    a, b = make("a"), make("b")
    publisher = a.publisher("chatter", STRING, qos=10)
    got: list[int] = []
    b.subscribe("chatter", STRING, lambda message: got.append(int(message.data[:8])))
    b.start()
    with string_subscriber(a, "/chatter") as stuck:
        stuck.read_header()
        wait_until(lambda: publisher.subscriber_count == 2, "both are connected")
        publisher.publish(data="00000000" + "x" * 100_000)
        begin, before = time.monotonic(), memory()
        longest = 0.0
        for index in range(1, 500):
            start = time.monotonic()
            publisher.publish(data=f"{index:08} " + "x" * 100_000)
            longest = max(longest, time.monotonic() - start)
            time.sleep(0.001)
        took = time.monotonic() - begin
        (link,) = [one for one in entry_of(publisher).links if one.callerid == "/raw"]
        assert len(link.queue) <= 11 and link.queue.high_water <= 11
        dropped = publisher.statistics["dropped"]
        assert dropped > 300 and a.counters == {"send-queue-full": dropped}
        assert memory() - before < 30_000_000
        wait_until(lambda: got and got[-1] == 499, "the other reader has the last message")
        others = [one.queue.dropped for one in entry_of(publisher).links if one is not link]
        assert len(got) + sum(others) == 500
        assert took < 5 and longest < 0.3
        numbers: list[int] = []
        while (
            not numbers or numbers[-1] != 499
        ):  # it wakes up: what it gets is whole, in order, and ends with the newest
            numbers.append(int(stuck.read_frame()[4:12]))
        assert numbers == sorted(set(numbers)) and len(numbers) + link.queue.dropped == 500


def test_a_subscriber_that_reads_slowly_does_not_slow_the_publisher_down(make: Nodes) -> None:
    a = make("a")
    publisher = a.publisher("image", STRING, qos=2)
    stop = threading.Event()
    with string_subscriber(a, "/image") as slow:
        slow.read_header()
        wait_until(lambda: publisher.subscriber_count == 1, "it is connected")

        def trickle() -> None:
            while not stop.is_set():
                slow.sock.recv(100_000)
                time.sleep(0.005)  # 20 MB/s

        thread = threading.Thread(target=trickle)
        thread.start()
        try:
            text = "x" * 5_000_000
            times = []
            for _ in range(10):
                begin = time.monotonic()
                publisher.publish(data=text)
                times.append(time.monotonic() - begin)
                time.sleep(0.01)
            assert sorted(times)[5] < 0.1, times
        finally:
            stop.set()
            thread.join()


@pytest.mark.parametrize("which", [0, 1])
def test_a_thousand_connections_opened_and_abandoned_leave_no_descriptor(make: Nodes, which: int) -> None:
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    port = ports(a)[which]
    before = descriptors()
    for turn in range(10):
        raws = [Raw(port) for _ in range(100)]
        for index, raw in enumerate(raws):
            if index % 3 == 0:
                raw.send(b"\x00" if which else b"POST ")
            if index % 3 == 1 and turn % 2:
                raw.sock.setsockopt(6, 8, 1)
        if turn == 5:
            healthy(a, publisher)
        for raw in raws:
            raw.close()
    healthy(a, publisher)
    wait_until(lambda: descriptors() <= before + 2, "no descriptor is left")
    if which:
        assert a.counters["closed-before-header"] == 1000


@pytest.mark.parametrize("which", [0, 1])
def test_connections_that_stay_and_say_nothing_make_room_for_those_that_speak(
    make: Nodes, which: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shell, "MAX_CONNECTIONS", 50)
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    raws = [Raw(ports(a)[which]) for _ in range(120)]
    serve(0.1)
    assert a.counters["connection-evicted"] >= 70
    assert ros1(a).shell._accepted[("rpc", "tcpros")[which]] <= 50
    healthy(a, publisher)
    for raw in raws:
        raw.close()
    wait_until(
        lambda: ros1(a).shell._accepted == {"rpc": 0, "tcpros": 0} or ros1(a).shell._accepted["tcpros"] == 0,
        "all are gone",
    )


def test_subscribers_are_not_evicted_and_one_too_many_is_refused(
    make: Nodes, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shell, "MAX_CONNECTIONS", 5)
    a = make("a")
    publisher = a.publisher("chatter", STRING)
    raws = []
    for count in range(1, 6):
        raw = string_subscriber(a, "/chatter")
        raw.read_header()
        wait_until(lambda count=count: publisher.subscriber_count == count, "it is connected")  # type: ignore[misc]
        raws.append(raw)
    with Raw(ports(a)[1]) as late:
        assert late.at_end()
    assert a.counters == {"too-many-connections": 1}
    publisher.publish(data="fine")
    for raw in raws:
        assert raw.read_frame() == b"\x04\0\0\0fine"
        raw.close()


def test_a_process_without_descriptors_serves_again_when_it_has_some(master: Any) -> None:
    program = f"""
import os, resource, socket, time, roslet
node = roslet.Node("a", network="ros1://127.0.0.1:{master.port}")
publisher = node.publisher("t", "std_msgs/String")
node.start()
limit = len(os.listdir("/proc/self/fd")) + 6
resource.setrlimit(resource.RLIMIT_NOFILE, (limit, limit))
port = node._network.engine.tcpros_port
peer = os.popen  # nothing: peers live in another process
print(port, flush=True)
input()
print(sorted(node.counters), flush=True)
input()
"""
    from node.test_services import _environment

    process = subprocess.Popen(
        [sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=_environment()
    )
    assert process.stdin is not None and process.stdout is not None
    try:
        port = int(process.stdout.readline())
        raws = [Raw(port) for _ in range(30)]
        for raw in raws[:3]:
            raw.send_header(callerid="/raw", md5sum=MD5, topic="/t", type=STRING)
        time.sleep(0.5)
        process.stdin.write(b"\n")
        process.stdin.flush()
        assert b"no-descriptors" in process.stdout.readline()
        for raw in raws:
            raw.close()
        with Raw(port) as raw:
            raw.send_header(callerid="/raw", md5sum=MD5, topic="/t", type=STRING)
            assert raw.read_header()["md5sum"] == MD5
    finally:
        process.kill()
        process.wait()


def test_a_client_that_floods_a_service_and_reads_nothing_costs_bounded_memory(make: Nodes) -> None:
    a = make("a")
    calls = [0]

    def handler(request: Any) -> dict[str, Any]:
        calls[0] += 1
        return {"success": True, "message": "x" * 500_000}

    a.service("big", "std_srvs/Trigger", handler)
    a.start()
    with Raw(ports(a)[1]) as raw:
        raw.send_header(callerid="/raw", md5sum="*", service="/big", persistent="1")
        raw.read_header()
        before = memory()
        raw.sock.setblocking(False)
        flood = struct.pack("<I", 0) * 10_000
        end = time.monotonic() + 1
        while time.monotonic() < end:
            try:
                raw.sock.send(flood)
            except BlockingIOError:
                time.sleep(0.01)
        assert memory() - before < 60_000_000
        answered = calls[0]
        assert answered < 100
        raw.sock.settimeout(5)
        for _ in range(answered + 20):  # it begins to read, and the service goes on
            assert raw.read(1) == b"\x01"
            assert len(raw.read_frame()) == 500_005
    client = make("b").client("big", "std_srvs/Trigger")
    assert client.call(timeout=5).success


def test_a_flood_of_parameter_changes_with_nobody_spinning_is_bounded(make: Nodes, master: Any) -> None:
    a, b = make("a"), make("b")
    a.on_parameter("/p", lambda value: None)
    for index in range(1500):
        b.call_node(a.uri, "paramUpdate", "/p", index)
    assert len(a.reactor._user_soon) <= 1100
    assert a.counters == {"too-many-callbacks": 500}


def test_a_list_of_a_hundred_thousand_publishers_is_bounded(make: Nodes) -> None:
    a, b = make("a"), make("b")
    subscription = a.subscribe("chatter", STRING)
    uris = [f"http://127.0.0.1:{1 + index % 60000}/x{index}" for index in range(20_000)]
    before = descriptors()
    b.call_node(a.uri, "publisherUpdate", "/chatter", uris, timeout=10)
    assert len(entry_of(subscription).publishers) == 1000
    most = 0
    for _ in range(20):
        serve(0.02)
        most = max(most, descriptors() - before)
    assert most < 100
    assert a.counters["too-many-publishers"] == 1
    begin = time.monotonic()
    a.close()
    assert time.monotonic() - begin < 1
    assert isinstance(a, roslet.Node)
