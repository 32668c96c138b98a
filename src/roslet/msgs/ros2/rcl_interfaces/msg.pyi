# Generated from the definitions of rcl_interfaces by roslet.gen.stubs. Do not edit.

import typing as _typing
from collections import abc as _abc

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg

class FloatingPointRange(_message.Message):
    from_value: float
    to_value: float
    step: float
    def __init__(
        self,
        from_value: float = ...,
        to_value: float = ...,
        step: float = ...,
    ) -> None: ...

class IntegerRange(_message.Message):
    from_value: int
    to_value: int
    step: int
    def __init__(
        self,
        from_value: int = ...,
        to_value: int = ...,
        step: int = ...,
    ) -> None: ...

class ListParametersResult(_message.Message):
    names: list[str]
    prefixes: list[str]
    def __init__(
        self,
        names: list[str] | None = ...,
        prefixes: list[str] | None = ...,
    ) -> None: ...

class Log(_message.Message):
    DEBUG: _typing.ClassVar[int]
    INFO: _typing.ClassVar[int]
    WARN: _typing.ClassVar[int]
    ERROR: _typing.ClassVar[int]
    FATAL: _typing.ClassVar[int]
    stamp: _builtin_interfaces_msg.Time | _time.Time
    level: int
    name: str
    msg: str
    file: str
    function: str
    line: int
    def __init__(
        self,
        stamp: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        level: int = ...,
        name: str = ...,
        msg: str = ...,
        file: str = ...,
        function: str = ...,
        line: int = ...,
    ) -> None: ...

class LoggerLevel(_message.Message):
    LOG_LEVEL_UNKNOWN: _typing.ClassVar[int]
    LOG_LEVEL_DEBUG: _typing.ClassVar[int]
    LOG_LEVEL_INFO: _typing.ClassVar[int]
    LOG_LEVEL_WARN: _typing.ClassVar[int]
    LOG_LEVEL_ERROR: _typing.ClassVar[int]
    LOG_LEVEL_FATAL: _typing.ClassVar[int]
    name: str
    level: int
    def __init__(
        self,
        name: str = ...,
        level: int = ...,
    ) -> None: ...

class Parameter(_message.Message):
    name: str
    value: ParameterValue
    def __init__(
        self,
        name: str = ...,
        value: ParameterValue | None = ...,
    ) -> None: ...

class ParameterDescriptor(_message.Message):
    name: str
    type: int
    description: str
    additional_constraints: str
    read_only: bool
    dynamic_typing: bool
    floating_point_range: list[FloatingPointRange]
    integer_range: list[IntegerRange]
    def __init__(
        self,
        name: str = ...,
        type: int = ...,
        description: str = ...,
        additional_constraints: str = ...,
        read_only: bool = ...,
        dynamic_typing: bool = ...,
        floating_point_range: list[FloatingPointRange] | None = ...,
        integer_range: list[IntegerRange] | None = ...,
    ) -> None: ...

class ParameterEvent(_message.Message):
    stamp: _builtin_interfaces_msg.Time | _time.Time
    node: str
    new_parameters: list[Parameter]
    changed_parameters: list[Parameter]
    deleted_parameters: list[Parameter]
    def __init__(
        self,
        stamp: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        node: str = ...,
        new_parameters: list[Parameter] | None = ...,
        changed_parameters: list[Parameter] | None = ...,
        deleted_parameters: list[Parameter] | None = ...,
    ) -> None: ...

class ParameterEventDescriptors(_message.Message):
    new_parameters: list[ParameterDescriptor]
    changed_parameters: list[ParameterDescriptor]
    deleted_parameters: list[ParameterDescriptor]
    def __init__(
        self,
        new_parameters: list[ParameterDescriptor] | None = ...,
        changed_parameters: list[ParameterDescriptor] | None = ...,
        deleted_parameters: list[ParameterDescriptor] | None = ...,
    ) -> None: ...

class ParameterType(_message.Message):
    PARAMETER_NOT_SET: _typing.ClassVar[int]
    PARAMETER_BOOL: _typing.ClassVar[int]
    PARAMETER_INTEGER: _typing.ClassVar[int]
    PARAMETER_DOUBLE: _typing.ClassVar[int]
    PARAMETER_STRING: _typing.ClassVar[int]
    PARAMETER_BYTE_ARRAY: _typing.ClassVar[int]
    PARAMETER_BOOL_ARRAY: _typing.ClassVar[int]
    PARAMETER_INTEGER_ARRAY: _typing.ClassVar[int]
    PARAMETER_DOUBLE_ARRAY: _typing.ClassVar[int]
    PARAMETER_STRING_ARRAY: _typing.ClassVar[int]
    def __init__(self) -> None: ...

class ParameterValue(_message.Message):
    type: int
    bool_value: bool
    integer_value: int
    double_value: float
    string_value: str
    byte_array_value: _message.Bytes
    bool_array_value: _typing.Any
    integer_array_value: _typing.Any
    double_array_value: _typing.Any
    string_array_value: list[str]
    def __init__(
        self,
        type: int = ...,
        bool_value: bool = ...,
        integer_value: int = ...,
        double_value: float = ...,
        string_value: str = ...,
        byte_array_value: _message.Bytes | _abc.Sequence[int] = ...,
        bool_array_value: _typing.Any = ...,
        integer_array_value: _typing.Any = ...,
        double_array_value: _typing.Any = ...,
        string_array_value: list[str] | None = ...,
    ) -> None: ...

class SetLoggerLevelsResult(_message.Message):
    successful: bool
    reason: str
    def __init__(
        self,
        successful: bool = ...,
        reason: str = ...,
    ) -> None: ...

class SetParametersResult(_message.Message):
    successful: bool
    reason: str
    def __init__(
        self,
        successful: bool = ...,
        reason: str = ...,
    ) -> None: ...
