# Generated from the definitions of bond by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros1.std_msgs import msg as _std_msgs_msg

class Constants(_message.Message):
    DEAD_PUBLISH_PERIOD: _typing.ClassVar[float]
    DEFAULT_CONNECT_TIMEOUT: _typing.ClassVar[float]
    DEFAULT_HEARTBEAT_TIMEOUT: _typing.ClassVar[float]
    DEFAULT_DISCONNECT_TIMEOUT: _typing.ClassVar[float]
    DEFAULT_HEARTBEAT_PERIOD: _typing.ClassVar[float]
    DISABLE_HEARTBEAT_TIMEOUT_PARAM: _typing.ClassVar[str]
    def __init__(self) -> None: ...

class Status(_message.Message):
    header: _std_msgs_msg.Header
    id: str
    instance_id: str
    active: bool
    heartbeat_timeout: float
    heartbeat_period: float
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        id: str = ...,
        instance_id: str = ...,
        active: bool = ...,
        heartbeat_timeout: float = ...,
        heartbeat_period: float = ...,
    ) -> None: ...
