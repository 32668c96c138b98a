"""`rclpy.validate_parameter_name`."""

from __future__ import annotations

from roslet.compat.rclpy.exceptions import InvalidParameterException


def validate_parameter_name(name: str) -> bool:
    """True for a parameter's name, which is any but the empty one; raises InvalidParameterException for that."""
    if not name:
        raise InvalidParameterException(name)
    return True


__all__ = ["validate_parameter_name"]
