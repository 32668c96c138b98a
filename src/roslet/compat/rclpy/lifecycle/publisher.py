"""`rclpy.lifecycle.publisher`."""

from __future__ import annotations

from typing import Any

from roslet.compat.rclpy.lifecycle.managed_entity import SimpleManagedEntity
from roslet.compat.rclpy.publisher import Publisher


class LifecyclePublisher(SimpleManagedEntity, Publisher):
    """A publisher that publishes while its node is active, and else drops what it is given."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)

    @SimpleManagedEntity.when_enabled
    def publish(self, msg: Any) -> None:
        Publisher.publish(self, msg)


__all__ = ["LifecyclePublisher"]
