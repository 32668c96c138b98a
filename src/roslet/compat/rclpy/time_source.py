"""`rclpy.time_source`: gives clocks the time of /clock, where the parameter use_sim_time says so."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any

from roslet.compat.interfaces import message_class
from roslet.compat.rclpy.clock import ROSClock
from roslet.compat.rclpy.qos import QoSProfile, ReliabilityPolicy
from roslet.compat.rclpy.time import Time

if TYPE_CHECKING:
    from roslet.compat.rclpy.subscription import Subscription

CLOCK_TOPIC = "/clock"
USE_SIM_TIME_NAME = "use_sim_time"


class TimeSource:
    """Belongs to a node, and sets the clocks that are attached to it."""

    def __init__(self, *, node: Any = None) -> None:
        self._node: weakref.ref[Any] | None = None
        self._clocks: list[ROSClock] = []
        self._subscription: Subscription | None = None
        self._active = False
        self._last = Time()
        if node is not None:
            self.attach_node(node)

    @property
    def ros_time_is_active(self) -> bool:
        """Whether /clock says what time it is."""
        return self._active

    @ros_time_is_active.setter
    def ros_time_is_active(self, enabled: bool) -> None:
        if enabled == self._active:
            return
        self._active = enabled
        for clock in self._clocks:
            clock._set_ros_time_is_active(enabled)
        node = None if self._node is None else self._node()
        if node is None:
            return
        if enabled and self._subscription is None:
            self._subscription = node.create_subscription(
                message_class("rosgraph_msgs/msg/Clock"),
                CLOCK_TOPIC,
                self.clock_callback,
                QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
            )
        elif not enabled and self._subscription is not None:
            node.destroy_subscription(self._subscription)
            self._subscription = None

    def attach_node(self, node: Any) -> None:
        """Follow this node's parameter use_sim_time, which is declared where it is not yet."""
        self._node = weakref.ref(node)
        node._node_network.follow = self._follow
        if not node.has_parameter(USE_SIM_TIME_NAME):
            node.declare_parameter(USE_SIM_TIME_NAME, False)
        else:
            self._follow(node.get_parameter(USE_SIM_TIME_NAME).value is True)

    def _follow(self, simulated: bool) -> None:
        self.ros_time_is_active = simulated

    def detach_node(self) -> None:
        """Follow no node any more."""
        self.ros_time_is_active = False
        self._node = None

    def attach_clock(self, clock: ROSClock) -> None:
        """Set this clock too. Raises ValueError for one that is no ROSClock."""
        if not isinstance(clock, ROSClock):
            raise ValueError("Only clocks with type ROS_TIME can be attached.")
        clock.set_ros_time_override(self._last)
        clock._set_ros_time_is_active(self._active)
        self._clocks.append(clock)

    def clock_callback(self, msg: Any) -> None:
        """/clock says so."""
        self._last = Time.from_msg(msg.clock)
        for clock in self._clocks:
            clock.set_ros_time_override(self._last)


__all__ = ["CLOCK_TOPIC", "USE_SIM_TIME_NAME", "TimeSource"]
