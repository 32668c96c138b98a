"""What a program finds as `genpy`: times, durations and the base of messages."""

from roslet.compat.genpy import message, rostime
from roslet.compat.messages import (
    DeserializationError,
    MessageException,
    SerializationError,
    dress,
)
from roslet.wire.message import Message
from roslet.wire.time import Duration, Time

TVal = rostime.TVal
dress()

__all__ = [
    "DeserializationError",
    "Duration",
    "Message",
    "MessageException",
    "SerializationError",
    "TVal",
    "Time",
    "message",
    "rostime",
]
