"""Who runs the loop when several threads want to."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator

import pytest

from roslet.io.select import Reactor


@pytest.fixture
def reactor() -> Iterator[Reactor]:
    made = Reactor()
    yield made
    made.close()


def until(predicate: object, seconds: float = 5.0) -> None:
    end = time.monotonic() + seconds
    while not predicate():  # type: ignore[operator]
        assert time.monotonic() < end, "nothing happened"
        time.sleep(0.001)


def test_a_thread_that_waits_for_an_answer_lets_the_spinning_thread_give_it(reactor: Reactor) -> None:
    """A client waits (control traffic only) and has the loop; the service's thread comes to spin later."""
    answered: list[int] = []
    results: list[bool] = []
    stop = threading.Event()
    waiting = threading.Thread(
        target=lambda: results.append(reactor.run_until(lambda: answered, 10.0, user=False))
    )
    waiting.start()
    until(lambda: reactor._owner == waiting.ident)
    spinning = threading.Thread(target=lambda: reactor.run_until(stop.is_set, 10.0))
    spinning.start()
    reactor.call_soon(lambda: answered.append(threading.get_ident()), user=True)
    waiting.join(5.0)
    stop.set()
    reactor.wake()
    spinning.join(5.0)
    assert results == [True]
    assert answered == [spinning.ident]
    assert not waiting.is_alive() and not spinning.is_alive()


def test_several_threads_may_spin_and_each_ends_when_its_predicate_is_true(reactor: Reactor) -> None:
    done: list[int] = []
    flags = [threading.Event() for _ in range(4)]

    def spin(at: int) -> None:
        assert reactor.run_until(flags[at].is_set, 10.0, user=at % 2 == 0)
        done.append(at)

    threads = [threading.Thread(target=spin, args=(at,)) for at in range(4)]
    for thread in threads:
        thread.start()
    for at in (2, 0, 3, 1):
        flags[at].set()
        reactor.wake()
        threads[at].join(5.0)
    assert done == [2, 0, 3, 1]
    assert reactor._callers == 0 and reactor._spinners == 0


def test_time_runs_out_for_a_thread_that_does_not_have_the_loop(reactor: Reactor) -> None:
    stop = threading.Event()
    spinning = threading.Thread(target=lambda: reactor.run_until(stop.is_set, 10.0))
    spinning.start()
    until(lambda: reactor._owner == spinning.ident)
    begin = time.monotonic()
    assert reactor.run_until(lambda: False, 0.1) is False
    assert reactor.run_until(lambda: False, 0.1, user=False) is False
    assert 0.2 <= time.monotonic() - begin < 5.0
    stop.set()
    reactor.wake()
    spinning.join(5.0)
    assert reactor._callers == 0


def test_no_wake_is_lost_when_another_comes_while_one_is_taken(
    reactor: Reactor, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A thread wakes the loop just as the loop reads the byte of an earlier wake."""
    read = os.read
    woken: list[int] = []

    def read_late(fd: int, size: int) -> bytes:
        if not woken:
            woken.append(1)
            other = threading.Thread(target=reactor.wake)
            other.start()
            other.join()
        return read(fd, size)

    monkeypatch.setattr("roslet.io.select.os.read", read_late)
    stop = threading.Event()
    spinning = threading.Thread(target=lambda: reactor.run_until(stop.is_set, 10.0))
    spinning.start()
    until(lambda: reactor._owner == spinning.ident)
    reactor.wake()
    until(lambda: woken and not reactor._waker.awake)
    time.sleep(0.05)  # let it sleep again
    stop.set()
    reactor.wake()
    spinning.join(5.0)
    assert not spinning.is_alive()
