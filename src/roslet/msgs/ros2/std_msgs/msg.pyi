# Generated from the definitions of std_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing
from collections import abc as _abc

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg

class Bool(_message.Message):
    data: bool
    def __init__(
        self,
        data: bool = ...,
    ) -> None: ...

class Byte(_message.Message):
    data: int
    def __init__(
        self,
        data: int = ...,
    ) -> None: ...

class ByteMultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _message.Bytes
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _message.Bytes | _abc.Sequence[int] = ...,
    ) -> None: ...

class Char(_message.Message):
    data: int
    def __init__(
        self,
        data: int = ...,
    ) -> None: ...

class ColorRGBA(_message.Message):
    r: float
    g: float
    b: float
    a: float
    def __init__(
        self,
        r: float = ...,
        g: float = ...,
        b: float = ...,
        a: float = ...,
    ) -> None: ...

class Empty(_message.Message):
    def __init__(self) -> None: ...

class Float32(_message.Message):
    data: float
    def __init__(
        self,
        data: float = ...,
    ) -> None: ...

class Float32MultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _typing.Any
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class Float64(_message.Message):
    data: float
    def __init__(
        self,
        data: float = ...,
    ) -> None: ...

class Float64MultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _typing.Any
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class Header(_message.Message):
    stamp: _builtin_interfaces_msg.Time | _time.Time
    frame_id: str
    def __init__(
        self,
        stamp: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        frame_id: str = ...,
    ) -> None: ...

class Int16(_message.Message):
    data: int
    def __init__(
        self,
        data: int = ...,
    ) -> None: ...

class Int16MultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _typing.Any
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class Int32(_message.Message):
    data: int
    def __init__(
        self,
        data: int = ...,
    ) -> None: ...

class Int32MultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _typing.Any
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class Int64(_message.Message):
    data: int
    def __init__(
        self,
        data: int = ...,
    ) -> None: ...

class Int64MultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _typing.Any
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class Int8(_message.Message):
    data: int
    def __init__(
        self,
        data: int = ...,
    ) -> None: ...

class Int8MultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _typing.Any
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class MultiArrayDimension(_message.Message):
    label: str
    size: int
    stride: int
    def __init__(
        self,
        label: str = ...,
        size: int = ...,
        stride: int = ...,
    ) -> None: ...

class MultiArrayLayout(_message.Message):
    dim: list[MultiArrayDimension]
    data_offset: int
    def __init__(
        self,
        dim: list[MultiArrayDimension] | None = ...,
        data_offset: int = ...,
    ) -> None: ...

class String(_message.Message):
    data: str
    def __init__(
        self,
        data: str = ...,
    ) -> None: ...

class UInt16(_message.Message):
    data: int
    def __init__(
        self,
        data: int = ...,
    ) -> None: ...

class UInt16MultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _typing.Any
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class UInt32(_message.Message):
    data: int
    def __init__(
        self,
        data: int = ...,
    ) -> None: ...

class UInt32MultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _typing.Any
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class UInt64(_message.Message):
    data: int
    def __init__(
        self,
        data: int = ...,
    ) -> None: ...

class UInt64MultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _typing.Any
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class UInt8(_message.Message):
    data: int
    def __init__(
        self,
        data: int = ...,
    ) -> None: ...

class UInt8MultiArray(_message.Message):
    layout: MultiArrayLayout
    data: _message.Bytes
    def __init__(
        self,
        layout: MultiArrayLayout | None = ...,
        data: _message.Bytes | _abc.Sequence[int] = ...,
    ) -> None: ...
