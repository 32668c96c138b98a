"""`rospy.rostime`: the time of this program, wall or simulated, and rospy's Time and Duration."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

from roslet.compat import genpy
from roslet.compat.rospy.exceptions import ROSInitException
from roslet.compat.session import session

if TYPE_CHECKING:
    from roslet.wire.time import Time as _Time

# Notified whenever /clock moves, and at shutdown.
_condition = threading.Condition()


class Duration(genpy.Duration):
    """A span of time; genpy.Duration under rospy's name."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"rospy.Duration[{self.to_nsec()}]"


class Time(genpy.Time):
    """A point in time; genpy.Time and `now()`."""

    __slots__ = ()

    def __repr__(self) -> str:
        return f"rospy.Time[{self.to_nsec()}]"

    @staticmethod
    def now() -> Time:
        """The present time. Raises ROSInitException before init_node."""
        return get_rostime()

    @classmethod
    def from_seconds(cls, secs: float) -> Time:
        """From seconds since the epoch; the same as `from_sec`."""
        return cls.from_sec(secs)


def get_rostime() -> Time:
    """The present time. Raises ROSInitException before init_node."""
    if not session.time_known:
        raise ROSInitException("time is not initialized. Have you called init_node()?")
    if session.wall_time or session.node is None:
        seconds, rest = divmod(time.time_ns(), 1_000_000_000)
        return Time(seconds, rest)
    now: _Time = session.node.now()
    return Time(now.secs, now.nsecs)


def get_time() -> float:
    """The present time as seconds."""
    return get_rostime().to_sec()


def get_rostime_cond() -> threading.Condition:
    """The condition that is notified whenever simulated time moves."""
    return _condition


def is_rostime_initialized() -> bool:
    return session.time_known


def set_rostime_initialized(val: bool) -> None:
    session.time_known = val


def is_wallclock() -> bool:
    """Whether time is the system's, not that of /clock."""
    return session.wall_time


def switch_to_wallclock() -> None:
    """Take the system's time from now on, whatever /clock says."""
    session.wall_time = True
    session.time_known = True
    with _condition:
        _condition.notify_all()


def wallsleep(duration: float) -> None:
    """Sleep by the system's clock; less where the node is shut down meanwhile."""
    if duration <= 0:
        return
    if session.shutting_down.is_set():
        time.sleep(duration)  # a loop that goes on after the end must not turn faster than before
    else:
        session.shutting_down.wait(duration)
