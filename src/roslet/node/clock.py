"""Time in a node: the wall clock or /clock, timers, rates."""

from __future__ import annotations

import time

from roslet.wire.time import Time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.io.select import Reactor
    from roslet.io.select import Timer as Alarm


class Clock:
    """Seconds since 1970, or what /clock last said where `/use_sim_time` is true (0 before it said anything)."""

    def __init__(self, reactor: Reactor) -> None:
        self.reactor = reactor
        self.simulated = False
        self._nanoseconds = 0
        self._timers: list[Timer] = []

    def simulate(self) -> None:
        """From now on /clock says what time it is; timers go by it too."""
        self.simulated = True
        for timer in self._timers:
            timer._to_simulated()

    def wall(self) -> None:
        """From now on the wall clock does again."""
        self.simulated = False
        self._nanoseconds = 0
        for timer in self._timers:
            timer._to_wall()

    def close(self) -> None:
        """No timer calls any more."""
        for timer in list(self._timers):
            timer.cancel()

    def nanoseconds(self) -> int:
        return self._nanoseconds if self.simulated else time.time_ns()

    def now(self) -> Time:
        seconds, rest = divmod(self.nanoseconds(), 1_000_000_000)
        return Time(seconds, rest)

    def seconds(self) -> float:
        return self.nanoseconds() * 1e-9

    def advance(self, secs: int, nsecs: int) -> None:
        """/clock says so. Timers that are due by it fire; time may also jump back, when a recording starts again."""
        begins = not self._nanoseconds
        self._nanoseconds = secs * 1_000_000_000 + nsecs
        if begins:
            for timer in self._timers:
                timer._to_simulated()
        for timer in list(self._timers):
            timer._clock_moved()


class Timer:
    """Calls `callback()` every `period` seconds inside spin. Made by `Node.timer`. A call that comes late is not made up
    for: the next is a period after the moment at which it should have been, or now if that has passed as well."""

    def __init__(
        self, clock: Clock, period: float, callback: Callable[[], object], once: bool = False
    ) -> None:
        if not period > 0:
            raise ValueError(f"a period must be positive, not {period!r}")
        self.period = period
        self.calls = 0
        self._clock = clock
        self._callback = callback
        self._once = once
        self._alarm: Alarm | None = None
        self._due = clock.seconds() + period
        self._cancelled = False
        clock._timers.append(self)
        if not clock.simulated:
            self._next = clock.reactor.now() + period
            self._alarm = clock.reactor.call_at(self._next, self._fire, user=True)

    def _fire(self) -> None:
        if self._cancelled:
            return
        if self._once:
            self.cancel()
        else:
            now = self._clock.reactor.now()
            self._next = (
                max(self._next + self.period, now)
                if self._next + 2 * self.period > now
                else now + self.period
            )
            self._alarm = self._clock.reactor.call_at(self._next, self._fire, user=True)
        self.calls += 1
        self._callback()

    def _to_simulated(self) -> None:
        if self._alarm is not None:
            self._alarm.cancel()
            self._alarm = None
        self._due = self._clock.seconds() + self.period

    def _to_wall(self) -> None:
        self._next = self._clock.reactor.now() + self.period
        self._alarm = self._clock.reactor.call_at(self._next, self._fire, user=True)

    def _clock_moved(self) -> None:
        now = self._clock.seconds()
        if now < self._due - self.period:
            self._due = now + self.period
        elif now >= self._due and not self._cancelled:
            self._due = max(self._due + self.period, now)
            if self._once:
                self.cancel()
            self._clock.reactor.call_soon(self._run, user=True)

    def _run(self) -> None:
        if not self._cancelled or self._once:
            self.calls += 1
            self._callback()

    def cancel(self) -> None:
        """No further calls. Cancelling twice is allowed."""
        self._cancelled = True
        if self._alarm is not None:
            self._alarm.cancel()
        if self in self._clock._timers:
            self._clock._timers.remove(self)


class Rate:
    """Keeps a loop at `hz` turns a second. Made by `Node.rate`; `sleep()` serves callbacks meanwhile."""

    def __init__(self, clock: Clock, sleep: Callable[[float], None], hz: float) -> None:
        if not hz > 0:
            raise ValueError(f"a rate must be positive, not {hz!r}")
        self.period = 1.0 / hz
        self._clock = clock
        self._sleep = sleep
        self._next = clock.seconds() + self.period

    def remaining(self) -> float:
        """Seconds that `sleep()` would sleep now."""
        return max(0.0, self._next - self._clock.seconds())

    def sleep(self) -> None:
        """Sleep until this turn's end. A turn that took too long is not made up for by shorter ones."""
        now = self._clock.seconds()
        if now < self._next - 2 * self.period:
            self._next = now + self.period  # the clock has jumped back
        if self._next > now:
            self._sleep(self._next - now)
            now = self._clock.seconds()
        self._next += self.period
        if self._next < now - self.period:
            self._next = now + self.period
