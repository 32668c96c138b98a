"""A node's log: standard error, and /rosout for everybody else."""

from __future__ import annotations

import os
import sys
import time

from roslet.errors import NodeClosed, RosletError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from roslet.node.node import Node
    from roslet.node.topics import Publisher

DEBUG = 1
INFO = 2
WARN = 4
ERROR = 8
FATAL = 16
# rosgraph_msgs/Log, and the names people read.
LEVELS = {DEBUG: "DEBUG", INFO: "INFO", WARN: "WARN", ERROR: "ERROR", FATAL: "FATAL"}
LEVEL_NAMES = {"debug": DEBUG, "info": INFO, "warn": WARN, "error": ERROR, "fatal": FATAL}
"""Levels as `--log-level` names them."""
_COLORS = {DEBUG: "\x1b[32m", WARN: "\x1b[33m", ERROR: "\x1b[31m", FATAL: "\x1b[31m"}


class Log:
    """`log.info("text")` and its like. What is below `level` (INFO at first) is not logged at all."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._publisher: Publisher | None = None
        self.level = INFO
        self.quiet = False

    def debug(self, text: str) -> None:
        self.write(DEBUG, text)

    def info(self, text: str) -> None:
        self.write(INFO, text)

    def warning(self, text: str) -> None:
        self.write(WARN, text)

    warn = warning

    def error(self, text: str) -> None:
        self.write(ERROR, text)

    def fatal(self, text: str) -> None:
        self.write(FATAL, text)

    def write(self, level: int, text: str, depth: int = 2) -> None:
        """Log `text`; `depth` is how many calls up the place is that wrote it."""
        if level < self.level:
            return
        text = str(text)
        if not self.quiet:
            self._print(level, text)
        publisher = self._publisher
        if publisher is None:
            return
        frame = sys._getframe(min(depth, _stack_depth()))
        try:
            entry: Any = publisher.type()
            entry.file = os.path.basename(frame.f_code.co_filename)
            entry.function = frame.f_code.co_name
            entry.line = frame.f_lineno
            self._node._network.fill_log_entry(entry, level, text)
            publisher.publish(entry)
        except NodeClosed:
            return
        except RosletError as error:
            self._print(ERROR, f"cannot publish to /rosout: {error}")

    def _print(self, level: int, text: str) -> None:
        stream = sys.stderr
        line = f"[{LEVELS[level]}] [{time.time():.6f}] [{self._node.name}]: {text}"
        color = _COLORS.get(level)
        if color and stream.isatty():
            line = f"{color}{line}\x1b[0m"
        try:
            print(line, file=stream, flush=True)
        except (OSError, ValueError):
            return  # nobody reads standard error any more; /rosout still has the line


def _stack_depth() -> int:
    depth = 0
    frame = sys._getframe(1)
    while frame.f_back is not None and depth < 8:
        frame = frame.f_back
        depth += 1
    return depth
