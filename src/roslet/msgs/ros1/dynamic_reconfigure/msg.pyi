# Generated from the definitions of dynamic_reconfigure by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message

class BoolParameter(_message.Message):
    name: str
    value: bool
    def __init__(
        self,
        name: str = ...,
        value: bool = ...,
    ) -> None: ...

class Config(_message.Message):
    bools: list[BoolParameter]
    ints: list[IntParameter]
    strs: list[StrParameter]
    doubles: list[DoubleParameter]
    groups: list[GroupState]
    def __init__(
        self,
        bools: list[BoolParameter] | None = ...,
        ints: list[IntParameter] | None = ...,
        strs: list[StrParameter] | None = ...,
        doubles: list[DoubleParameter] | None = ...,
        groups: list[GroupState] | None = ...,
    ) -> None: ...

class ConfigDescription(_message.Message):
    groups: list[Group]
    max: Config
    min: Config
    dflt: Config
    def __init__(
        self,
        groups: list[Group] | None = ...,
        max: Config | None = ...,
        min: Config | None = ...,
        dflt: Config | None = ...,
    ) -> None: ...

class DoubleParameter(_message.Message):
    name: str
    value: float
    def __init__(
        self,
        name: str = ...,
        value: float = ...,
    ) -> None: ...

class Group(_message.Message):
    name: str
    type: str
    parameters: list[ParamDescription]
    parent: int
    id: int
    def __init__(
        self,
        name: str = ...,
        type: str = ...,
        parameters: list[ParamDescription] | None = ...,
        parent: int = ...,
        id: int = ...,
    ) -> None: ...

class GroupState(_message.Message):
    name: str
    state: bool
    id: int
    parent: int
    def __init__(
        self,
        name: str = ...,
        state: bool = ...,
        id: int = ...,
        parent: int = ...,
    ) -> None: ...

class IntParameter(_message.Message):
    name: str
    value: int
    def __init__(
        self,
        name: str = ...,
        value: int = ...,
    ) -> None: ...

class ParamDescription(_message.Message):
    name: str
    type: str
    level: int
    description: str
    edit_method: str
    def __init__(
        self,
        name: str = ...,
        type: str = ...,
        level: int = ...,
        description: str = ...,
        edit_method: str = ...,
    ) -> None: ...

class SensorLevels(_message.Message):
    RECONFIGURE_CLOSE: _typing.ClassVar[int]
    RECONFIGURE_STOP: _typing.ClassVar[int]
    RECONFIGURE_RUNNING: _typing.ClassVar[int]
    def __init__(self) -> None: ...

class StrParameter(_message.Message):
    name: str
    value: str
    def __init__(
        self,
        name: str = ...,
        value: str = ...,
    ) -> None: ...
