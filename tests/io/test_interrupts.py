"""When a Ctrl-C is raised: at once in the user's code and in sleep, a moment later where the loop is in the midst of
something."""

from __future__ import annotations

import asyncio
import os
import signal
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest

from roslet.io import interrupts
from roslet.io.select import Reactor, reactor


@pytest.fixture(autouse=True)
def default_handler() -> Iterator[None]:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture
def loop() -> Reactor:
    return reactor()


def interrupt() -> None:
    os.kill(os.getpid(), signal.SIGINT)


def go_on(seconds: float) -> None:
    """Instructions of the user, between which a Ctrl-C may be raised."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        pass


def test_it_waits_for_the_lock_to_be_given_back(loop: Reactor) -> None:
    done: list[str] = []
    with pytest.raises(KeyboardInterrupt):
        with loop.lock:
            with loop.lock:
                interrupt()
                go_on(0.02)
            go_on(0.02)
            done.append("whole")
        go_on(10)
        done.append("too late")
    assert done == ["whole"]


def test_it_waits_for_a_function_of_the_loop(loop: Reactor) -> None:
    done: list[str] = []

    def control() -> None:
        if loop.in_loop and threading.current_thread() is threading.main_thread():
            interrupt()
            go_on(0.02)
            done.append("whole")
        else:
            loop.call_soon(control)  # the background thread had the loop

    loop.call_soon(control)
    with pytest.raises(KeyboardInterrupt):
        loop.run_until(lambda: False, 10.0)
    assert done == ["whole"]
    assert not loop.in_loop and not loop._spinners, "the loop is given back"
    assert loop.run_until(lambda: True)


def test_it_ends_a_sleep_of_the_loop_at_once(loop: Reactor) -> None:
    threading.Timer(0.1, interrupt).start()
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        loop.run_until(lambda: False, 10.0)
    assert time.monotonic() - begin < 5


def test_it_ends_the_wait_for_another_thread_that_has_the_loop(loop: Reactor) -> None:
    stop = threading.Event()
    other = threading.Thread(target=lambda: loop.run_until(stop.is_set, 10.0))
    other.start()
    while loop._owner != other.ident:
        time.sleep(0.001)
    threading.Timer(0.1, interrupt).start()
    with pytest.raises(KeyboardInterrupt):
        loop.run_until(lambda: False, 10.0)
    assert other.is_alive()
    stop.set()
    loop.wake()
    other.join()


def test_it_is_raised_in_a_callback_of_the_user(loop: Reactor) -> None:
    reached: list[str] = []

    def callback() -> None:
        reached.append("callback")
        interrupt()
        go_on(10)
        reached.append("too late")

    loop.call_soon(callback, user=True)
    with pytest.raises(KeyboardInterrupt):
        loop.run_until(lambda: False, 10.0)
    assert reached == ["callback"]


def test_what_another_thread_holds_does_not_put_it_off(loop: Reactor) -> None:
    held, leave = threading.Event(), threading.Event()

    def hold() -> None:
        with loop.lock:
            held.set()
            leave.wait(10)

    other = threading.Thread(target=hold)
    other.start()
    held.wait()
    try:
        with pytest.raises(KeyboardInterrupt):
            interrupt()
            go_on(5)
        assert not leave.is_set()
    finally:
        leave.set()
        other.join()


def test_a_loop_that_hangs_can_be_interrupted_all_the_same(
    loop: Reactor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interrupts, "MOST", 3)
    with pytest.raises(KeyboardInterrupt), loop.lock:
        interrupt()
        go_on(10)


def test_a_handler_of_the_program_stays(loop: Reactor) -> None:
    def mine(number: int, frame: Any) -> None: ...

    for handler in (mine, signal.SIG_IGN, signal.SIG_DFL):
        signal.signal(signal.SIGINT, handler)
        assert reactor() is loop
        assert signal.getsignal(signal.SIGINT) is handler


def test_other_threads_leave_the_handler_alone() -> None:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    thread = threading.Thread(target=reactor)
    thread.start()
    thread.join()
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_asyncio_keeps_its_own_way_with_ctrl_c() -> None:
    """A node made inside asyncio.run: the handler is asyncio's, where it has one (since Python 3.11)."""

    async def program() -> tuple[Any, Any]:
        before = signal.getsignal(signal.SIGINT)
        reactor()
        return before, signal.getsignal(signal.SIGINT)

    before, after = asyncio.run(program())
    assert after is (interrupts.on_sigint if before is signal.default_int_handler else before)


def test_ctrl_c_cancels_what_an_asyncio_program_does_where_its_node_was_made_before() -> None:
    cleaned: list[str] = []

    async def program() -> None:
        asyncio.get_running_loop().call_later(0.05, interrupt)
        try:
            await asyncio.sleep(10)
        finally:
            cleaned.append("up")

    reactor()
    with pytest.raises(KeyboardInterrupt):
        asyncio.run(program())
    assert cleaned == ["up"]
