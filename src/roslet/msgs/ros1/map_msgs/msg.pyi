# Generated from the definitions of map_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros1.nav_msgs import msg as _nav_msgs_msg
from roslet.msgs.ros1.sensor_msgs import msg as _sensor_msgs_msg
from roslet.msgs.ros1.std_msgs import msg as _std_msgs_msg

class OccupancyGridUpdate(_message.Message):
    header: _std_msgs_msg.Header
    x: int
    y: int
    width: int
    height: int
    data: _typing.Any
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        x: int = ...,
        y: int = ...,
        width: int = ...,
        height: int = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class PointCloud2Update(_message.Message):
    ADD: _typing.ClassVar[int]
    DELETE: _typing.ClassVar[int]
    header: _std_msgs_msg.Header
    type: int
    points: _sensor_msgs_msg.PointCloud2
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        type: int = ...,
        points: _sensor_msgs_msg.PointCloud2 | None = ...,
    ) -> None: ...

class ProjectedMap(_message.Message):
    map: _nav_msgs_msg.OccupancyGrid
    min_z: float
    max_z: float
    def __init__(
        self,
        map: _nav_msgs_msg.OccupancyGrid | None = ...,
        min_z: float = ...,
        max_z: float = ...,
    ) -> None: ...

class ProjectedMapInfo(_message.Message):
    frame_id: str
    x: float
    y: float
    width: float
    height: float
    min_z: float
    max_z: float
    def __init__(
        self,
        frame_id: str = ...,
        x: float = ...,
        y: float = ...,
        width: float = ...,
        height: float = ...,
        min_z: float = ...,
        max_z: float = ...,
    ) -> None: ...
