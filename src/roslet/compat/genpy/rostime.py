"""`genpy.rostime`."""

from roslet.wire.time import Duration, Time

TVal = (Time, Duration)

__all__ = ["Duration", "TVal", "Time"]
