"""A rospy program's log: standard output and error in rospy's format, /rosout, throttles."""

from __future__ import annotations

import os
import re
import sys
import threading
import time
from typing import TYPE_CHECKING, Any

from roslet.compat.session import session
from roslet.node.log import DEBUG, ERROR, FATAL, INFO, LEVELS, WARN, Log

if TYPE_CHECKING:
    from types import FrameType

FORMAT = "[${severity}] [${time}]: ${message}"
_COLORS = {DEBUG: "\x1b[32m", WARN: "\x1b[33m", ERROR: "\x1b[31m", FATAL: "\x1b[31m"}
_TOKEN = re.compile(r"\$\{([a-z]+)(?::[^}]*)?\}")

# Where a log line with its own name is and how often: bounds what a program that logs under ever new names can hold.
MAX_PLACES = 10000


class RospyLog(Log):
    """The node's log, printed as rospy prints."""

    def _print(self, level: int, text: str) -> None:
        emit(level, text, None, "rosout")


_lock = threading.Lock()
_levels: dict[str, int] = {}
_level = INFO


def set_level(level: int, logger: str = "rosout") -> None:
    """Log nothing below `level` from now on; `logger` is "rosout" or the name of one of its children."""
    global _level
    if logger == "rosout":
        _level = level
    else:
        _levels[logger] = level


def levels() -> dict[str, int]:
    """The loggers that there are, and their levels."""
    return {"rosout": _level, **_levels}


def log(level: int, msg: Any, args: tuple[Any, ...], logger_name: str | None, depth: int) -> None:
    """Log `msg % args` as the line `depth` calls up."""
    name = f"rosout.{logger_name}" if logger_name else "rosout"
    if level < _levels.get(name, _level):
        return
    text = _text(msg, args)
    if session.node is None:
        # Without a node rospy has no handler yet: Python's last resort prints warnings and worse, bare.
        if level >= WARN:
            print(text, file=sys.stderr)
        return
    frame = sys._getframe(depth)
    emit(level, text, frame, name)
    own = session.node.log
    if own._publisher is not None:
        own.quiet, before = True, own.quiet
        try:
            own.write(level, text, depth + 1)
        finally:
            own.quiet = before


def _text(msg: Any, args: tuple[Any, ...]) -> str:
    if not args:
        return str(msg)
    if len(args) == 1 and isinstance(args[0], dict) and args[0]:
        return str(msg) % args[0]
    return str(msg) % args


def emit(level: int, text: str, frame: FrameType | None, logger: str) -> None:
    """Print one line: up to INFO to standard output, the rest to standard error."""
    stream = sys.stdout if level < WARN else sys.stderr
    now = f"{time.time():.6f}"
    values = {
        "severity": LEVELS[level],
        "message": text,
        "walltime": now,
        "thread": threading.current_thread().name,
        "logger": logger,
        "node": session.name,
        "time": now,
        "file": frame.f_code.co_filename if frame is not None else "",
        "line": str(frame.f_lineno) if frame is not None else "",
        "function": frame.f_code.co_name if frame is not None else "",
    }
    node = session.node
    if node is not None and not session.wall_time:
        values["time"] = f"{now}, {node.clock.seconds():.6f}"
    form = os.environ.get("ROSCONSOLE_FORMAT", FORMAT)
    line = _TOKEN.sub(lambda token: values.get(token.group(1), token.group(0)), form)
    color = _COLORS.get(level)
    try:
        if color and stream.isatty():
            line = f"{color}{line}\x1b[0m"
        with _lock:
            stream.write(line + "\n")
            stream.flush()
    except (OSError, ValueError):
        return  # nobody reads it any more; /rosout still has the line


# -- where a line is, for throttles


_said: set[tuple[str, int]] = set()
_when: dict[tuple[str, int], float] = {}
_what: dict[tuple[str, int], tuple[float, str]] = {}


def place(depth: int) -> tuple[str, int]:
    """The file and line `depth` calls up."""
    frame = sys._getframe(depth)
    return frame.f_code.co_filename, frame.f_lineno


def first_time(where: tuple[str, int]) -> bool:
    """Whether this line has not logged yet."""
    if where in _said:
        return False
    _said.add(where)
    return True


def after_period(where: tuple[str, int], period: float, now: float) -> bool:
    """Whether this line's last log is at least `period` seconds ago, or in the future."""
    last = _when.get(where)
    if last is not None and 0 <= now - last < period:
        return False
    _room(_when)
    _when[where] = now
    return True


def not_identical(where: tuple[str, int], period: float, text: str, now: float) -> bool:
    """Whether this line's text is another than last time, or `period` seconds have passed."""
    last = _what.get(where)
    if last is not None and last[1] == text and 0 <= now - last[0] < period:
        return False
    _room(_what)
    _what[where] = (now, text)
    return True


def _room(table: dict[Any, Any]) -> None:
    if len(table) >= MAX_PLACES:
        table.clear()
