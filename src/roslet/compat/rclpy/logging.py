"""`rclpy.logging`: loggers by name."""

from __future__ import annotations

import os
import pathlib

from roslet.compat.rclpy.impl import rcutils_logger
from roslet.compat.rclpy.impl.logging_severity import LoggingSeverity
from roslet.compat.rclpy.impl.rcutils_logger import RcutilsLogger


def get_logger(name: str) -> RcutilsLogger:
    """The logger of a name. Raises ValueError for an empty one."""
    if not name:
        raise ValueError("Logger name must not be empty.")
    return RcutilsLogger(name)


def set_logger_level(name: str, level: int, detailed_error: bool = False) -> None:
    """Have a logger write nothing below a level."""
    rcutils_logger.set_level(name, level)


def get_logger_level(name: str) -> LoggingSeverity:
    """A logger's own level; UNSET where it has that of the logger above it."""
    return rcutils_logger.level_of(name)


def get_logger_effective_level(name: str) -> LoggingSeverity:
    """The level below which a logger writes nothing."""
    return rcutils_logger.effective_level(name)


def get_logging_severity_from_string(log_severity: str) -> LoggingSeverity:
    """A level by its name. Raises RuntimeError."""
    try:
        return LoggingSeverity[log_severity.upper()]
    except KeyError:
        raise RuntimeError(
            f"Failed to get log severity from name '{log_severity}': there is no such level"
        ) from None


def get_logging_directory() -> pathlib.Path:
    """Where log files would be: $ROS_LOG_DIR, or `log` in $ROS_HOME (~/.ros). None are written."""
    given = os.environ.get("ROS_LOG_DIR")
    if given:
        return pathlib.Path(given)
    return pathlib.Path(os.environ.get("ROS_HOME") or pathlib.Path.home() / ".ros") / "log"


def initialize() -> None:
    """Nothing: loggers are there from the start."""


def shutdown() -> None:
    """Nothing: there is nothing to be closed."""


def clear_config() -> None:
    """Forget what was set."""
    rcutils_logger._levels.clear()


__all__ = [
    "LoggingSeverity",
    "clear_config",
    "get_logger",
    "get_logger_effective_level",
    "get_logger_level",
    "get_logging_directory",
    "get_logging_severity_from_string",
    "initialize",
    "set_logger_level",
    "shutdown",
]
