"""`rclpy.clock`: the system's clock, one that never jumps, and that of /clock."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from enum import Enum
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy.clock_type import ClockType
from roslet.compat.rclpy.duration import Duration
from roslet.compat.rclpy.exceptions import NotInitializedException
from roslet.compat.rclpy.time import Time

if TYPE_CHECKING:
    from roslet.compat.rclpy.context import Context

# A sleeper looks this often whether it is still wanted, should nobody wake it. Seconds.
_LOOK = 0.5


class ClockChange(Enum):
    """What happened to a clock when time jumped."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


class JumpThreshold:
    """Which jumps are told: forward by at least `min_forward`, backward by at least `min_backward` (a negative Duration),
    and changes of the source of time. Raises ValueError for a bound of the wrong sign, and where nothing would be told."""

    def __init__(
        self, *, min_forward: Duration | None, min_backward: Duration | None, on_clock_change: bool = True
    ) -> None:
        if min_forward is not None and min_forward.nanoseconds <= 0:
            raise ValueError("min_forward must be a positive non-zero duration")
        if min_backward is not None and min_backward.nanoseconds >= 0:
            raise ValueError("min_backward must be a negative non-zero duration")
        if min_forward is None and min_backward is None and not on_clock_change:
            raise ValueError("At least one jump threshold must be enabled")
        self.min_forward = min_forward
        self.min_backward = min_backward
        self.on_clock_change = on_clock_change

    def tells(self, change: ClockChange, delta: int) -> bool:
        """Whether a jump of `delta` nanoseconds is told."""
        if change in (ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED):
            return self.on_clock_change
        if self.min_forward is not None and delta >= self.min_forward.nanoseconds:
            return True
        return self.min_backward is not None and delta <= self.min_backward.nanoseconds


class TimeJump:
    """What a callback is told of a jump."""

    def __init__(self, clock_change: ClockChange, delta: Duration) -> None:
        self._clock_change = clock_change
        self._delta = delta

    @property
    def clock_change(self) -> ClockChange:
        """What changed."""
        return self._clock_change

    @property
    def delta(self) -> Duration:
        """The new time less the old."""
        return self._delta


class JumpHandle:
    """Two callbacks for jumps, until `unregister`. As a context manager it ends with the block."""

    def __init__(
        self,
        *,
        clock: Clock,
        threshold: JumpThreshold,
        pre_callback: Callable[[], object] | None,
        post_callback: Callable[[TimeJump], object] | None,
    ) -> None:
        for name, callback in (("pre_callback", pre_callback), ("post_callback", post_callback)):
            if callback is not None and not callable(callback):
                raise ValueError(f"{name} must be callable if given")
        if pre_callback is None and post_callback is None:
            raise ValueError("One of pre_callback or post_callback must be callable")
        self._clock: Clock | None = clock
        self._threshold = threshold
        self._before = pre_callback
        self._after = post_callback
        clock._handles.append(self)

    def unregister(self) -> None:
        """No further calls. Twice is allowed."""
        clock, self._clock = self._clock, None
        if clock is not None:
            clock._handles.remove(self)

    def __enter__(self) -> JumpHandle:
        return self

    def __exit__(self, *_: object) -> None:
        self.unregister()


class Clock:
    """A clock of `clock_type`. `Clock(clock_type=ClockType.ROS_TIME)` is a ROSClock."""

    _type: ClockType
    _handles: list[JumpHandle]
    _moved: threading.Condition

    def __new__(cls, *, clock_type: ClockType = ClockType.SYSTEM_TIME) -> Clock:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        made = object.__new__(ROSClock if clock_type is ClockType.ROS_TIME else cls)
        made._type = clock_type
        made._handles = []
        made._moved = threading.Condition()
        return made

    @property
    def clock_type(self) -> ClockType:
        """Which time it tells."""
        return self._type

    def __repr__(self) -> str:
        return f"Clock(clock_type={self._type.name})"

    def _nanoseconds(self) -> int:
        return time.monotonic_ns() if self._type is ClockType.STEADY_TIME else time.time_ns()

    def now(self) -> Time:
        """The present time."""
        return Time(nanoseconds=self._nanoseconds(), clock_type=self._type)

    def create_jump_callback(
        self,
        threshold: JumpThreshold,
        *,
        pre_callback: Callable[[], object] | None = None,
        post_callback: Callable[[TimeJump], object] | None = None,
    ) -> JumpHandle:
        """Call `pre_callback()` before and `post_callback(TimeJump)` after each jump that the threshold tells."""
        return JumpHandle(
            clock=self, threshold=threshold, pre_callback=pre_callback, post_callback=post_callback
        )

    def sleep_until(self, until: Time, context: Context | None = None) -> bool:
        """Sleep until this clock says `until`. False where the context ended, or time's source changed, before.

        Raises NotInitializedException where the context (the default one, if none is given) is not running, ValueError for
        a time of another kind of clock.
        """
        from roslet.compat.rclpy.utilities import get_default_context

        if until.clock_type is not self._type:
            raise ValueError("until's clock type does not match this clock's type")
        context = get_default_context() if context is None else context
        if not context.ok():
            raise NotInitializedException()
        return self._sleep(until.nanoseconds, context)

    def sleep_for(self, rel_time: Duration, context: Context | None = None) -> bool:
        """Sleep for a Duration of this clock. Returns and raises as `sleep_until`."""
        return self.sleep_until(self.now() + rel_time, context)

    def _sleep(self, until: int, context: Context) -> bool:
        changed: list[TimeJump] = []
        every = JumpThreshold(
            min_forward=Duration(nanoseconds=1), min_backward=Duration(nanoseconds=-1), on_clock_change=True
        )
        context.on_shutdown(self._wake)
        try:
            with self.create_jump_callback(every, post_callback=changed.append), self._moved:
                while context.ok():
                    if any(jump.clock_change is not ClockChange.ROS_TIME_NO_CHANGE for jump in changed):
                        return False
                    left = until - self._nanoseconds()
                    if left <= 0:
                        return True
                    self._moved.wait(_LOOK if self._stands() else min(left * 1e-9, _LOOK))
            return False
        finally:
            context._off_shutdown(self._wake)

    def _stands(self) -> bool:
        """Whether it moves only when it is told to."""
        return False

    def _wake(self) -> None:
        with self._moved:
            self._moved.notify_all()


class ROSClock(Clock):
    """The system's time, or what /clock says where `ros_time_is_active`."""

    _active: bool = False
    _told: int = 0

    def __new__(cls, **_: Any) -> ROSClock:
        made = Clock.__new__(cls, clock_type=ClockType.ROS_TIME)
        assert isinstance(made, ROSClock)
        return made

    def __init__(self, **_: Any) -> None:
        """Nothing: all is made by `__new__`."""

    @property
    def ros_time_is_active(self) -> bool:
        """Whether /clock says what time it is."""
        return self._active

    def _nanoseconds(self) -> int:
        return self._told if self._active else time.time_ns()

    def _stands(self) -> bool:
        return self._active

    def _set_ros_time_is_active(self, enabled: bool) -> None:
        if enabled == self._active:
            return
        change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
        after = self._told if enabled else time.time_ns()
        self._jump(change, after - self._nanoseconds(), lambda: setattr(self, "_active", enabled))

    def set_ros_time_override(self, time: Time) -> None:
        """/clock says so: the present time, if ROS time is active. Raises TypeError for anything but a Time."""
        if not isinstance(time, Time):
            raise TypeError("Time must be specified as rclpy.time.Time")
        told = time.nanoseconds
        if self._active:
            change = ClockChange.ROS_TIME_NO_CHANGE
            self._jump(change, told - self._told, lambda: setattr(self, "_told", told))
        else:
            self._told = told

    def _jump(self, change: ClockChange, delta: int, do: Callable[[], None]) -> None:
        told = [handle for handle in self._handles if handle._threshold.tells(change, delta)]
        for handle in told:
            if handle._before is not None:
                handle._before()
        do()
        for handle in told:
            if handle._after is not None:
                handle._after(TimeJump(change, Duration(nanoseconds=delta)))
        self._wake()


__all__ = [
    "Clock",
    "ClockChange",
    "ClockType",
    "JumpHandle",
    "JumpThreshold",
    "ROSClock",
    "TimeJump",
]
