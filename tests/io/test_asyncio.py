"""The loop inside asyncio's, and other threads that spin beside it."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Iterator

import pytest

from roslet.io.asyncio import attach
from roslet.io.select import Reactor


@pytest.fixture
def loop() -> Iterator[Reactor]:
    made = Reactor()
    yield made
    made.close()


def test_a_timer_that_another_thread_was_told_of_comes_when_that_has_stopped(loop: Reactor) -> None:
    """The thread that spins reads what should have told asyncio's loop that there is a new timer, and stops before it is
    due."""
    ran: list[float] = []

    async def main() -> None:
        attach(loop, asyncio.get_running_loop())
        await asyncio.sleep(0.05)
        spinner = threading.Thread(target=loop.run_until, args=(lambda: False, 0.2))
        spinner.start()
        time.sleep(0.05)  # and asyncio does not look
        loop.call_at(loop.now() + 0.4, lambda: ran.append(loop.now()), user=True)
        spinner.join()
        await asyncio.sleep(1.0)

    asyncio.run(main())
    assert len(ran) == 1


def test_who_spins_beside_a_loop_of_asyncio_that_was_closed_goes_on(loop: Reactor) -> None:
    async def main() -> None:
        attach(loop, asyncio.get_running_loop())
        await asyncio.sleep(0.05)

    asyncio.run(main())
    loop.call_at(loop.now() + 5.0, lambda: None, user=True)
    assert not loop.run_until(lambda: False, 0.05)
    assert not loop.run_until(lambda: False, 0.05)
