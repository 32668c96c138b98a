# Generated from the definitions of nav_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg
from roslet.msgs.ros2.geometry_msgs import msg as _geometry_msgs_msg
from roslet.msgs.ros2.std_msgs import msg as _std_msgs_msg

class Goals(_message.Message):
    header: _std_msgs_msg.Header
    goals: list[_geometry_msgs_msg.PoseStamped]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        goals: list[_geometry_msgs_msg.PoseStamped] | None = ...,
    ) -> None: ...

class GridCells(_message.Message):
    header: _std_msgs_msg.Header
    cell_width: float
    cell_height: float
    cells: list[_geometry_msgs_msg.Point]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        cell_width: float = ...,
        cell_height: float = ...,
        cells: list[_geometry_msgs_msg.Point] | None = ...,
    ) -> None: ...

class MapMetaData(_message.Message):
    map_load_time: _builtin_interfaces_msg.Time | _time.Time
    resolution: float
    width: int
    height: int
    origin: _geometry_msgs_msg.Pose
    def __init__(
        self,
        map_load_time: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        resolution: float = ...,
        width: int = ...,
        height: int = ...,
        origin: _geometry_msgs_msg.Pose | None = ...,
    ) -> None: ...

class OccupancyGrid(_message.Message):
    header: _std_msgs_msg.Header
    info: MapMetaData
    data: _typing.Any
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        info: MapMetaData | None = ...,
        data: _typing.Any = ...,
    ) -> None: ...

class Odometry(_message.Message):
    header: _std_msgs_msg.Header
    child_frame_id: str
    pose: _geometry_msgs_msg.PoseWithCovariance
    twist: _geometry_msgs_msg.TwistWithCovariance
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        child_frame_id: str = ...,
        pose: _geometry_msgs_msg.PoseWithCovariance | None = ...,
        twist: _geometry_msgs_msg.TwistWithCovariance | None = ...,
    ) -> None: ...

class Path(_message.Message):
    header: _std_msgs_msg.Header
    poses: list[_geometry_msgs_msg.PoseStamped]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        poses: list[_geometry_msgs_msg.PoseStamped] | None = ...,
    ) -> None: ...
