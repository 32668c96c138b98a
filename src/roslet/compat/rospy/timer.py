"""`rospy.timer`: sleep, rates, timers."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

from roslet.compat import genpy
from roslet.compat.rospy import rostime
from roslet.compat.rospy.exceptions import ROSInterruptException, ROSTimeMovedBackwardsException
from roslet.compat.session import session

if TYPE_CHECKING:
    from collections.abc import Callable

# Simulated time is looked at this often even if no /clock message comes, to notice a shutdown. Seconds.
LOOK = 0.3


def sleep(duration: float | genpy.Duration) -> None:
    """Sleep for seconds or a Duration of the program's time; less where the node is shut down meanwhile.

    Under simulated time: raises ROSInterruptException where the node is shut down, ROSTimeMovedBackwardsException where
    time jumps back. Under the system's time rospy raises neither, and so does this.
    """
    seconds = duration.to_sec() if isinstance(duration, genpy.Duration) else duration
    if rostime.is_wallclock():
        if seconds < 0:
            return
        rostime.wallsleep(seconds)
        return
    _sleep_simulated(seconds)
    if session.shutting_down.is_set():
        raise ROSInterruptException("ROS shutdown request")


def _sleep_simulated(seconds: float) -> None:
    condition = rostime.get_rostime_cond()
    begin = rostime.get_rostime()
    if begin.is_zero():
        # Before the first /clock message there is no time to count from.
        with condition:
            while begin.is_zero() and not session.shutting_down.is_set():
                condition.wait(LOOK)
                begin = rostime.get_rostime()
    end = begin + genpy.Duration.from_sec(seconds)
    with condition:
        while begin <= (now := rostime.get_rostime()) < end and not session.shutting_down.is_set():
            condition.wait(LOOK)
    if now < begin and not session.shutting_down.is_set():
        raise ROSTimeMovedBackwardsException((begin - now).to_sec())


class Rate:
    """Keeps a loop at `hz` turns a second. With `reset`, simulated time that jumps back begins the turn anew instead of
    raising."""

    def __init__(self, hz: float, reset: bool = False) -> None:
        self.last_time: genpy.Time = rostime.get_rostime()
        self.sleep_dur = rostime.Duration(0, int(1e9 / hz))
        self._reset = reset

    def remaining(self) -> genpy.Duration:
        """How long `sleep` would sleep now; negative where the turn took too long."""
        return self._remaining(rostime.get_rostime())

    def _remaining(self, now: genpy.Time) -> genpy.Duration:
        if self.last_time > now:
            self.last_time = now
        left: genpy.Duration = self.sleep_dur - (now - self.last_time)
        return left

    def sleep(self) -> None:
        """Sleep until this turn's end. Raises ROSInterruptException on shutdown."""
        now = rostime.get_rostime()
        try:
            sleep(self._remaining(now))
        except ROSTimeMovedBackwardsException:
            if not self._reset:
                raise
            self.last_time = rostime.get_rostime()
            return
        self.last_time = self.last_time + self.sleep_dur
        if now - self.last_time > self.sleep_dur * 2:
            self.last_time = now


class TimerEvent:
    """What a timer's callback is told.

    last_expected, last_real         when the last call should have been, and was; None at the first
    current_expected, current_real   the same of this call
    last_duration                    seconds that the last call took; None at the first
    """

    def __init__(
        self,
        last_expected: genpy.Time | None,
        last_real: genpy.Time | None,
        current_expected: genpy.Time,
        current_real: genpy.Time,
        last_duration: float | None,
    ) -> None:
        self.last_expected = last_expected
        self.last_real = last_real
        self.current_expected = current_expected
        self.current_real = current_real
        self.last_duration = last_duration


class Timer(threading.Thread):
    """Calls `callback(TimerEvent)` every `period` (a Duration) in a thread of its own, which has begun; with `oneshot`
    once, after `period`."""

    def __init__(
        self,
        period: genpy.Duration,
        callback: Callable[[TimerEvent], object],
        oneshot: bool = False,
        reset: bool = False,
    ) -> None:
        super().__init__(name="timer", daemon=True)
        self._period = period
        self._callback = callback
        self._oneshot = oneshot
        self._reset = reset
        self._shutdown = False
        self.start()

    def shutdown(self) -> None:
        """No further calls."""
        self._shutdown = True

    def run(self) -> None:
        rate = Rate(1.0 / self._period.to_sec(), reset=self._reset)
        expected = rostime.get_rostime() + self._period
        last_expected: genpy.Time | None = None
        last_real: genpy.Time | None = None
        last_duration: float | None = None
        while not session.shutting_down.is_set() and not self._shutdown:
            try:
                rate.sleep()
            except ROSInterruptException:
                if session.shutting_down.is_set():
                    break
                raise
            if self._shutdown:
                break
            real = rostime.get_rostime()
            start = time.time()
            self._callback(TimerEvent(last_expected, last_real, expected, real, last_duration))
            if self._oneshot:
                break
            last_duration = time.time() - start
            last_expected, last_real = expected, real
            expected = expected + self._period
