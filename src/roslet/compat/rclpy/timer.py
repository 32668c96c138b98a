"""`rclpy.timer`: timers of any clock, and rates."""

from __future__ import annotations

import inspect
import threading
import weakref
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy._entity import Entity
from roslet.compat.rclpy.clock import Clock, ClockChange, JumpThreshold, TimeJump
from roslet.compat.rclpy.clock_type import ClockType
from roslet.compat.rclpy.duration import Duration
from roslet.compat.rclpy.exceptions import InvalidHandle, RCLError, ROSInterruptException
from roslet.compat.rclpy.time import Time

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.compat.rclpy.callback_groups import CallbackGroup
    from roslet.compat.rclpy.context import Context

# A timer of simulated time is looked at this often even where /clock does not move. Seconds.
_LOOK = 0.5


class TimerInfo:
    """When a call should have been, and when it was."""

    def __init__(
        self,
        *,
        expected_call_time: int = 0,
        actual_call_time: int = 0,
        clock_type: ClockType = ClockType.SYSTEM_TIME,
    ) -> None:
        self._expected = Time(nanoseconds=expected_call_time, clock_type=clock_type)
        self._actual = Time(nanoseconds=actual_call_time, clock_type=clock_type)

    @property
    def expected_call_time(self) -> Time:
        return self._expected

    @property
    def actual_call_time(self) -> Time:
        return self._actual


class Timer(Entity):
    """Calls `callback()`, or `callback(TimerInfo)` where it takes an argument of that name or type, every `timer_period_ns`.

    Calls that come late are not made up for: the next is at the next multiple of the period that is to come.
    """

    _polled = True

    def __init__(
        self,
        callback: Callable[..., Any] | None,
        callback_group: CallbackGroup | None,
        timer_period_ns: int,
        clock: Clock,
        *,
        context: Context | None = None,
        autostart: bool = True,
    ) -> None:
        if timer_period_ns < 0:
            raise RCLError("failed to create timer: timer period must be non-negative")
        super().__init__(callback_group)
        self._clock = clock
        self._lock = threading.Lock()
        self._period = int(timer_period_ns)
        self._last = clock._nanoseconds()
        self._next = self._last + self._period
        self._cancelled = not autostart
        self.callback = callback
        self._told = callback is not None and _takes_info(callback)
        self._jumps = clock.create_jump_callback(
            JumpThreshold(
                min_forward=Duration(nanoseconds=1),
                min_backward=Duration(nanoseconds=-1),
                on_clock_change=True,
            ),
            post_callback=_Moved(self),
        )

    @property
    def clock(self) -> Clock:
        """The clock that it goes by."""
        return self._clock

    @property
    def timer_period_ns(self) -> int:
        """Its period in nanoseconds. A new one counts from the next call on."""
        self._check()
        return self._period

    @timer_period_ns.setter
    def timer_period_ns(self, value: int) -> None:
        self._check()
        self._period = int(value)
        self._notify()

    def is_ready(self) -> bool:
        """Whether a call is due."""
        self._check()
        return self._ready()

    def is_canceled(self) -> bool:
        """Whether it stands still."""
        self._check()
        return self._cancelled

    def cancel(self) -> None:
        """Stand still. `reset` goes on."""
        self._check()
        self._cancelled = True

    def reset(self) -> None:
        """Begin a period now, cancelled or not."""
        self._check()
        with self._lock:
            self._next = self._clock._nanoseconds() + self._period
            self._cancelled = False
        self._notify()

    def time_since_last_call(self) -> int:
        """Nanoseconds since the last call, or since it was made."""
        self._check()
        return self._clock._nanoseconds() - self._last

    def time_until_next_call(self) -> int | None:
        """Nanoseconds to the next call, negative where it is late; None where it is cancelled."""
        self._check()
        return None if self._cancelled else self._next - self._clock._nanoseconds()

    def destroy(self) -> None:
        if not self._destroyed:
            super().destroy()
            self._jumps.unregister()

    def _jumped(self, jump: TimeJump) -> None:
        now = self._clock._nanoseconds()
        with self._lock:
            if jump.clock_change is not ClockChange.ROS_TIME_NO_CHANGE:
                # What is left of the period goes on in the other time.
                before = now - jump.delta.nanoseconds
                left = max(0, self._next - before)
                self._last = now - max(0, before - self._last)
                self._next = now + min(left, self._period)
            elif now <= self._last:
                self._last = now
                self._next = now + self._period
        self._notify()

    # -- for the executor

    def _ready(self) -> bool:
        return not self._cancelled and not self._destroyed and self._clock._nanoseconds() >= self._next

    def _seconds(self) -> float | None:
        if self._cancelled or self._destroyed:
            return None
        left = (self._next - self._clock._nanoseconds()) * 1e-9
        return max(left, _LOOK) if self._clock._stands() and left > 0 else max(0.0, left)

    def _take(self) -> Any:
        with self._lock:
            now = self._clock._nanoseconds()
            if self._cancelled or self._destroyed or now < self._next:
                return self._nothing
            expected = self._next
            self._last = now
            self._next += self._period
            if self._next < now:
                late = now - self._next
                self._next = now if not self._period else self._next + -(-late // self._period) * self._period
        return TimerInfo(expected_call_time=expected, actual_call_time=now, clock_type=self._clock.clock_type)

    def _run(self, work: Any) -> Any:
        if self.callback is None:
            return None
        return self.callback(work) if self._told else self.callback()


class _Moved:
    """Tells a timer of a jump of its clock, without keeping the timer alive."""

    def __init__(self, timer: Timer) -> None:
        self._timer = weakref.ref(timer)

    def __call__(self, jump: TimeJump) -> None:
        timer = self._timer()
        if timer is not None:
            timer._jumped(jump)


def _takes_info(callback: Callable[..., Any]) -> bool:
    """Whether a callback wants the TimerInfo: its only parameter is without a default, or is of that type."""
    try:
        parameters = list(inspect.signature(callback).parameters.values())
    except (TypeError, ValueError):
        return False
    if len(parameters) != 1 or parameters[0].kind in (
        inspect.Parameter.VAR_POSITIONAL,
        inspect.Parameter.VAR_KEYWORD,
        inspect.Parameter.KEYWORD_ONLY,
    ):
        return False
    only = parameters[0]
    return only.default is inspect.Parameter.empty or only.annotation in (TimerInfo, "TimerInfo")


class Rate:
    """Sleeps until the next turn of a timer. Somebody else must spin meanwhile."""

    def __init__(self, timer: Timer, *, context: Context) -> None:
        self._timer = timer
        self._context = context
        self._turn = threading.Condition()
        self._turns = 0
        self._over = False
        timer.callback = self._tick
        timer._told = False
        context.on_shutdown(self._interrupt)

    def _tick(self) -> None:
        with self._turn:
            self._turns += 1
            self._turn.notify_all()

    def _interrupt(self) -> None:
        with self._turn:
            self._over = True
            self._turn.notify_all()

    def destroy(self) -> None:
        """Wake who sleeps, with ROSInterruptException."""
        self._timer.destroy()
        self._context._off_shutdown(self._interrupt)
        self._interrupt()

    def sleep(self) -> None:
        """Until the timer's next turn. Raises ROSInterruptException where the context ends, or the rate is destroyed."""
        with self._turn:
            self._stop()
            turn = self._turns
            while turn == self._turns:
                self._turn.wait(_LOOK)
                self._stop()

    def _stop(self) -> None:
        if self._over or not self._context.ok():
            raise ROSInterruptException()


__all__ = ["InvalidHandle", "Rate", "Timer", "TimerInfo"]
