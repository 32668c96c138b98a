# Generated from the definitions of diagnostic_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros2.std_msgs import msg as _std_msgs_msg

class DiagnosticArray(_message.Message):
    header: _std_msgs_msg.Header
    status: list[DiagnosticStatus]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: list[DiagnosticStatus] | None = ...,
    ) -> None: ...

class DiagnosticStatus(_message.Message):
    OK: _typing.ClassVar[int]
    WARN: _typing.ClassVar[int]
    ERROR: _typing.ClassVar[int]
    STALE: _typing.ClassVar[int]
    level: int
    name: str
    message: str
    hardware_id: str
    values: list[KeyValue]
    def __init__(
        self,
        level: int = ...,
        name: str = ...,
        message: str = ...,
        hardware_id: str = ...,
        values: list[KeyValue] | None = ...,
    ) -> None: ...

class KeyValue(_message.Message):
    key: str
    value: str
    def __init__(
        self,
        key: str = ...,
        value: str = ...,
    ) -> None: ...
