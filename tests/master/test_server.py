"""The master on sockets: bad clients, dead nodes, many connections, a clean end."""

from __future__ import annotations

import os
import pathlib
import random
import signal
import socket
import subprocess
import sys
import threading
import time
import xmlrpc.client
import xmlrpc.server
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from roslet.engine.ros1.rpc import RpcServer
from roslet.io.select import Reactor
from roslet.master.server import MasterServer, run

PATIENCE = 10.0
SOURCE = str(pathlib.Path(__file__).resolve().parents[2] / "src")


def wait_until(predicate: Callable[[], object], what: str) -> None:
    end = time.monotonic() + PATIENCE
    while not predicate():
        assert time.monotonic() < end, f"{what}: not within {PATIENCE} s"
        time.sleep(0.005)


def proxy_of(uri: str) -> Any:
    """The standard library's client; what it returns has no useful type."""
    return xmlrpc.client.ServerProxy(uri)


@pytest.fixture
def loop() -> Iterator[Reactor]:
    made = Reactor()
    yield made
    made.close()


@pytest.fixture
def master(loop: Reactor) -> Iterator[MasterServer]:
    with MasterServer("127.0.0.1", 0, loop, notification_timeout=1.0) as started:
        yield started


@pytest.fixture
def proxy(master: MasterServer) -> Iterator[Any]:
    with proxy_of(master.uri) as made:
        yield made


class Slave:
    """A node's slave API; notes (method, parameters after the caller)."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, list[Any]]] = []
        self._server = xmlrpc.server.SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False, allow_none=True)
        self._server.register_instance(self)
        self.uri = f"http://127.0.0.1:{self._server.server_address[1]}/"
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.01,), daemon=True)
        self._thread.start()

    def _dispatch(self, method: str, params: tuple[Any, ...]) -> list[Any]:
        self.calls.append((method, list(params[1:])))
        return [1, "", 0]

    def close(self) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join(PATIENCE)


@pytest.fixture
def slave() -> Iterator[Slave]:
    made = Slave()
    yield made
    made.close()


def connect(master: MasterServer) -> socket.socket:
    sock = socket.create_connection(("127.0.0.1", master.port))
    sock.settimeout(PATIENCE)
    return sock


def descriptors() -> int:
    return len(os.listdir("/proc/self/fd"))


def test_the_standard_librarys_client_works_over_one_connection(master: MasterServer, proxy: Any) -> None:
    for number in range(20):
        assert proxy.setParam("/n", f"/k{number}", [number]) == [1, f"parameter /k{number} set", 0]
    assert proxy.getUri("/n") == [1, "", master.uri]
    assert proxy.getPid("/n") == [1, "", os.getpid()]
    assert master.connections == 1


def test_the_address_in_the_environment_is_advertised(loop: Reactor, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_IP", "10.9.8.7")
    with MasterServer("127.0.0.1", 0, loop) as master:
        assert master.uri == f"http://10.9.8.7:{master.port}/"
    monkeypatch.setenv("ROS_HOSTNAME", "robot.example")
    with MasterServer("127.0.0.1", 0, loop) as master:
        assert master.uri == f"http://robot.example:{master.port}/"


def test_nodes_are_told_in_order_and_the_latest_state_wins(master: MasterServer, slave: Slave) -> None:
    master.call("registerSubscriber", "/s", "/t", "a/B", slave.uri)
    for number in range(50):
        master.call("registerPublisher", f"/p{number}", "/t", "a/B", f"http://127.0.0.1:{number + 1}/")
    wait_until(lambda: slave.calls and len(slave.calls[-1][1][1]) == 50, "the last update arrives")
    sizes = [len(call[1][1]) for call in slave.calls]
    assert sizes == sorted(set(sizes))


def test_a_node_that_does_not_answer_delays_no_other(master: MasterServer, slave: Slave) -> None:
    with socket.socket() as deaf:
        deaf.bind(("127.0.0.1", 0))
        deaf.listen(1)
        master.call("registerSubscriber", "/deaf", "/t", "a/B", f"http://127.0.0.1:{deaf.getsockname()[1]}/")
        master.call("registerSubscriber", "/refuses", "/t", "a/B", "http://127.0.0.1:1/")
        master.call("registerSubscriber", "/unknown", "/t", "a/B", "http://host.invalid:1/")
        master.call("registerSubscriber", "/nowhere", "/t", "a/B", "http://no-port/")
        master.call("registerSubscriber", "/live", "/t", "a/B", slave.uri)
        began = time.monotonic()
        master.call("registerPublisher", "/p", "/t", "a/B", "http://127.0.0.1:9/")
        wait_until(lambda: slave.calls, "the live node is told")
        assert time.monotonic() - began < 0.5
        wait_until(lambda: master.drops.get("notification-failed", 0) >= 3, "the others fail")
        assert master.drops["bad-uri"] == 1
        # Nobody is forgotten for not answering.
        state = master.call("getSystemState", "/x")[2]
        assert sorted(state[1][0][1]) == ["/deaf", "/live", "/nowhere", "/refuses", "/unknown"]


def test_a_node_that_comes_back_is_told_again(master: MasterServer) -> None:
    first = Slave()
    master.call("registerSubscriber", "/s", "/t", "a/B", first.uri)
    master.call("registerPublisher", "/p1", "/t", "a/B", "http://127.0.0.1:9/")
    wait_until(lambda: first.calls, "told")
    first.close()
    master.call("registerPublisher", "/p2", "/t", "a/B", "http://127.0.0.1:8/")
    wait_until(lambda: master.drops.get("notification-failed"), "the failure is counted")
    second = Slave()
    try:
        # The same name under a new address, as after a restart: the old address is told to end, in vain.
        master.call("registerSubscriber", "/s", "/t", "a/B", second.uri)
        master.call("unregisterPublisher", "/p1", "/t", "http://127.0.0.1:9/")
        wait_until(lambda: second.calls, "the new one is told")
        assert second.calls[-1] == ("publisherUpdate", ["/t", ["http://127.0.0.1:8/"]])
    finally:
        second.close()


GARBAGE = [
    b"\r\n" * 100_000,
    b"GET / HTTP/1.1\r\n\r\n",
    b"POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n",
    b"POST / HTTP/1.1\r\nContent-Length: 9\r\n\r\n<garbage>",
    b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nffffffff\r\n",
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",  # a TLS hello
    b"SSH-2.0-OpenSSH_9.2\r\n",
    b"\xb0\x00\x00\x00\x20\x00\x00\x00callerid=/rostopic_1_1",  # a TCPROS header
    b"x" * 1_000_000,
    bytes(random.Random(1).randrange(256) for _ in range(5000)),
]


@pytest.mark.parametrize("data", GARBAGE, ids=range(len(GARBAGE)))
def test_garbage_harms_nobody_else(master: MasterServer, proxy: Any, data: bytes) -> None:
    with connect(master) as sock:
        try:
            sock.sendall(data)
            assert proxy.getPid("/n")[0] == 1
            sock.shutdown(socket.SHUT_WR)
            while sock.recv(65536):
                pass
        except OSError:
            pass  # refused while still sending
    assert proxy.getPid("/n")[0] == 1
    wait_until(lambda: master.connections == 1, "the bad connection is gone")


def test_a_client_that_leaves_in_the_middle_harms_nobody(master: MasterServer, proxy: Any) -> None:
    proxy.setParam("/n", "/big", "x" * 1_000_000)
    request = xmlrpc.client.dumps(("/n", "/big"), "getParam").encode()
    data = b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n" % len(request) + request
    for length in (0, 1, 20, len(data) - 1, len(data)):
        with connect(master) as sock:
            sock.sendall(data[:length])
            if length == len(data):
                assert sock.recv(100)  # leave with nearly all of the answer unread
    assert len(proxy.getParam("/n", "/big")[2]) == 1_000_000
    wait_until(lambda: master.connections == 1, "their connections are gone")


def test_a_client_that_never_reads_its_answers_is_cut_off(
    master: MasterServer, proxy: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(RpcServer, "max_unsent", 5_000_000)
    proxy.setParam("/n", "/big", "x" * 1_000_000)
    request = xmlrpc.client.dumps(("/n", "/big"), "getParam").encode()
    data = b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n" % len(request) + request
    with connect(master) as sock, pytest.raises(ConnectionError):
        for _ in range(10_000):
            sock.sendall(data)
            time.sleep(0.001)
    assert proxy.getPid("/n")[0] == 1
    wait_until(lambda: master.connections == 1, "the connection is gone")


def test_a_thousand_abandoned_connections_leave_no_descriptor(master: MasterServer) -> None:
    before = descriptors()
    for _ in range(10):
        socks = [connect(master) for _ in range(100)]
        for number, sock in enumerate(socks):
            if number % 2:
                sock.sendall(b"POST / HTTP/1.1\r\nContent-")
            sock.close()
    wait_until(lambda: master.connections == 0, "all are gone")
    assert descriptors() <= before + 1
    with proxy_of(master.uri) as proxy:
        assert proxy.getPid("/n")[0] == 1


def test_the_longest_silent_connection_makes_room(loop: Reactor) -> None:
    with (
        MasterServer("127.0.0.1", 0, loop, max_connections=5) as master,
        proxy_of(master.uri) as proxy,
    ):
        socks = []
        for _ in range(12):
            socks.append(connect(master))
            assert proxy.getPid("/n")[0] == 1
        # An answer may come before the connection that was made before the question is even accepted.
        wait_until(lambda: master.drops.get("connection-evicted") == 8, "the oldest are closed")
        assert master.connections == 5
        assert socks[0].recv(1) == b""
        for sock in socks:
            sock.close()


def test_a_shutdown_call_is_answered_and_ends_the_master(master: MasterServer, proxy: Any) -> None:
    assert proxy.shutdown("/n", "enough")[0] == 1
    assert master.stopped.wait(PATIENCE)
    with pytest.raises(ConnectionRefusedError):
        connect(master)


def test_closing_frees_everything_and_the_port_can_be_used_again(loop: Reactor) -> None:
    before = descriptors()
    master = MasterServer("127.0.0.1", 0, loop)
    port = master.port
    socks = [connect(master) for _ in range(5)]
    wait_until(lambda: master.connections == 5, "connected")
    master.close()
    master.close()
    for sock in socks:
        assert sock.recv(1) == b""
        sock.close()
    assert descriptors() == before
    with MasterServer("127.0.0.1", port, loop) as again:
        assert again.port == port


def test_a_restarted_master_is_reached_over_a_kept_connection(loop: Reactor) -> None:
    master = MasterServer("127.0.0.1", 0, loop)
    with proxy_of(master.uri) as proxy:
        assert proxy.getPid("/n")[0] == 1
        master.close()
        with MasterServer("127.0.0.1", master.port, loop):
            assert proxy.getPid("/n")[0] == 1


def test_calls_of_many_clients_at_once_are_all_answered(master: MasterServer) -> None:
    failures: list[BaseException] = []

    def client(number: int) -> None:
        try:
            with proxy_of(master.uri) as proxy:
                for step in range(30):
                    assert proxy.setParam(f"/n{number}", "~k", step)[0] == 1
                    assert proxy.getParam(f"/n{number}", "~k") == [1, f"Parameter [/n{number}/k]", step]
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=client, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE)
    assert failures == []
    assert len(master.call("getParamNames", "/x")[2]) == 8


RUN = "import sys; from roslet.master.server import run; sys.exit(run('127.0.0.1', int(sys.argv[1])))"


def start(program: str, port: int) -> tuple[subprocess.Popen[str], str]:
    process = subprocess.Popen(
        [sys.executable, "-c", program, str(port)],
        env={**os.environ, "PYTHONPATH": SOURCE},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    line = process.stdout.readline().strip()
    assert line.startswith("ROS_MASTER_URI=http://"), line
    return process, line.partition("=")[2]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_master_process_ends_quickly_and_silently_on_a_signal(number: signal.Signals) -> None:
    process, uri = start(RUN, 0)
    with proxy_of(uri) as proxy:
        run_id = proxy.getParam("/n", "/run_id")
        assert run_id[0] == 1
        assert len(run_id[2]) == 36
        began = time.monotonic()
        process.send_signal(number)
        _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    assert errors == ""
    assert time.monotonic() - began < 1.0


def test_a_port_in_use_is_said_and_not_raised(
    master: MasterServer, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("127.0.0.1", master.port) == 1
    assert f"cannot listen on 127.0.0.1:{master.port}" in capsys.readouterr().err


def test_a_master_without_descriptors_left_still_answers() -> None:
    limited = "import resource; resource.setrlimit(resource.RLIMIT_NOFILE, (48, 48)); " + RUN
    process, uri = start(limited, 0)
    port = int(uri.rstrip("/").rpartition(":")[2])
    socks = []
    try:
        for _ in range(200):
            sock = socket.create_connection(("127.0.0.1", port))
            socks.append(sock)
        for _ in range(3):
            with proxy_of(uri) as proxy:
                assert proxy.getPid("/n")[0] == 1
    finally:
        for sock in socks:
            sock.close()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=PATIENCE)
    assert process.returncode == 0
    assert errors == ""
