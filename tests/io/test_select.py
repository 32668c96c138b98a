"""The loop: turns, threads, waiting within waiting, timers, exceptions, forks."""

from __future__ import annotations

import os
import pathlib
import select as system_select
import socket
import threading
import time
from collections.abc import Callable, Iterator

import pytest

from roslet.io import select
from roslet.io.select import READ, WRITE, Reactor, listen, reactor, tune


@pytest.fixture
def loop() -> Iterator[Reactor]:
    made = Reactor()
    yield made
    made.close()


def pipe(loop: Reactor, user: bool = False) -> tuple[Callable[[bytes], None], list[tuple[bytes, str]]]:
    """A descriptor whose input is noted, with the thread that saw it; and what writes to it."""
    near, far = os.pipe()
    seen: list[tuple[bytes, str]] = []
    loop.register(
        near, lambda events: seen.append((os.read(near, 100), threading.current_thread().name)), user=user
    )

    def write(data: bytes) -> None:
        os.write(far, data)

    return write, seen


def soon(predicate: Callable[[], object], patience: float = 3.0) -> bool:
    end = time.monotonic() + patience
    while not predicate():
        if time.monotonic() > end:
            return False
        time.sleep(0.001)
    return True


def test_control_input_is_served_though_nobody_spins(loop: Reactor) -> None:
    write, seen = pipe(loop)
    write(b"x")
    assert soon(lambda: seen == [(b"x", "roslet")])


def test_user_input_is_served_inside_spin_only_and_in_its_thread(loop: Reactor) -> None:
    write, seen = pipe(loop, user=True)
    pipe(loop)  # so that the background thread runs
    write(b"x")
    time.sleep(0.05)
    assert seen == []
    assert loop.run_until(lambda: seen, 2)
    assert seen == [(b"x", threading.current_thread().name)]
    write(b"y")
    time.sleep(0.05)
    assert len(seen) == 1, "the loop has been given back"


def test_a_predicate_that_is_true_costs_no_turn(loop: Reactor) -> None:
    assert loop.run_until(lambda: True, 0)
    assert not loop.run_until(lambda: False, 0)


def test_a_wait_ends_in_time(loop: Reactor) -> None:
    for user in (True, False):
        begin = time.monotonic()
        assert not loop.run_until(lambda: False, 0.1, user)
        assert 0.09 < time.monotonic() - begin < 0.3


def test_call_soon_from_another_thread_wakes_the_loop_at_once(loop: Reactor) -> None:
    called: list[float] = []
    thread = threading.Thread(
        target=lambda: (time.sleep(0.05), loop.call_soon(lambda: called.append(time.monotonic()), user=True))  # type: ignore[func-returns-value]
    )
    thread.start()
    begin = time.monotonic()
    assert loop.run_until(lambda: called, 5)
    assert time.monotonic() - begin < 0.5
    thread.join()


def test_call_soon_keeps_its_order_and_takes_what_functions_add(loop: Reactor) -> None:
    order: list[int] = []

    def first() -> None:
        order.append(1)
        loop.call_soon(lambda: order.append(3), user=True)

    loop.call_soon(first, user=True)
    loop.call_soon(lambda: order.append(2), user=True)
    assert loop.run_until(lambda: len(order) == 3, 2)
    assert order == [1, 2, 3]


def test_a_function_called_soon_may_wait_itself(loop: Reactor) -> None:
    order: list[str] = []

    def waiting() -> None:
        order.append("begin")
        loop.run_until(lambda: "control" in order, 2)
        order.append("end")

    loop.call_soon(waiting)
    for _ in range(3):
        loop.call_soon(lambda: order.append("control"))
    assert loop.run_until(lambda: "end" in order, 3)
    assert order[0] == "begin" and order[-1] == "end" and "control" in order


def test_timers_fire_in_their_order_and_not_before(loop: Reactor) -> None:
    fired: list[tuple[int, float]] = []
    begin = loop.now()
    for index in (3, 1, 2):
        loop.call_at(begin + 0.03 * index, lambda index=index: fired.append((index, loop.now())), user=True)  # type: ignore[misc]
    cancelled = loop.call_at(begin + 0.01, lambda: fired.append((0, 0.0)), user=True)
    cancelled.cancel()
    assert loop.user_deadline() is not None
    assert loop.run_until(lambda: len(fired) == 3, 2)
    assert [index for index, _ in fired] == [1, 2, 3]
    assert all(when >= begin + 0.03 * index for index, when in fired)
    assert fired[-1][1] - begin < 0.2 and loop.user_deadline() is None


def test_control_timers_fire_though_nobody_spins_and_user_timers_do_not(loop: Reactor) -> None:
    pipe(loop)
    fired: list[str] = []
    loop.call_at(loop.now() + 0.02, lambda: fired.append("control"))
    loop.call_at(loop.now() + 0.02, lambda: fired.append("user"), user=True)
    assert soon(lambda: fired == ["control"])
    time.sleep(0.05)
    assert fired == ["control"]
    assert loop.run_until(lambda: len(fired) == 2, 1)


def test_a_sooner_timer_shortens_the_sleep_that_is_under_way(loop: Reactor) -> None:
    pipe(loop)
    fired: list[float] = []
    loop.call_at(loop.now() + 30, lambda: None)
    time.sleep(0.02)
    begin = time.monotonic()
    loop.call_at(loop.now() + 0.02, lambda: fired.append(time.monotonic()))
    assert soon(lambda: fired) and fired[0] - begin < 0.5


def test_what_a_callback_raises_comes_out_of_the_wait_and_the_loop_goes_on(loop: Reactor) -> None:
    def bad() -> None:
        raise ValueError("mine")

    done: list[int] = []
    loop.call_soon(bad, user=True)
    loop.call_soon(lambda: done.append(1), user=True)
    with pytest.raises(ValueError, match="mine"):
        loop.run_until(lambda: False, 2)
    assert done == [1]
    loop.call_at(loop.now(), bad, user=True)
    with pytest.raises(ValueError, match="mine"):
        loop.run_until(lambda: False, 2)
    loop.call_soon(lambda: done.append(2), user=True)
    assert loop.run_until(lambda: len(done) == 2, 1)


def test_a_second_exception_of_a_turn_is_printed(loop: Reactor, capfd: pytest.CaptureFixture[str]) -> None:
    loop.report(ValueError("first"))
    loop.report(ValueError("second"))
    with pytest.raises(ValueError, match="first"):
        loop.run_until(lambda: False, 1)
    assert "second" in capfd.readouterr().err


def test_a_wait_within_a_callback_does_not_raise_what_another_callback_raised(loop: Reactor) -> None:
    ended: list[bool] = []
    answered: list[int] = []

    def fail() -> None:
        raise ValueError("of another")

    def wait() -> None:
        loop.call_soon(lambda: answered.append(1))
        ended.append(loop.run_until(lambda: answered, 5.0, user=False))

    loop.call_soon(fail, user=True)
    loop.call_soon(wait, user=True)
    with pytest.raises(ValueError, match="of another"):
        loop.run_until(lambda: False, 5.0)
    assert ended == [True]


def test_the_background_thread_outlives_a_slip(loop: Reactor, capfd: pytest.CaptureFixture[str]) -> None:
    write, seen = pipe(loop)

    def bad() -> None:
        raise RuntimeError("slip")

    loop.call_soon(bad)
    loop.call_at(loop.now(), bad)
    assert soon(lambda: capfd.readouterr().err.count("slip") or True)
    write(b"x")
    assert soon(lambda: seen == [(b"x", "roslet")])


def test_a_callback_may_wait_and_control_input_is_served_meanwhile(loop: Reactor) -> None:
    write, seen = pipe(loop)
    write_user, seen_user = pipe(loop, user=True)
    result: list[bool] = []

    def callback() -> None:
        write(b"x")
        write_user(b"u")
        result.append(loop.run_until(lambda: seen, 2))
        assert seen_user == [], "user input has to wait until this callback is done"

    loop.call_soon(callback, user=True)
    assert loop.run_until(lambda: seen_user, 3)
    assert result == [True]


def test_threads_share_the_loop_and_each_sees_its_own_condition(loop: Reactor) -> None:
    write, seen = pipe(loop, user=True)
    results: dict[int, bool] = {}

    def wait(count: int) -> None:
        results[count] = loop.run_until(lambda: len(seen) >= count, 5)

    threads = [threading.Thread(target=wait, args=(count,)) for count in (1, 2, 3)]
    for thread in threads:
        thread.start()
    for _ in range(3):
        time.sleep(0.02)
        write(b"x")
    for thread in threads:
        thread.join(5)
    assert results == {1: True, 2: True, 3: True}


def test_a_thread_that_serves_users_goes_before_one_that_only_waits(loop: Reactor) -> None:
    pipe(loop)
    write, seen = pipe(loop, user=True)
    waiter = threading.Thread(target=lambda: loop.run_until(lambda: seen, 5, user=False))
    waiter.start()
    time.sleep(0.02)
    write(b"x")
    begin = time.monotonic()
    assert loop.run_until(lambda: seen, 5)
    assert time.monotonic() - begin < 1
    waiter.join(1)
    assert not waiter.is_alive()


def test_one_turn_returns_after_something_has_happened(loop: Reactor) -> None:
    write, seen = pipe(loop, user=True)
    write(b"x")
    begin = time.monotonic()
    loop.run_turn(1.0)
    assert seen and time.monotonic() - begin < 0.5
    begin = time.monotonic()
    loop.run_turn(0.1)
    assert 0.05 < time.monotonic() - begin < 0.5


def test_a_descriptor_may_be_modified_and_unregistered(loop: Reactor) -> None:
    near, far = socket.socketpair()
    events: list[int] = []
    loop.register(near.fileno(), events.append, 0, user=True)
    far.send(b"x")
    loop.run_turn(0.05)
    assert events == []
    loop.modify(near.fileno(), READ | WRITE)
    assert loop.run_until(lambda: events, 1)
    assert events[0] & READ and events[0] & WRITE
    loop.unregister(near.fileno())
    loop.unregister(near.fileno())
    count = len(events)
    loop.run_turn(0.05)
    assert len(events) == count
    near.close()
    far.close()


def test_the_loop_can_be_watched_from_another_one(loop: Reactor) -> None:
    write, seen = pipe(loop, user=True)
    poller = system_select.poll()
    poller.register(loop.fileno(), system_select.POLLIN)
    loop.run_turn(0)
    assert poller.poll(0) == []
    write(b"x")
    assert poller.poll(1000)
    assert loop.run_until(lambda: seen, 1)


def test_many_wakes_from_many_threads_are_not_lost(loop: Reactor) -> None:
    pipe(loop)
    count = [0]

    def add() -> None:
        count[0] += 1

    def work() -> None:
        for _ in range(500):
            loop.call_soon(add, user=True)

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    assert loop.run_until(lambda: count[0] == 2000, 5)
    for thread in threads:
        thread.join()


def test_a_forked_child_has_a_loop_of_its_own() -> None:
    parent = reactor()
    write, seen = pipe(parent)
    pid = os.fork()
    if pid == 0:
        try:
            fresh = reactor()
            done: list[int] = []
            fresh.call_soon(lambda: done.append(1), user=True)
            fine = fresh is not parent and fresh.run_until(lambda: done, 2)
            os._exit(0 if fine else 1)
        finally:
            os._exit(2)
    assert os.waitpid(pid, 0)[1] == 0
    write(b"x")
    assert soon(lambda: seen == [(b"x", "roslet")]), "the parent's poller still watches what it watched"
    assert reactor() is parent


def test_a_socket_is_tuned_for_small_messages_and_dead_peers() -> None:
    with listen("127.0.0.1") as server:
        assert server.getsockname()[1] > 0 and not server.getblocking()
        with socket.socket() as sock:
            tune(sock)
            assert sock.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
            assert sock.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
            noticed = select.KEEPIDLE + select.KEEPINTVL * select.KEEPCNT
            assert noticed <= 30
            assert sock.getsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE) == select.KEEPIDLE


def test_a_port_in_use_is_an_error_and_leaves_no_socket() -> None:
    with listen("127.0.0.1") as server:
        before = len(os.listdir("/proc/self/fd"))
        with pytest.raises(OSError):
            listen("127.0.0.1", server.getsockname()[1])
        assert len(os.listdir("/proc/self/fd")) == before


def test_who_calls_a_loop_that_is_closed_writes_to_nobody(tmp_path: pathlib.Path) -> None:
    loop = Reactor()
    number = loop._waker._write
    loop.close()
    with (tmp_path / "file").open("wb", buffering=0) as stream:
        os.dup2(stream.fileno(), number)  # the descriptor is another file's by now
        try:
            loop.call_soon(lambda: None)
            loop.wake()
        finally:
            os.close(number)
    assert (tmp_path / "file").read_bytes() == b""


@pytest.mark.parametrize("what", ["call", "timer", "call of the loop"])
def test_the_background_thread_takes_no_user_call_from_the_descriptor(loop: Reactor, what: str) -> None:
    """Somebody who watches `fileno`, as an asyncio loop does, is told of it however late he looks."""
    pipe(loop)  # control traffic, which the background thread serves

    def asked() -> bool:
        watched = system_select.poll()
        watched.register(loop.fileno(), system_select.POLLIN)
        return bool(watched.poll(0))

    assert not asked()
    done: list[int] = []
    if what == "call":
        loop.call_soon(lambda: done.append(1), user=True)
    elif what == "timer":
        loop.call_at(loop.now(), lambda: done.append(1), user=True)
    else:
        loop.call_soon(lambda: loop.call_soon(lambda: done.append(1), user=True))
    ran: list[int] = []
    loop.call_soon(lambda: ran.append(1))  # the background thread has had a turn since
    deadline = time.monotonic() + 5.0
    while not ran or loop._waker.awake:
        assert time.monotonic() < deadline
        time.sleep(0.001)
    assert asked() and not done
    assert loop.run_until(lambda: done, 1.0)
    loop.run_turn(0.0)
    assert not asked()


class Arrivals:
    """A poller in time of its own: input comes so many seconds after the one before, and is taken at once."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, loop: Reactor) -> None:
        self.now, self.looks, self._due, self._loop = 0.0, 0, 0.0, loop
        loop.busy_wait = select.BUSY_WAIT
        monkeypatch.setattr(select, "monotonic", lambda: self.now)

    def poll(self, pause: float) -> list[tuple[int, int]]:
        if pause == 0.0:
            self.looks += 1
            pause = 10e-6
        ready = self.now + pause >= self._due
        self.now = max(self.now, self._due) if ready else self.now + pause
        return [(0, READ)] if ready else []

    def after(self, seconds: float) -> int:
        """How often it was looked for input that came then."""
        self.looks, self._due = 0, self.now + seconds
        assert self._loop._wait(self, 1.0)
        return self.looks


def test_after_looks_in_vain_quick_input_is_soon_looked_for_again(
    loop: Reactor, monkeypatch: pytest.MonkeyPatch
) -> None:
    arrivals = Arrivals(monkeypatch, loop)
    for _ in range(2000):  # each second one comes as a look is over
        arrivals.after(100e-6)
        arrivals.after(400e-6)
    assert loop._skips > 20
    quick = [arrivals.after(100e-6) for _ in range(10)]
    assert quick[-1] and not quick[0]


def test_input_at_middling_intervals_is_seldom_looked_for(
    loop: Reactor, monkeypatch: pytest.MonkeyPatch
) -> None:
    arrivals = Arrivals(monkeypatch, loop)
    looked = [arrivals.after(400e-6) for _ in range(3000)]
    assert sum(1 for looks in looked if looks) < 20
