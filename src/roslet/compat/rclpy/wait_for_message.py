"""`rclpy.wait_for_message`."""

from __future__ import annotations

from typing import Any

from roslet.compat.rclpy.qos import QoSProfile


def wait_for_message(
    msg_type: Any, node: Any, topic: str, *, qos_profile: QoSProfile | int = 1, time_to_wait: float = -1
) -> tuple[bool, Any]:
    """(True, the next message of a topic), or (False, None) after `time_to_wait` seconds, unless they are negative, or where
    the context ends. Nothing else is spun meanwhile."""
    context = node.context
    subscription = node.create_subscription(msg_type, topic, lambda _: None, qos_profile)
    try:
        node._node_network.reactor.run_until(
            lambda: subscription._ready() or not context.ok(),
            None if time_to_wait < 0 else time_to_wait,
            user=False,
        )
        found = subscription._endpoint.take_one() if context.ok() else None
        return (False, None) if found is None else (True, found[0])
    finally:
        node.destroy_subscription(subscription)


__all__ = ["wait_for_message"]
