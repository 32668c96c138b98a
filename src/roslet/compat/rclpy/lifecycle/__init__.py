"""`rclpy.lifecycle`: nodes that others configure, activate, deactivate and shut down."""

from roslet.compat.rclpy.lifecycle._machine import TransitionCallbackReturn
from roslet.compat.rclpy.lifecycle.managed_entity import ManagedEntity, SimpleManagedEntity
from roslet.compat.rclpy.lifecycle.node import LifecycleNode, LifecycleNodeMixin, LifecycleState
from roslet.compat.rclpy.lifecycle.publisher import LifecyclePublisher

Node = LifecycleNode
NodeMixin = LifecycleNodeMixin
State = LifecycleState
Publisher = LifecyclePublisher

__all__ = [
    "LifecycleNode",
    "LifecycleNodeMixin",
    "LifecyclePublisher",
    "LifecycleState",
    "ManagedEntity",
    "Node",
    "NodeMixin",
    "Publisher",
    "SimpleManagedEntity",
    "State",
    "TransitionCallbackReturn",
]
