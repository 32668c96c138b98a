"""`rclpy.qos_event`: the older name of `rclpy.event_handler`."""

from __future__ import annotations

import warnings

from roslet.compat.rclpy.event_handler import *  # noqa: F403 - the same names

warnings.warn("importing 'qos_event' is deprecated; import 'event_handler' instead", stacklevel=2)
