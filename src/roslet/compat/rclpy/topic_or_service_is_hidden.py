"""`rclpy.topic_or_service_is_hidden`."""

from __future__ import annotations

HIDDEN_TOPIC_PREFIX = "_"


def topic_or_service_is_hidden(name: str) -> bool:
    """Whether tools leave a name out of their lists: a part of it begins with an underscore."""
    return f"/{HIDDEN_TOPIC_PREFIX}" in "/" + name


__all__ = ["HIDDEN_TOPIC_PREFIX", "topic_or_service_is_hidden"]
