"""`rclpy.expand_topic_name`."""

from __future__ import annotations

from roslet.compat.rclpy._names import expand


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """The full name of a topic or service for a node. Raises ValueError and says which of the three is wrong."""
    return expand(topic_name, node_name, node_namespace)


__all__ = ["expand_topic_name"]
