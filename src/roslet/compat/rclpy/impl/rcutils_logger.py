"""`rclpy.impl.rcutils_logger`: loggers, their levels, their filters, and how a line looks.

Levels are inherited by name: `a.b` has that of `a` where it has none of its own. A line goes to standard error and to the
sinks of the logger, which publish it to /rosout.
"""

from __future__ import annotations

import os
import re
import sys
import threading
import time
import warnings
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy.impl.logging_severity import LoggingSeverity

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

    from roslet.compat.rclpy._arguments import Arguments

    # level, name, text, file, function, line, nanoseconds
    Sink = Callable[[int, str, str, str, str, int, int], object]

_FORMAT = "[{severity}] [{time}] [{name}]: {message}"
_TOKEN = re.compile(r"\{(\w+)\}")
_COLORS = {10: "\x1b[32m", 30: "\x1b[33m", 40: "\x1b[31m", 50: "\x1b[31m"}
# Lines of a program that log with a filter; a program that makes up more starts anew.
_MAX_PLACES = 10_000

_write_lock = threading.Lock()
_levels: dict[str, int] = {}
_sinks: dict[str, list[Sink]] = {}
_places: dict[tuple[str, int, str, int], _Place] = {}


def configure(arguments: Arguments) -> None:
    """Set the levels that the program's arguments say."""
    _levels.update(arguments.levels)


def set_level(name: str, level: int) -> None:
    """The level of a logger; UNSET: that of the logger above it again."""
    if level:
        _levels[name] = int(LoggingSeverity(level))
    else:
        _levels.pop(name, None)


def level_of(name: str) -> LoggingSeverity:
    """A logger's own level."""
    return LoggingSeverity(_levels.get(name, 0))


def effective_level(name: str) -> LoggingSeverity:
    """The level that holds for a logger."""
    while name:
        level = _levels.get(name)
        if level:
            return LoggingSeverity(level)
        name = name.rpartition(".")[0]
    return LoggingSeverity(_levels.get("") or LoggingSeverity.INFO)


def add_sink(name: str, sink: Sink) -> None:
    """Give lines of a logger, and of those below it, to `sink` too."""
    _sinks.setdefault(name, []).append(sink)


def remove_sink(name: str, sink: Sink) -> None:
    """Take a sink back."""
    _sinks[name].remove(sink)
    if not _sinks[name]:
        del _sinks[name]


def write(level: int, name: str, text: str, frame: FrameType | None) -> None:
    """Write a line that its level lets through."""
    now = time.time_ns()
    file = frame.f_code.co_filename if frame is not None else ""
    function = frame.f_code.co_name if frame is not None else ""
    line = frame.f_lineno if frame is not None else 0
    _print(level, name, text, file, function, line, now)
    above = name
    while above:
        for sink in list(_sinks.get(above, ())):
            sink(level, name, text, file, function, line, now)
        above = above.rpartition(".")[0]


def _print(level: int, name: str, text: str, file: str, function: str, line: int, now: int) -> None:
    stream = sys.stdout if os.environ.get("RCUTILS_LOGGING_USE_STDOUT") == "1" else sys.stderr
    seconds, rest = divmod(now, 1_000_000_000)
    values = {
        "severity": LoggingSeverity(level).name,
        "name": name,
        "message": text,
        "time": f"{seconds}.{rest:09d}",
        "time_as_nanoseconds": str(now),
        "function_name": function,
        "file_name": file,
        "line_number": str(line),
    }
    form = os.environ.get("RCUTILS_CONSOLE_OUTPUT_FORMAT") or _FORMAT
    said = _TOKEN.sub(lambda token: values.get(token.group(1), token.group(0)), form)
    color = _COLORS.get(level)
    wanted = os.environ.get("RCUTILS_COLORIZED_OUTPUT")
    try:
        if color and (wanted == "1" or (wanted != "0" and stream.isatty())):
            said = f"{color}{said}\x1b[0m"
        with _write_lock:
            stream.write(said + "\n")
            stream.flush()
    except (OSError, ValueError):
        return  # nobody reads it any more


class _Place:
    """A line of the program that logs with filters: what it asked for first, and what it did."""

    __slots__ = ("last", "name", "passed", "severity", "wanted")

    def __init__(self, name: str, severity: int, wanted: tuple[object, ...]) -> None:
        self.name = name
        self.severity = severity
        self.wanted = wanted
        self.passed = 0
        self.last: int | None = None

    def check(self, name: str, severity: int, wanted: tuple[object, ...]) -> None:
        for what, now, before in (
            ("Logger name", name, self.name),
            ("Logger severity", severity, self.severity),
            ("Logging filters", wanted, self.wanted),
        ):
            if now != before:
                raise ValueError(f"{what} cannot be changed between calls.")

    def lets_through(self, throttle: float | None, clock: Any, skip_first: bool, once: bool) -> bool:
        if throttle is not None:
            now = time.monotonic_ns() if clock is None else clock.now().nanoseconds
            if self.last is not None and 0 <= now - self.last < throttle * 1e9:
                return False
            self.last = now
        self.passed += 1
        if skip_first and self.passed == 1:
            return False
        return not once or self.passed == 1 + skip_first


class RcutilsLogger:
    """A logger by name. Each function takes, beside the text, filters that belong to the line of the program it stands in:

    once                        only the first time
    skip_first                  not the first time
    throttle_duration_sec       at most once in so many seconds, by the clock `throttle_time_source_type` or a steady one

    They return whether the line was written. Raises TypeError for a text that is none and for unknown filters, ValueError
    where a line of the program changes its filters, level or logger.
    """

    def __init__(self, name: str = "") -> None:
        self.name = name

    def get_child(self, name: str) -> RcutilsLogger:
        """The logger `self.name.name`, which has this one's level until it gets its own."""
        if not name:
            raise ValueError("Child logger name must not be empty.")
        return RcutilsLogger(f"{self.name}.{name}" if self.name else name)

    def set_level(self, level: int) -> None:
        """Write nothing below this level."""
        set_level(self.name, level)

    def get_effective_level(self) -> LoggingSeverity:
        """The level below which nothing is written."""
        return effective_level(self.name)

    def is_enabled_for(self, severity: int) -> bool:
        """Whether lines of this level are written."""
        return severity >= effective_level(self.name)

    def log(self, message: str, severity: int, name: str | None = None, **kwargs: Any) -> bool:
        """Write a line of any level."""
        return self._log(message, severity, name, kwargs)

    def debug(self, message: str, **kwargs: Any) -> bool:
        return self._log(message, LoggingSeverity.DEBUG, None, kwargs)

    def info(self, message: str, **kwargs: Any) -> bool:
        return self._log(message, LoggingSeverity.INFO, None, kwargs)

    def warning(self, message: str, **kwargs: Any) -> bool:
        return self._log(message, LoggingSeverity.WARN, None, kwargs)

    def warn(self, message: str, **kwargs: Any) -> bool:
        """The old name of `warning`."""
        warnings.warn(
            "Deprecated in favor of :py:classmethod:RcutilsLogger.warning:.", DeprecationWarning, stacklevel=2
        )
        return self._log(message, LoggingSeverity.WARN, None, kwargs)

    def error(self, message: str, **kwargs: Any) -> bool:
        return self._log(message, LoggingSeverity.ERROR, None, kwargs)

    def fatal(self, message: str, **kwargs: Any) -> bool:
        return self._log(message, LoggingSeverity.FATAL, None, kwargs)

    def _log(self, message: str, severity: int, name: str | None, filters: dict[str, Any]) -> bool:
        if not isinstance(message, str):
            raise TypeError(f"a line of the log must be text, not {type(message).__name__}")
        severity = int(LoggingSeverity(severity))
        name = self.name if name is None else name
        frame: FrameType | None = sys._getframe(2)
        if filters and not self._passes(name, severity, filters, frame):
            return False
        if severity < effective_level(name):
            return False
        write(severity, name, message, frame)
        return True

    def _passes(self, name: str, severity: int, filters: dict[str, Any], frame: Any) -> bool:
        left = dict(filters)
        throttle = left.pop("throttle_duration_sec", None)
        clock = left.pop("throttle_time_source_type", None)
        skip_first = left.pop("skip_first", None)
        once = left.pop("once", None)
        if left:
            raise TypeError(f"Unknown parameters used in log call: {sorted(left)}")
        if clock is not None and throttle is None:
            raise TypeError("throttle_time_source_type is nothing without throttle_duration_sec")
        wanted = (throttle, bool(skip_first), bool(once))
        place = (frame.f_code.co_filename, frame.f_lineno, frame.f_code.co_name, frame.f_lasti)
        known = _places.get(place)
        if known is None:
            if len(_places) >= _MAX_PLACES:
                _places.clear()
            known = _places[place] = _Place(name, severity, wanted)
        known.check(name, severity, wanted)
        if severity < effective_level(name):
            return False
        return known.lets_through(throttle, clock, bool(skip_first), bool(once))


__all__ = ["RcutilsLogger"]
