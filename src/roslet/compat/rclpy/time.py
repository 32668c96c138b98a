"""`rclpy.time`: a point in time of one kind of clock."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy.clock_type import ClockType
from roslet.compat.rclpy.constants import S_TO_NS
from roslet.compat.rclpy.duration import Duration

if TYPE_CHECKING:
    from typing_extensions import Self


class Time:
    """`seconds` and `nanoseconds` after the epoch of a clock of `clock_type`.

    Times of different kinds of clock are neither compared nor subtracted: TypeError. Raises ValueError for a negative time,
    OverflowError beyond 63 bits of nanoseconds.
    """

    __slots__ = ("_clock_type", "_nanoseconds")
    __hash__ = None  # type: ignore[assignment]

    def __init__(
        self, *, seconds: float = 0, nanoseconds: float = 0, clock_type: ClockType = ClockType.SYSTEM_TIME
    ) -> None:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        for name, value in (("Seconds", seconds), ("Nanoseconds", nanoseconds)):
            if value < 0:
                raise ValueError(f"{name} value must not be negative")
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if total >= 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C time point.")
        self._nanoseconds = total
        self._clock_type = clock_type

    @property
    def nanoseconds(self) -> int:
        """Nanoseconds since the epoch of the clock."""
        return self._nanoseconds

    @property
    def clock_type(self) -> ClockType:
        """The kind of clock that the time belongs to."""
        return self._clock_type

    def seconds_nanoseconds(self) -> tuple[int, int]:
        """Whole seconds, and the nanoseconds beyond them."""
        return divmod(self._nanoseconds, S_TO_NS)

    def to_msg(self) -> Any:
        """A builtin_interfaces/msg/Time."""
        seconds, rest = divmod(self._nanoseconds, S_TO_NS)
        return _message_class()(sec=seconds, nanosec=rest)

    @classmethod
    def from_msg(cls, msg: Any, clock_type: ClockType = ClockType.ROS_TIME) -> Self:
        """From a builtin_interfaces/msg/Time. Raises TypeError for anything else."""
        if not isinstance(msg, _message_class()):
            raise TypeError("Must pass a builtin_interfaces.msg.Time object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self._nanoseconds}, clock_type={self._clock_type.name})"

    def __add__(self, other: Duration) -> Time:
        if not isinstance(other, Duration):
            return NotImplemented
        try:
            return Time(nanoseconds=self._nanoseconds + other.nanoseconds, clock_type=self._clock_type)
        except OverflowError as error:
            raise OverflowError("Addition leads to overflow in C storage.") from error

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Time):
            if other._clock_type != self._clock_type:
                raise TypeError("Can't subtract times with different clock types")
            return Duration(nanoseconds=self._nanoseconds - other._nanoseconds)
        if isinstance(other, Duration):
            try:
                return Time(nanoseconds=self._nanoseconds - other.nanoseconds, clock_type=self._clock_type)
            except ValueError as error:
                raise ValueError("Subtraction leads to negative time.") from error
        return NotImplemented

    def _of(self, other: Time) -> int:
        """The other's nanoseconds, where it may be compared with this."""
        if other._clock_type != self._clock_type:
            raise TypeError("Can't compare times with different clock types")
        return other._nanoseconds

    def __eq__(self, other: object) -> bool:
        return self._nanoseconds == self._of(other) if isinstance(other, Time) else NotImplemented

    def __lt__(self, other: Time) -> bool:
        return self._nanoseconds < self._of(other) if isinstance(other, Time) else NotImplemented

    def __le__(self, other: Time) -> bool:
        return self._nanoseconds <= self._of(other) if isinstance(other, Time) else NotImplemented

    def __gt__(self, other: Time) -> bool:
        return self._nanoseconds > self._of(other) if isinstance(other, Time) else NotImplemented

    def __ge__(self, other: Time) -> bool:
        return self._nanoseconds >= self._of(other) if isinstance(other, Time) else NotImplemented


def _message_class() -> Any:
    from roslet.compat.interfaces import message_class

    return message_class("builtin_interfaces/msg/Time")


__all__ = ["Time"]
