"""`rclpy.duration`: a span of time in nanoseconds, of either sign, within 64 bits."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy.constants import S_TO_NS

if TYPE_CHECKING:
    from typing_extensions import Self

# What a C int64_t holds.
_LEAST = -(2**63)
_MOST = 2**63 - 1


class Duration:
    """`seconds` and `nanoseconds`, added. Raises OverflowError beyond 64 bits of nanoseconds."""

    __slots__ = ("_nanoseconds",)
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, *, seconds: float = 0, nanoseconds: float = 0) -> None:
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if not _LEAST <= total <= _MOST:
            raise OverflowError("Total nanoseconds value is too large to store in C duration.")
        self._nanoseconds = total

    @property
    def nanoseconds(self) -> int:
        """All of it, in nanoseconds."""
        return self._nanoseconds

    def to_msg(self) -> Any:
        """A builtin_interfaces/msg/Duration; its `nanosec` is never negative."""
        seconds, rest = divmod(self._nanoseconds, S_TO_NS)
        return _message_class()(sec=seconds, nanosec=rest)

    @classmethod
    def from_msg(cls, msg: Any) -> Self:
        """From a builtin_interfaces/msg/Duration. Raises TypeError for anything else."""
        if not isinstance(msg, _message_class()):
            raise TypeError("Must pass a builtin_interfaces.msg.Duration object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)

    def __repr__(self) -> str:
        return f"Duration(nanoseconds={self._nanoseconds})"

    def __str__(self) -> str:
        return "Infinite" if self._nanoseconds == _MOST else f"{self._nanoseconds} nanoseconds"

    def __add__(self, other: Duration) -> Duration:
        if isinstance(other, Duration):
            return Duration(nanoseconds=self._nanoseconds + other._nanoseconds)
        return NotImplemented

    def __sub__(self, other: Duration) -> Duration:
        if isinstance(other, Duration):
            return Duration(nanoseconds=self._nanoseconds - other._nanoseconds)
        return NotImplemented

    def __mul__(self, factor: float) -> Duration:
        if isinstance(factor, int):
            return Duration(nanoseconds=self._nanoseconds * factor)
        if not isinstance(factor, float):
            return NotImplemented
        if math.isfinite(factor):
            return Duration(nanoseconds=int(self._nanoseconds * factor))
        if factor == math.inf:
            return Infinite
        raise ValueError("Can't multiply duration with nan")

    def __eq__(self, other: object) -> bool:
        return self._nanoseconds == other._nanoseconds if isinstance(other, Duration) else NotImplemented

    def __lt__(self, other: Duration) -> bool:
        return self._nanoseconds < other._nanoseconds if isinstance(other, Duration) else NotImplemented

    def __le__(self, other: Duration) -> bool:
        return self._nanoseconds <= other._nanoseconds if isinstance(other, Duration) else NotImplemented

    def __gt__(self, other: Duration) -> bool:
        return self._nanoseconds > other._nanoseconds if isinstance(other, Duration) else NotImplemented

    def __ge__(self, other: Duration) -> bool:
        return self._nanoseconds >= other._nanoseconds if isinstance(other, Duration) else NotImplemented


def _message_class() -> Any:
    from roslet.compat.interfaces import message_class

    return message_class("builtin_interfaces/msg/Duration")


Infinite = Duration(nanoseconds=_MOST)
"""No bound at all."""

__all__ = ["Duration", "Infinite"]
