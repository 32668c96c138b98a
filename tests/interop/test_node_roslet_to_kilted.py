"""A roslet node publishes and calls, rclpy (kilted, Fast DDS) hears and serves."""

from __future__ import annotations

from interop.ros2_exchange import Exchange


class TestExchange(Exchange):
    talker, listener = "roslet", "kilted"
