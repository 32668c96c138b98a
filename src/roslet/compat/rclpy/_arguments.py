"""What a program is told after `--ros-args`, with rclpy's exceptions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roslet.compat.rclpy.exceptions import RCLError, UnknownROSArgsError
from roslet.compat.rclpy.impl.logging_severity import LoggingSeverity
from roslet.errors import InvalidName
from roslet.names import Ros2Arguments

if TYPE_CHECKING:
    from collections.abc import Sequence


class Arguments:
    """`ros` is the words as roslet sorts them, with those of `bare` among its rules: remappings that stand outside, as in
    ROS 1. They hold, and rcl warns of them. `rest` is the program's own words, `levels` those of loggers by name.

    Raises UnknownROSArgsError for words that mean nothing, RCLError for wrong ones.
    """

    def __init__(self, words: Sequence[str]) -> None:
        try:
            self.ros = Ros2Arguments(list(words))
            self.bare = [word for word in self.ros.rest if ":=" in word.strip(":=")]
            self.ros.remappings += Ros2Arguments(
                ["--ros-args", *(part for word in self.bare for part in ("-r", word))]
            ).remappings
        except InvalidName as error:
            raise RCLError(f"failed to initialize rcl: {error}") from None
        if self.ros.unknown:
            raise UnknownROSArgsError(self.ros.unknown)
        self.rest = [word for word in self.ros.rest if word not in self.bare]
        self.levels: dict[str, int] = {}
        for logger, level in self.ros.log_levels.items():
            if level.upper() not in LoggingSeverity.__members__:
                raise RCLError(f"failed to initialize rcl: {level!r} is no level of a log")
            self.levels[logger] = LoggingSeverity[level.upper()]
