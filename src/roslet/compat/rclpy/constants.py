"""`rclpy.constants`."""

S_TO_NS = 1_000_000_000
"""Nanoseconds of a second."""

__all__ = ["S_TO_NS"]
