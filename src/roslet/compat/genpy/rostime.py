"""`genpy.rostime`."""

from roslet.compat.genpy import Duration, Time, TVal

__all__ = ["Duration", "TVal", "Time"]
