"""`rclpy.validate_topic_name`."""

from __future__ import annotations

from roslet.compat.rclpy._names import topic_fault
from roslet.compat.rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException

TOPIC_SEPARATOR_STRING = "/"


def validate_topic_name(name: str, *, is_service: bool = False) -> bool:
    """True for a topic's or service's name, which may be relative, private and have substitutions.

    Raises InvalidTopicNameException, or InvalidServiceNameException, for anything else.
    """
    fault = topic_fault(name)
    if fault is None:
        return True
    raise (InvalidServiceNameException if is_service else InvalidTopicNameException)(name, *fault)


__all__ = ["TOPIC_SEPARATOR_STRING", "validate_topic_name"]
