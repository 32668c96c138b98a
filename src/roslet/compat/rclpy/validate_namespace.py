"""`rclpy.validate_namespace`."""

from __future__ import annotations

from roslet.compat.rclpy._names import namespace_fault
from roslet.compat.rclpy.exceptions import InvalidNamespaceException


def validate_namespace(namespace: str) -> bool:
    """True for a namespace; raises InvalidNamespaceException for anything else."""
    fault = namespace_fault(namespace)
    if fault is not None:
        raise InvalidNamespaceException(namespace, *fault)
    return True


__all__ = ["validate_namespace"]
