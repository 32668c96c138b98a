"""ROS 1 `time` and `duration` as values: whole seconds and nanoseconds, with the arithmetic of ROS 1's own
classes.

Runs on MicroPython. A ROS 1 serialiser touches `secs` and `nsecs` only, so any object with these two serves in a message;
that of a ROS 2 message touches `sec` and `nanosec`, which these classes have too.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any, TypeVar

    _Span = TypeVar("_Span", bound="_Seconds")

NANOSECONDS = 1000000000


class _Seconds:
    """What Time and Duration share. Mutable; equal, ordered and hashed by value."""

    __slots__ = ("nsecs", "secs")

    secs: int
    nsecs: int

    def __init__(self, secs: "int | float" = 0, nsecs: int = 0) -> None:
        if not isinstance(secs, int):
            if nsecs:
                raise ValueError("nanoseconds may only be given with whole seconds")
            whole = int(secs)
            nsecs = round((secs - whole) * NANOSECONDS)
            secs = whole
        self.secs = secs
        self.nsecs = int(nsecs)
        self.canon()

    @property
    def sec(self) -> int:
        """`secs`, by its name on ROS 2."""
        return self.secs

    @sec.setter
    def sec(self, value: int) -> None:
        self.secs = value

    @property
    def nanosec(self) -> int:
        """`nsecs`, by its name on ROS 2."""
        return self.nsecs

    @nanosec.setter
    def nanosec(self, value: int) -> None:
        self.nsecs = value

    def canon(self) -> None:
        """Bring `nsecs` into 0 to 999,999,999 and carry into `secs`."""
        if not 0 <= self.nsecs < NANOSECONDS:
            self.secs += self.nsecs // NANOSECONDS
            self.nsecs %= NANOSECONDS

    def set(self, secs: int, nsecs: int) -> None:
        """Set both parts as they are; `canon` brings them into range."""
        self.secs = secs
        self.nsecs = nsecs

    def is_zero(self) -> bool:
        """True for zero seconds and zero nanoseconds."""
        return self.secs == 0 and self.nsecs == 0

    def to_sec(self) -> float:
        """Seconds as a float; of a present-day time about 100 ns are lost in the rounding."""
        return self.secs + self.nsecs / 1e9

    def to_nsec(self) -> int:
        """Whole nanoseconds, exact."""
        return self.secs * NANOSECONDS + self.nsecs

    def __bool__(self) -> bool:
        return not self.is_zero()

    def __hash__(self) -> int:
        return hash((self.secs, self.nsecs))

    def __repr__(self) -> str:
        return "%s(secs=%d, nsecs=%d)" % (type(self).__name__, self.secs, self.nsecs)

    def __str__(self) -> str:
        return str(self.to_nsec())

    def _like(self, other: object) -> bool:
        return False

    def __eq__(self, other: object) -> bool:
        if not self._like(other):
            return NotImplemented
        return self.to_nsec() == other.to_nsec()  # type: ignore[attr-defined, no-any-return]

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __lt__(self, other: "_Seconds") -> bool:
        if not self._like(other):
            return NotImplemented
        return self.to_nsec() < other.to_nsec()

    def __le__(self, other: "_Seconds") -> bool:
        if not self._like(other):
            return NotImplemented
        return self.to_nsec() <= other.to_nsec()

    def __gt__(self, other: "_Seconds") -> bool:
        if not self._like(other):
            return NotImplemented
        return self.to_nsec() > other.to_nsec()

    def __ge__(self, other: "_Seconds") -> bool:
        if not self._like(other):
            return NotImplemented
        return self.to_nsec() >= other.to_nsec()


class Time(_Seconds):
    """A point in time since the epoch, never negative. `Time(1.5)`, `Time(1, 500000000)`,
    `Time.from_sec(1.5)`.

    Raises TypeError if the value is negative. Time - Time is a Duration, Time +/- Duration is a Time.
    """

    __slots__ = ()

    def __init__(self, secs: "int | float" = 0, nsecs: int = 0) -> None:
        super().__init__(secs, nsecs)
        if self.secs < 0:
            raise TypeError("a time is never negative")

    @classmethod
    def from_sec(cls: "type[_Span]", seconds: float) -> "_Span":
        """From seconds since the epoch, rounded to a nanosecond."""
        return cls(float(seconds))

    @classmethod
    def from_seconds(cls: "type[_Span]", seconds: float) -> "_Span":
        """The same as `from_sec`."""
        return cls(float(seconds))

    def to_time(self) -> float:
        """Seconds since the epoch, as `time.time()` counts them."""
        return self.to_sec()

    def to_seconds(self) -> float:
        """The same as `to_sec`."""
        return self.to_sec()

    def _like(self, other: object) -> bool:
        return isinstance(other, Time)

    def __add__(self, other: "Duration") -> "Time":
        if not isinstance(other, Duration):
            return NotImplemented
        return type(self)(self.secs + other.secs, self.nsecs + other.nsecs)

    __radd__ = __add__

    def __sub__(self, other: "Any") -> "Any":
        if isinstance(other, Time):
            return Duration(self.secs - other.secs, self.nsecs - other.nsecs)
        if isinstance(other, Duration):
            return type(self)(self.secs - other.secs, self.nsecs - other.nsecs)
        return NotImplemented


class Duration(_Seconds):
    """A span of time, of either sign; `nsecs` is never negative: -0.5 s is -1 s and 500,000,000 ns."""

    __slots__ = ()

    @classmethod
    def from_sec(cls: "type[_Span]", seconds: float) -> "_Span":
        """From seconds, rounded to a nanosecond."""
        return cls(float(seconds))

    @classmethod
    def from_seconds(cls: "type[_Span]", seconds: float) -> "_Span":
        """The same as `from_sec`."""
        return cls(float(seconds))

    def to_seconds(self) -> float:
        """The same as `to_sec`."""
        return self.to_sec()

    def _like(self, other: object) -> bool:
        return isinstance(other, Duration)

    def __neg__(self) -> "Duration":
        return type(self)(-self.secs, -self.nsecs)

    def __abs__(self) -> "Duration":
        return -self if self.secs < 0 else self

    def __add__(self, other: "Any") -> "Any":
        if isinstance(other, Time):
            return other.__add__(self)
        if isinstance(other, Duration):
            return type(self)(self.secs + other.secs, self.nsecs + other.nsecs)
        return NotImplemented

    def __sub__(self, other: "Duration") -> "Duration":
        if not isinstance(other, Duration):
            return NotImplemented
        return type(self)(self.secs - other.secs, self.nsecs - other.nsecs)

    def __mul__(self, factor: "int | float") -> "Duration":
        if isinstance(factor, int):
            return type(self)(self.secs * factor, self.nsecs * factor)
        if isinstance(factor, float):
            return type(self)(self.to_sec() * factor)
        return NotImplemented

    __rmul__ = __mul__

    def __floordiv__(self, divisor: "Any") -> "Any":
        if isinstance(divisor, Duration):
            return self.to_nsec() // divisor.to_nsec()
        if isinstance(divisor, (int, float)):
            return type(self)(float(self.to_sec() // divisor))  # whole seconds, as genpy divides
        return NotImplemented

    def __truediv__(self, divisor: "Any") -> "Any":
        if isinstance(divisor, Duration):
            return self.to_nsec() / divisor.to_nsec()
        if isinstance(divisor, (int, float)):
            return type(self)(self.to_sec() / divisor)
        return NotImplemented

    def __mod__(self, divisor: "Duration") -> "Duration":
        if not isinstance(divisor, Duration):
            return NotImplemented
        return type(self)(0, self.to_nsec() % divisor.to_nsec())

    def __divmod__(self, divisor: "Duration") -> "tuple[int, Duration]":
        if not isinstance(divisor, Duration):
            return NotImplemented
        whole, rest = divmod(self.to_nsec(), divisor.to_nsec())
        return whole, type(self)(0, rest)
