"""rclpy (jazzy, Fast DDS) publishes and calls, a roslet node hears and serves.

User-defined types are in the files of Cyclone: the wheels of rclpy have no generator for them.
"""

from __future__ import annotations

from interop.ros2_exchange import Exchange


class TestExchange(Exchange):
    talker, listener = "jazzy", "roslet"
