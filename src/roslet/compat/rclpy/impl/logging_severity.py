"""`rclpy.impl.logging_severity`."""

from __future__ import annotations

from enum import IntEnum


class LoggingSeverity(IntEnum):
    """The levels of loggers, numbered as rcutils and rcl_interfaces/msg/Log do."""

    UNSET = 0
    DEBUG = 10
    INFO = 20
    WARN = 30
    ERROR = 40
    FATAL = 50


__all__ = ["LoggingSeverity"]
