"""A machine on a socket: what is sent, what is read, how it ends."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import suppress
from types import SimpleNamespace
from typing import Any

import pytest

from roslet.engine.ros1.queue import SendQueue
from roslet.io import streams
from roslet.io.select import Reactor, listen
from roslet.io.streams import Stream, connect


@pytest.fixture
def loop() -> Iterator[Reactor]:
    made = Reactor()
    yield made
    made.close()


class Machine:
    """Notes what it gets, sends what it is told."""

    def __init__(self) -> None:
        self.got = b""
        self.out = b""
        self.closing = False
        self.lost_for = ""
        self.due: float | None = None
        self.times: list[float] = []
        self.channel: Any = None

    def receive_data(self, data: memoryview, now: float) -> None:
        self.got += bytes(data)
        if b"boom" in self.got:
            raise RuntimeError("slip")

    def data_to_send(self) -> bytes:
        out, self.out = self.out, b""
        return out

    def connected(self, now: float) -> None:
        self.out += b"hello"

    def deadline(self) -> float | None:
        return self.due

    def handle_deadline(self, now: float) -> None:
        self.times.append(now)
        self.due = None

    def lost(self, reason: str, now: float) -> None:
        self.lost_for = reason


def pair(loop: Reactor, machine: Any = None) -> tuple[Any, Stream, socket.socket, list[Stream]]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        far = socket.create_connection(server.getsockname(), 5)
        near, _ = server.accept()
    near.setblocking(False)
    machine = machine or Machine()
    told: list[Stream] = []
    with loop.lock:
        stream = Stream(loop, machine, near, told.append, False)
    return machine, stream, far, told


def flush(loop: Reactor, stream: Stream) -> None:
    with loop.lock:
        stream.flush()


def test_bytes_go_in_and_out(loop: Reactor) -> None:
    machine, stream, far, told = pair(loop)
    far.sendall(b"ping")
    assert loop.run_until(lambda: machine.got == b"ping", 2)
    assert told == [stream]
    machine.out = b"pong"
    flush(loop, stream)
    assert far.recv(10) == b"pong"
    far.close()
    assert loop.run_until(lambda: machine.lost_for, 2)
    assert machine.lost_for == "closed by the peer"


def test_what_does_not_fit_the_socket_follows_when_there_is_room(loop: Reactor) -> None:
    machine, stream, far, _ = pair(loop)
    machine.out = data = bytes(range(256)) * 20_000
    flush(loop, stream)
    assert stream.unsent
    got = bytearray()

    def read() -> None:
        while len(got) < len(data):
            got.extend(far.recv(1 << 16))

    thread = threading.Thread(target=read)
    thread.start()
    assert loop.run_until(lambda: not stream.unsent, 5)
    thread.join()
    assert got == data


def test_closing_waits_for_the_rest_but_not_for_ever(loop: Reactor, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(streams, "LAST_WORDS", 0.2)
    machine, stream, _far, _ = pair(loop)
    machine.out = bytes(10_000_000)
    machine.closing = True
    flush(loop, stream)
    assert not stream.closed
    assert loop.run_until(lambda: machine.lost_for, 2)
    assert machine.lost_for == "closed; the peer did not read the rest"


class Answering(Machine):
    """Answers once the peer has said all."""

    answer = b"x" * 4_000_000

    def receive_end(self, now: float) -> None:
        self.out += self.answer
        self.closing = True


def test_a_peer_that_closes_its_half_still_gets_the_answer(loop: Reactor) -> None:
    machine, stream, far, told = pair(loop, Answering())
    turns: list[int] = []
    ready = stream._ready

    def counting(events: int) -> None:
        turns.append(events)
        ready(events)

    with loop.lock:
        loop.unregister(stream._fd)
        loop.register(stream._fd, counting, stream._events)
    far.sendall(b"question")
    far.shutdown(socket.SHUT_WR)
    loop.run_until(lambda: stream.unsent, 5, user=False)
    assert machine.got == b"question" and not stream.closed
    before = len(turns)
    loop.run_until(lambda: False, 0.1, user=False)
    assert len(turns) - before < 5  # the end of the input does not keep the loop busy
    far.settimeout(5)
    got = 0
    while part := far.recv(1 << 16):
        got += len(part)
    assert got == len(machine.answer)
    loop.run_until(lambda: machine.lost_for, 5, user=False)
    assert stream.closed and told[-1] is stream and machine.lost_for == "closed"
    far.close()


def test_a_peer_that_closes_its_half_and_does_not_read_is_given_up(
    loop: Reactor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(streams, "LAST_WORDS", 0.1)
    machine, _, far, _ = pair(loop, Answering())
    far.shutdown(socket.SHUT_WR)
    loop.run_until(lambda: machine.lost_for, 5, user=False)
    assert "did not read" in machine.lost_for
    far.close()


def test_a_slip_in_a_machine_ends_its_connection_and_no_other(loop: Reactor) -> None:
    machine, stream, far, _ = pair(loop)
    other, _, other_far, _ = pair(loop)
    far.sendall(b"boom")
    with suppress(RuntimeError):  # or the background thread prints it
        loop.run_until(lambda: machine.lost_for, 2)
    assert stream.closed and machine.lost_for == "internal error"
    other_far.sendall(b"fine")
    assert loop.run_until(lambda: other.got == b"fine", 2)


def test_a_deadline_is_kept_and_armed_again(loop: Reactor) -> None:
    machine, stream, far, _ = pair(loop)
    machine.due = loop.now() + 0.05
    with loop.lock:
        stream.arm()
    assert loop.run_until(lambda: machine.times, 2)
    machine.due = loop.now() + 0.02
    far.sendall(b"x")  # after each input
    assert loop.run_until(lambda: len(machine.times) == 2, 2)


def test_a_connection_is_made_and_greets(loop: Reactor) -> None:
    server = listen("127.0.0.1")
    machine = Machine()
    with loop.lock:
        connect(
            loop, machine, ("localhost", server.getsockname()[1]), lambda stream: None, lambda reason: None
        )
    server.setblocking(True)
    server.settimeout(3)
    far, _ = server.accept()
    far.settimeout(3)
    assert far.recv(10) == b"hello"
    assert "to [127.0.0.1:" in machine.channel.description
    far.close()
    server.close()


def test_a_connection_that_is_refused_says_so(loop: Reactor) -> None:
    with listen("127.0.0.1") as server:
        port = server.getsockname()[1]
    machine = Machine()
    failed: list[str] = []
    with loop.lock:
        connect(loop, machine, ("127.0.0.1", port), lambda stream: None, failed.append)
    assert loop.run_until(lambda: machine.lost_for or failed, 2)
    assert (machine.lost_for or failed[0]) == "cannot connect: ECONNREFUSED"


def test_a_connection_that_hangs_is_given_up_at_the_deadline(loop: Reactor) -> None:
    with socket.socket() as full:  # a queue that is full answers no SYN
        full.bind(("127.0.0.1", 0))
        full.listen(0)
        address = full.getsockname()
        fillers = []
        for _ in range(4):
            filler = socket.socket()
            filler.setblocking(False)
            filler.connect_ex(address)
            fillers.append(filler)
        time.sleep(0.05)
        machine = Machine()
        machine.due = loop.now() + 0.2

        def give_up(now: float) -> None:
            machine.due = None
            machine.closing = True

        machine.handle_deadline = give_up  # type: ignore[method-assign]
        with loop.lock:
            connect(loop, machine, address, lambda stream: None, lambda reason: None)
        begin = time.monotonic()
        assert loop.run_until(lambda: machine.lost_for, 3)
        assert time.monotonic() - begin < 1 and machine.lost_for == "given up"
        for filler in fillers:
            filler.close()


def test_a_name_that_nobody_knows_fails_in_its_own_thread(loop: Reactor) -> None:
    for host in ("no-such-host.invalid", "x" * 70 + ".invalid"):  # the second cannot even be asked for
        failed: list[str] = []
        with loop.lock:
            connect(loop, Machine(), (host, 1), lambda stream: None, failed.append)
        assert loop.run_until(lambda failed=failed: failed, 8)  # type: ignore[misc]
        assert failed[0].startswith(f"cannot find host {host}")


def test_a_socket_that_met_itself_is_no_connection(loop: Reactor) -> None:
    sock = socket.socket()
    sock.bind(("127.0.0.1", 0))
    address = sock.getsockname()
    sock.connect(address)  # the kernel allows it
    sock.setblocking(False)
    machine = Machine()
    with loop.lock:
        Stream(loop, machine, sock, lambda stream: None, connecting=True)
    assert loop.run_until(lambda: machine.lost_for, 2)
    assert machine.lost_for == "cannot connect: nobody listens there" and machine.out == b""


class Subscriber(Machine):
    """A machine with a queue, as a subscriber of our topic is."""

    def __init__(self) -> None:
        super().__init__()
        self.queue = SendQueue(0)
        self.publication = SimpleNamespace(lock=threading.Lock())


def test_the_loop_never_waits_for_a_publishing_thread(loop: Reactor) -> None:
    machine, stream, far, _ = pair(loop, Subscriber())
    other, _, other_far, _ = pair(loop)
    machine.publication.lock.acquire()
    machine.queue.push(b"queued")
    begin = time.monotonic()
    flush(loop, stream)
    other_far.sendall(b"x")
    assert loop.run_until(lambda: other.got == b"x", 2)
    with loop.lock:
        stream.lose("gone")
    assert time.monotonic() - begin < 0.2
    assert stream.sock.fileno() >= 0, "a thread may be about to send"
    machine.publication.lock.release()
    assert loop.run_until(lambda: stream.sock.fileno() < 0, 2)
    assert far.recv(10) == b""


def test_the_queue_goes_out_when_the_publishing_thread_is_done(loop: Reactor) -> None:
    machine, stream, far, _ = pair(loop, Subscriber())
    machine.publication.lock.acquire()
    machine.queue.push(b"queued")
    flush(loop, stream)
    time.sleep(0.02)
    machine.publication.lock.release()
    assert loop.run_until(lambda: not stream.unsent, 2)
    assert far.recv(10) == b"queued"


def test_a_broken_connection_is_closed_once(loop: Reactor) -> None:
    machine, stream, far, told = pair(loop, Subscriber())
    far.close()
    for _ in range(5):
        stream.try_send(b"x")
    assert stream.broken
    assert loop.run_until(lambda: machine.lost_for, 2)
    loop.run_until(lambda: False, 0.05)
    assert len(told) == 1 and machine.lost_for
