from __future__ import annotations

import threading
import time

import pytest

from roslet.compat.callbacks import Worker


def done(seen: list[object], count: int) -> bool:
    end = time.monotonic() + 5
    while len(seen) < count and time.monotonic() < end:
        time.sleep(0.001)
    return len(seen) >= count


def test_items_are_worked_off_in_their_order_in_one_thread() -> None:
    seen: list[object] = []
    threads = set()

    def work(item: object) -> None:
        seen.append(item)
        threads.add(threading.current_thread().name)

    worker = Worker("in order", work)
    for number in range(1000):
        worker.put(number)
    assert done(seen, 1000)
    assert seen == list(range(1000))
    assert threads == {"in order"}
    worker.close()


def test_a_full_queue_drops_the_oldest_and_counts_it() -> None:
    seen: list[object] = []
    go = threading.Event()

    def work(item: object) -> None:
        go.wait(5)
        seen.append(item)

    worker = Worker("slow", work, size=2)
    worker.put("first")
    while len(worker):
        time.sleep(0.001)  # it is being worked on
    for number in range(5):
        worker.put(number)
    assert (len(worker), worker.dropped) == (2, 3)
    go.set()
    assert done(seen, 3)
    assert seen == ["first", 3, 4]
    worker.close()


def test_work_that_raises_does_not_end_the_thread(capsys: pytest.CaptureFixture[str]) -> None:
    seen: list[object] = []

    def work(item: object) -> None:
        if item == "bad":
            raise ValueError("told of")
        seen.append(item)

    worker = Worker("raises", work)
    worker.put("bad")
    worker.put("good")
    assert done(seen, 1)
    assert "told of" in capsys.readouterr().err
    worker.close()


def test_a_closed_worker_forgets_what_waits_and_takes_nothing() -> None:
    seen: list[object] = []
    go = threading.Event()

    def work(item: object) -> None:
        go.wait(5)
        seen.append(item)

    worker = Worker("closed", work)
    worker.put(1)
    while len(worker):
        time.sleep(0.001)
    worker.put(2)
    worker.close()
    worker.put(3)
    assert len(worker) == 0
    go.set()
    assert done(seen, 1)
    time.sleep(0.02)
    assert seen == [1]


def test_no_thread_is_made_before_the_first_item() -> None:
    before = threading.active_count()
    worker = Worker("idle", print)
    assert threading.active_count() == before
    worker.close()
