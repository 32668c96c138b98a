"""`rclpy.clock_type`."""

from __future__ import annotations

from enum import Enum


class ClockType(Enum):
    """Which time a clock tells: that of /clock or the system's (`ROS_TIME`), the system's, or one that never jumps."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3


__all__ = ["ClockType"]
