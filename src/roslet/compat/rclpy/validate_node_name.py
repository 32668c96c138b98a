"""`rclpy.validate_node_name`."""

from __future__ import annotations

from roslet.compat.rclpy._names import node_name_fault
from roslet.compat.rclpy.exceptions import InvalidNodeNameException


def validate_node_name(node_name: str) -> bool:
    """True for a node's own name; raises InvalidNodeNameException for anything else."""
    fault = node_name_fault(node_name)
    if fault is not None:
        raise InvalidNodeNameException(node_name, *fault)
    return True


__all__ = ["validate_node_name"]
