# Generated from the definitions of tf2_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros2.geometry_msgs import msg as _geometry_msgs_msg

class TF2Error(_message.Message):
    NO_ERROR: _typing.ClassVar[int]
    LOOKUP_ERROR: _typing.ClassVar[int]
    CONNECTIVITY_ERROR: _typing.ClassVar[int]
    EXTRAPOLATION_ERROR: _typing.ClassVar[int]
    INVALID_ARGUMENT_ERROR: _typing.ClassVar[int]
    TIMEOUT_ERROR: _typing.ClassVar[int]
    TRANSFORM_ERROR: _typing.ClassVar[int]
    error: int
    error_string: str
    def __init__(
        self,
        error: int = ...,
        error_string: str = ...,
    ) -> None: ...

class TFMessage(_message.Message):
    transforms: list[_geometry_msgs_msg.TransformStamped]
    def __init__(
        self,
        transforms: list[_geometry_msgs_msg.TransformStamped] | None = ...,
    ) -> None: ...
