# Generated from the definitions of rospy_tutorials by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros1.std_msgs import msg as _std_msgs_msg

class Floats(_message.Message):
    data: _typing.Any
    def __init__(
        self,
        data: _typing.Any = ...,
    ) -> None: ...

class HeaderString(_message.Message):
    header: _std_msgs_msg.Header
    data: str
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        data: str = ...,
    ) -> None: ...
