"""The loop of a MicroPython program: one poller, timers that say when they are due, user code one callback at a time.

Whoever waits (`run_until`) serves the loop. While a callback of the user runs, `busy` is true: a loop that is entered from
there serves the network, and what would run user code waits in a bounded queue until the callback has returned.
"""

import gc
import select
import time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    Handler = Callable[[int], None]

_time: "Any" = time  # MicroPython has ticks in it
_select: "Any" = select
READ: int = _select.POLLIN
WRITE: int = _select.POLLOUT
GONE: int = _select.POLLERR | _select.POLLHUP
# Seconds that an idle loop sleeps at most.
MAX_SLEEP = 1.0
MAX_SLEEP_MS = 1000
# Milliseconds between two looks at the sockets in asyncio programs, while nothing happens: the longest that a message waits.
IDLE_LOOK = 5
# Sockets that are served before the poller is asked again.
MAX_READY = 16
# The part of the free heap after which garbage is collected: what is kept then lies together, with room for large messages.
GARBAGE = 4
# Calls that wait for a callback of the user to return; more are dropped and counted.
MAX_LATER = 32


def epoch_offset() -> int:
    """Nanoseconds between the Unix epoch and this port's: some boards count from 2000."""
    return 946684800000000000 if time.gmtime(0)[0] == 2000 else 0


class Loop:
    """`timed`: whatever has `deadline() -> seconds or None` and `handle_deadline(now)`. `error`: what a callback raised; it
    comes out of the turn in which it happened."""

    def __init__(self) -> None:
        self.timed: list[Any] = []
        self.busy = False
        self.error: Exception | None = None
        self.dropped = 0  # calls that found the queue full
        self._poller = _select.poll()
        self._handlers: dict[int, Handler] = {}
        self._ready: list[Any] = [None] * MAX_READY
        self._events = [0] * MAX_READY
        self._later: list[tuple[Callable[[Any], None], Any]] = []
        self._last = _time.ticks_ms()
        self._milliseconds = 0
        self._now = 0.0
        self._soonest: float | None = None  # as the last turn found it, and ...
        self._soonest_ms = 0  # ... the same in milliseconds, not before it
        collector: Any = gc
        collector.collect()
        collector.threshold(collector.mem_free() // GARBAGE)
        self._began = time.time_ns() + epoch_offset()

    # -- time

    def now(self) -> float:
        """Seconds since the loop was made, of a millisecond's resolution: within one, the same object. Never goes back."""
        ticks = _time.ticks_ms()
        if ticks != self._last:
            self._milliseconds += _time.ticks_diff(ticks, self._last)
            self._last = ticks
            self._now = self._milliseconds / 1000
        return self._now

    @property
    def epoch(self) -> int:
        """Nanoseconds of the Unix epoch when `now()` was 0, as the clock stood then."""
        return self._began

    def stamp(self) -> int:
        """Nanoseconds of the Unix epoch now, by the same clock: without garbage where integers are of 64 bits."""
        self.now()
        return self._began + self._milliseconds * 1000000

    # -- sockets

    def register(self, sock: "Any", handler: "Handler", events: int = READ) -> None:
        """Call `handler(events)` when the socket is ready."""
        self._handlers[id(sock)] = handler
        self._poller.register(sock, events)

    def modify(self, sock: "Any", events: int) -> None:
        """Look for other events from now on."""
        self._poller.modify(sock, events)

    def unregister(self, sock: "Any") -> None:
        """Forget a socket; call it before the socket is closed. One that is not there is no error."""
        if self._handlers.pop(id(sock), None) is not None:
            self._poller.unregister(sock)

    # -- user code

    def call(self, function: "Callable[..., Any]", argument: "Any" = None) -> "Any":
        """Call user code with `argument`, without one where it is None. What it raises comes out of the turn."""
        before = self.busy
        self.busy = True
        try:
            return function() if argument is None else function(argument)
        except Exception as error:
            if self.error is None:
                self.error = error
            return None
        finally:
            self.busy = before

    def later(self, function: "Callable[[Any], None]", argument: "Any", most: int = MAX_LATER) -> bool:
        """Call `function(argument)` when no callback runs. False where `most` wait: it is not called."""
        if len(self._later) >= most:
            self.dropped += 1
            return False
        self._later.append((function, argument))
        return True

    # -- running

    def turn(self, longest: float = 0.0) -> bool:
        """Serve what is ready; wait at most `longest` seconds for something. Whether anything was served."""
        self.now()
        soonest: float | None = None
        for one in self.timed:
            at = one.deadline()
            if at is not None and (soonest is None or at < soonest):
                soonest = at
        wait = self._wait(longest, soonest) if self.busy or not self._later else 0
        count = 0
        # A handler may register and unregister; so all are noted before the first is called.
        for found in self._poller.ipoll(wait):
            self._ready[count] = found[0]
            self._events[count] = found[1]
            count += 1
            if count == MAX_READY:
                break
        for at in range(count):
            handler = self._handlers.get(id(self._ready[at]))
            self._ready[at] = None
            if handler is not None:
                handler(self._events[at])
        served = count > 0
        now = self.now()
        each = 0
        while each < len(self.timed):  # whoever follows one that takes itself off has its turn next time
            one = self.timed[each]
            each += 1
            at = one.deadline()
            if at is not None and at <= now:
                one.handle_deadline(now)
                served = True
        if not self.busy:
            for _ in range(len(self._later)):
                function, argument = self._later.pop(0)
                function(argument)
                served = True
            error = self.error
            if error is not None:
                self.error = None
                raise error
        return served

    def _wait(self, longest: float, soonest: "float | None") -> int:
        """Milliseconds that a turn waits at most. Makes no floats while the same time is the next."""
        wait = MAX_SLEEP_MS if longest >= MAX_SLEEP else int(longest * 1000) + 1 if longest > 0 else 0
        if soonest is None:
            return wait
        if soonest is not self._soonest:
            self._soonest = soonest
            self._soonest_ms = int(soonest * 1000) + 1
        left = self._soonest_ms - self._milliseconds
        return min(wait, left) if left > 0 else 0

    def run_until(self, predicate: "Callable[[], object]", timeout: "float | None" = None) -> bool:
        """Serve until `predicate()` is true or `timeout` seconds have passed; says which (true: the predicate)."""
        end = None if timeout is None else self.now() + timeout
        while not predicate():
            left = MAX_SLEEP if end is None else end - self.now()
            if left <= 0:
                return False
            self.turn(left if left < MAX_SLEEP else MAX_SLEEP)
        return True

    async def run(self, predicate: "Callable[[], object]") -> None:
        """Serve until `predicate()` is true, beside other tasks of asyncio. Looks at once while there is something
        to do, else every IDLE_LOOK milliseconds."""
        import asyncio

        pause = 0
        while not predicate():
            pause = 0 if self.turn() else min(pause + 1, IDLE_LOOK)
            await asyncio.sleep_ms(pause)  # type: ignore[attr-defined]
