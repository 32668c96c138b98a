"""`rclpy.serialization`: messages as the bytes of CDR."""

from __future__ import annotations

from typing import Any

from roslet.compat.rclpy.exceptions import RMWError
from roslet.compat.rclpy.type_support import check_for_type_support
from roslet.errors import MalformedMessage


def serialize_message(message: Any) -> bytes:
    """A message's bytes, with the encapsulation header. Raises AttributeError for what is no message, InvalidMessage for
    a value that its field cannot hold."""
    check_for_type_support(type(message))
    data: bytes = message.serialize()
    return data


def deserialize_message(serialized_message: bytes, message_type: Any) -> Any:
    """The message of a class that bytes are. Raises RMWError where they are none, TypeError where they are no bytes."""
    check_for_type_support(message_type)
    if not isinstance(serialized_message, (bytes, bytearray, memoryview)):
        raise TypeError(f"expected bytes, not {type(serialized_message).__name__}")
    try:
        return message_type.deserialize(serialized_message)
    except MalformedMessage as error:
        raise RMWError(f"failed to deserialize ROS message: {error}") from None


__all__ = ["deserialize_message", "serialize_message"]
