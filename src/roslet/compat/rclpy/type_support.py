"""`rclpy.type_support`: whether a class is one that a definition made."""

from __future__ import annotations

from typing import Any

from roslet.wire.message import Action, Message, Service


def check_for_type_support(msg_or_srv_type: Any) -> None:
    """Nothing for a ROS 2 message, service or action class; raises AttributeError for anything else."""
    kind = msg_or_srv_type
    if (
        isinstance(kind, type)
        and issubclass(kind, (Message, Service, Action))
        and hasattr(kind, "_type_hash")
    ):
        return
    name = getattr(kind, "__name__", repr(kind))
    raise AttributeError(
        f"type object '{name}' has no attribute '_TYPE_SUPPORT'. This might be a ROS 1 message type but it should be"
        " a ROS 2 message type. Make sure to source your ROS 2 workspace after your ROS 1 workspace."
    )


def check_is_valid_msg_type(msg_type: Any) -> None:
    """Nothing for a message class. Raises RuntimeError for another interface, AttributeError for what is none."""
    check_for_type_support(msg_type)
    if not issubclass(msg_type, Message):
        raise RuntimeError(f"The passed message type is invalid: {msg_type.__name__}")


def check_is_valid_srv_type(srv_type: Any) -> None:
    """Nothing for a service class. Raises as `check_is_valid_msg_type`."""
    check_for_type_support(srv_type)
    if not issubclass(srv_type, Service):
        raise RuntimeError(f"The passed service type is invalid: {srv_type.__name__}")


def check_is_valid_action_type(action_type: Any) -> None:
    """Nothing for an action class. Raises as `check_is_valid_msg_type`."""
    check_for_type_support(action_type)
    if not issubclass(action_type, Action):
        raise RuntimeError(f"The passed action type is invalid: {action_type.__name__}")


__all__ = [
    "check_for_type_support",
    "check_is_valid_action_type",
    "check_is_valid_msg_type",
    "check_is_valid_srv_type",
]
