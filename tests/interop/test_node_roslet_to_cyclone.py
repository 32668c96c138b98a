"""A roslet node publishes and calls, CycloneDDS (its Python wheel, with the names of ROS and the service header of its rmw)
hears and serves.
"""

from __future__ import annotations

from interop.ros2_exchange import CycloneExchange


class TestExchange(CycloneExchange):
    talker, listener = "roslet", "cyclone"
