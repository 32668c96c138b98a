# Generated from the definitions of shape_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros2.geometry_msgs import msg as _geometry_msgs_msg

class Mesh(_message.Message):
    triangles: list[MeshTriangle]
    vertices: list[_geometry_msgs_msg.Point]
    def __init__(
        self,
        triangles: list[MeshTriangle] | None = ...,
        vertices: list[_geometry_msgs_msg.Point] | None = ...,
    ) -> None: ...

class MeshTriangle(_message.Message):
    vertex_indices: _typing.Any
    def __init__(
        self,
        vertex_indices: _typing.Any = ...,
    ) -> None: ...

class Plane(_message.Message):
    coef: _typing.Any
    def __init__(
        self,
        coef: _typing.Any = ...,
    ) -> None: ...

class SolidPrimitive(_message.Message):
    BOX: _typing.ClassVar[int]
    SPHERE: _typing.ClassVar[int]
    CYLINDER: _typing.ClassVar[int]
    CONE: _typing.ClassVar[int]
    PRISM: _typing.ClassVar[int]
    BOX_X: _typing.ClassVar[int]
    BOX_Y: _typing.ClassVar[int]
    BOX_Z: _typing.ClassVar[int]
    SPHERE_RADIUS: _typing.ClassVar[int]
    CYLINDER_HEIGHT: _typing.ClassVar[int]
    CYLINDER_RADIUS: _typing.ClassVar[int]
    CONE_HEIGHT: _typing.ClassVar[int]
    CONE_RADIUS: _typing.ClassVar[int]
    PRISM_HEIGHT: _typing.ClassVar[int]
    type: int
    dimensions: _typing.Any
    polygon: _geometry_msgs_msg.Polygon
    def __init__(
        self,
        type: int = ...,
        dimensions: _typing.Any = ...,
        polygon: _geometry_msgs_msg.Polygon | None = ...,
    ) -> None: ...
