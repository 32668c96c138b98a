# Generated from the definitions of rosgraph_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros1.std_msgs import msg as _std_msgs_msg

class Clock(_message.Message):
    clock: _time.Time
    def __init__(
        self,
        clock: _time.Time | None = ...,
    ) -> None: ...

class Log(_message.Message):
    DEBUG: _typing.ClassVar[int]
    INFO: _typing.ClassVar[int]
    WARN: _typing.ClassVar[int]
    ERROR: _typing.ClassVar[int]
    FATAL: _typing.ClassVar[int]
    header: _std_msgs_msg.Header
    level: int
    name: str
    msg: str
    file: str
    function: str
    line: int
    topics: list[str]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        level: int = ...,
        name: str = ...,
        msg: str = ...,
        file: str = ...,
        function: str = ...,
        line: int = ...,
        topics: list[str] | None = ...,
    ) -> None: ...

class TopicStatistics(_message.Message):
    topic: str
    node_pub: str
    node_sub: str
    window_start: _time.Time
    window_stop: _time.Time
    delivered_msgs: int
    dropped_msgs: int
    traffic: int
    period_mean: _time.Duration
    period_stddev: _time.Duration
    period_max: _time.Duration
    stamp_age_mean: _time.Duration
    stamp_age_stddev: _time.Duration
    stamp_age_max: _time.Duration
    def __init__(
        self,
        topic: str = ...,
        node_pub: str = ...,
        node_sub: str = ...,
        window_start: _time.Time | None = ...,
        window_stop: _time.Time | None = ...,
        delivered_msgs: int = ...,
        dropped_msgs: int = ...,
        traffic: int = ...,
        period_mean: _time.Duration | None = ...,
        period_stddev: _time.Duration | None = ...,
        period_max: _time.Duration | None = ...,
        stamp_age_mean: _time.Duration | None = ...,
        stamp_age_stddev: _time.Duration | None = ...,
        stamp_age_max: _time.Duration | None = ...,
    ) -> None: ...
