# Generated from the definitions of statistics_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg

class MetricsMessage(_message.Message):
    measurement_source_name: str
    metrics_source: str
    unit: str
    window_start: _builtin_interfaces_msg.Time | _time.Time
    window_stop: _builtin_interfaces_msg.Time | _time.Time
    statistics: list[StatisticDataPoint]
    def __init__(
        self,
        measurement_source_name: str = ...,
        metrics_source: str = ...,
        unit: str = ...,
        window_start: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        window_stop: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        statistics: list[StatisticDataPoint] | None = ...,
    ) -> None: ...

class StatisticDataPoint(_message.Message):
    data_type: int
    data: float
    def __init__(
        self,
        data_type: int = ...,
        data: float = ...,
    ) -> None: ...

class StatisticDataType(_message.Message):
    STATISTICS_DATA_TYPE_UNINITIALIZED: _typing.ClassVar[int]
    STATISTICS_DATA_TYPE_AVERAGE: _typing.ClassVar[int]
    STATISTICS_DATA_TYPE_MINIMUM: _typing.ClassVar[int]
    STATISTICS_DATA_TYPE_MAXIMUM: _typing.ClassVar[int]
    STATISTICS_DATA_TYPE_STDDEV: _typing.ClassVar[int]
    STATISTICS_DATA_TYPE_SAMPLE_COUNT: _typing.ClassVar[int]
    def __init__(self) -> None: ...
