# Generated from the definitions of service_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing
from collections import abc as _abc

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg

class ServiceEventInfo(_message.Message):
    REQUEST_SENT: _typing.ClassVar[int]
    REQUEST_RECEIVED: _typing.ClassVar[int]
    RESPONSE_SENT: _typing.ClassVar[int]
    RESPONSE_RECEIVED: _typing.ClassVar[int]
    event_type: int
    stamp: _builtin_interfaces_msg.Time | _time.Time
    client_gid: _message.Bytes
    sequence_number: int
    def __init__(
        self,
        event_type: int = ...,
        stamp: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        client_gid: _message.Bytes | _abc.Sequence[int] = ...,
        sequence_number: int = ...,
    ) -> None: ...
