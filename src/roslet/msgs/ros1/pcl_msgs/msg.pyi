# Generated from the definitions of pcl_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros1.sensor_msgs import msg as _sensor_msgs_msg
from roslet.msgs.ros1.std_msgs import msg as _std_msgs_msg

class ModelCoefficients(_message.Message):
    header: _std_msgs_msg.Header
    values: _typing.Any
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        values: _typing.Any = ...,
    ) -> None: ...

class PointIndices(_message.Message):
    header: _std_msgs_msg.Header
    indices: _typing.Any
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        indices: _typing.Any = ...,
    ) -> None: ...

class PolygonMesh(_message.Message):
    header: _std_msgs_msg.Header
    cloud: _sensor_msgs_msg.PointCloud2
    polygons: list[Vertices]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        cloud: _sensor_msgs_msg.PointCloud2 | None = ...,
        polygons: list[Vertices] | None = ...,
    ) -> None: ...

class Vertices(_message.Message):
    vertices: _typing.Any
    def __init__(
        self,
        vertices: _typing.Any = ...,
    ) -> None: ...
