# Generated from the definitions of visualization_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing
from collections import abc as _abc

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg
from roslet.msgs.ros2.geometry_msgs import msg as _geometry_msgs_msg
from roslet.msgs.ros2.sensor_msgs import msg as _sensor_msgs_msg
from roslet.msgs.ros2.std_msgs import msg as _std_msgs_msg

class ImageMarker(_message.Message):
    CIRCLE: _typing.ClassVar[int]
    LINE_STRIP: _typing.ClassVar[int]
    LINE_LIST: _typing.ClassVar[int]
    POLYGON: _typing.ClassVar[int]
    POINTS: _typing.ClassVar[int]
    ADD: _typing.ClassVar[int]
    REMOVE: _typing.ClassVar[int]
    header: _std_msgs_msg.Header
    ns: str
    id: int
    type: int
    action: int
    position: _geometry_msgs_msg.Point
    scale: float
    outline_color: _std_msgs_msg.ColorRGBA
    filled: int
    fill_color: _std_msgs_msg.ColorRGBA
    lifetime: _builtin_interfaces_msg.Duration | _time.Duration
    points: list[_geometry_msgs_msg.Point]
    outline_colors: list[_std_msgs_msg.ColorRGBA]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        ns: str = ...,
        id: int = ...,
        type: int = ...,
        action: int = ...,
        position: _geometry_msgs_msg.Point | None = ...,
        scale: float = ...,
        outline_color: _std_msgs_msg.ColorRGBA | None = ...,
        filled: int = ...,
        fill_color: _std_msgs_msg.ColorRGBA | None = ...,
        lifetime: _builtin_interfaces_msg.Duration | _time.Duration | None = ...,
        points: list[_geometry_msgs_msg.Point] | None = ...,
        outline_colors: list[_std_msgs_msg.ColorRGBA] | None = ...,
    ) -> None: ...

class InteractiveMarker(_message.Message):
    header: _std_msgs_msg.Header
    pose: _geometry_msgs_msg.Pose
    name: str
    description: str
    scale: float
    menu_entries: list[MenuEntry]
    controls: list[InteractiveMarkerControl]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        pose: _geometry_msgs_msg.Pose | None = ...,
        name: str = ...,
        description: str = ...,
        scale: float = ...,
        menu_entries: list[MenuEntry] | None = ...,
        controls: list[InteractiveMarkerControl] | None = ...,
    ) -> None: ...

class InteractiveMarkerControl(_message.Message):
    INHERIT: _typing.ClassVar[int]
    FIXED: _typing.ClassVar[int]
    VIEW_FACING: _typing.ClassVar[int]
    NONE: _typing.ClassVar[int]
    MENU: _typing.ClassVar[int]
    BUTTON: _typing.ClassVar[int]
    MOVE_AXIS: _typing.ClassVar[int]
    MOVE_PLANE: _typing.ClassVar[int]
    ROTATE_AXIS: _typing.ClassVar[int]
    MOVE_ROTATE: _typing.ClassVar[int]
    MOVE_3D: _typing.ClassVar[int]
    ROTATE_3D: _typing.ClassVar[int]
    MOVE_ROTATE_3D: _typing.ClassVar[int]
    name: str
    orientation: _geometry_msgs_msg.Quaternion
    orientation_mode: int
    interaction_mode: int
    always_visible: bool
    markers: list[Marker]
    independent_marker_orientation: bool
    description: str
    def __init__(
        self,
        name: str = ...,
        orientation: _geometry_msgs_msg.Quaternion | None = ...,
        orientation_mode: int = ...,
        interaction_mode: int = ...,
        always_visible: bool = ...,
        markers: list[Marker] | None = ...,
        independent_marker_orientation: bool = ...,
        description: str = ...,
    ) -> None: ...

class InteractiveMarkerFeedback(_message.Message):
    KEEP_ALIVE: _typing.ClassVar[int]
    POSE_UPDATE: _typing.ClassVar[int]
    MENU_SELECT: _typing.ClassVar[int]
    BUTTON_CLICK: _typing.ClassVar[int]
    MOUSE_DOWN: _typing.ClassVar[int]
    MOUSE_UP: _typing.ClassVar[int]
    header: _std_msgs_msg.Header
    client_id: str
    marker_name: str
    control_name: str
    event_type: int
    pose: _geometry_msgs_msg.Pose
    menu_entry_id: int
    mouse_point: _geometry_msgs_msg.Point
    mouse_point_valid: bool
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        client_id: str = ...,
        marker_name: str = ...,
        control_name: str = ...,
        event_type: int = ...,
        pose: _geometry_msgs_msg.Pose | None = ...,
        menu_entry_id: int = ...,
        mouse_point: _geometry_msgs_msg.Point | None = ...,
        mouse_point_valid: bool = ...,
    ) -> None: ...

class InteractiveMarkerInit(_message.Message):
    server_id: str
    seq_num: int
    markers: list[InteractiveMarker]
    def __init__(
        self,
        server_id: str = ...,
        seq_num: int = ...,
        markers: list[InteractiveMarker] | None = ...,
    ) -> None: ...

class InteractiveMarkerPose(_message.Message):
    header: _std_msgs_msg.Header
    pose: _geometry_msgs_msg.Pose
    name: str
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        pose: _geometry_msgs_msg.Pose | None = ...,
        name: str = ...,
    ) -> None: ...

class InteractiveMarkerUpdate(_message.Message):
    KEEP_ALIVE: _typing.ClassVar[int]
    UPDATE: _typing.ClassVar[int]
    server_id: str
    seq_num: int
    type: int
    markers: list[InteractiveMarker]
    poses: list[InteractiveMarkerPose]
    erases: list[str]
    def __init__(
        self,
        server_id: str = ...,
        seq_num: int = ...,
        type: int = ...,
        markers: list[InteractiveMarker] | None = ...,
        poses: list[InteractiveMarkerPose] | None = ...,
        erases: list[str] | None = ...,
    ) -> None: ...

class Marker(_message.Message):
    ARROW: _typing.ClassVar[int]
    CUBE: _typing.ClassVar[int]
    SPHERE: _typing.ClassVar[int]
    CYLINDER: _typing.ClassVar[int]
    LINE_STRIP: _typing.ClassVar[int]
    LINE_LIST: _typing.ClassVar[int]
    CUBE_LIST: _typing.ClassVar[int]
    SPHERE_LIST: _typing.ClassVar[int]
    POINTS: _typing.ClassVar[int]
    TEXT_VIEW_FACING: _typing.ClassVar[int]
    MESH_RESOURCE: _typing.ClassVar[int]
    TRIANGLE_LIST: _typing.ClassVar[int]
    ARROW_STRIP: _typing.ClassVar[int]
    ADD: _typing.ClassVar[int]
    MODIFY: _typing.ClassVar[int]
    DELETE: _typing.ClassVar[int]
    DELETEALL: _typing.ClassVar[int]
    header: _std_msgs_msg.Header
    ns: str
    id: int
    type: int
    action: int
    pose: _geometry_msgs_msg.Pose
    scale: _geometry_msgs_msg.Vector3
    color: _std_msgs_msg.ColorRGBA
    lifetime: _builtin_interfaces_msg.Duration | _time.Duration
    frame_locked: bool
    points: list[_geometry_msgs_msg.Point]
    colors: list[_std_msgs_msg.ColorRGBA]
    texture_resource: str
    texture: _sensor_msgs_msg.CompressedImage
    uv_coordinates: list[UVCoordinate]
    text: str
    mesh_resource: str
    mesh_file: MeshFile
    mesh_use_embedded_materials: bool
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        ns: str = ...,
        id: int = ...,
        type: int = ...,
        action: int = ...,
        pose: _geometry_msgs_msg.Pose | None = ...,
        scale: _geometry_msgs_msg.Vector3 | None = ...,
        color: _std_msgs_msg.ColorRGBA | None = ...,
        lifetime: _builtin_interfaces_msg.Duration | _time.Duration | None = ...,
        frame_locked: bool = ...,
        points: list[_geometry_msgs_msg.Point] | None = ...,
        colors: list[_std_msgs_msg.ColorRGBA] | None = ...,
        texture_resource: str = ...,
        texture: _sensor_msgs_msg.CompressedImage | None = ...,
        uv_coordinates: list[UVCoordinate] | None = ...,
        text: str = ...,
        mesh_resource: str = ...,
        mesh_file: MeshFile | None = ...,
        mesh_use_embedded_materials: bool = ...,
    ) -> None: ...

class MarkerArray(_message.Message):
    markers: list[Marker]
    def __init__(
        self,
        markers: list[Marker] | None = ...,
    ) -> None: ...

class MenuEntry(_message.Message):
    FEEDBACK: _typing.ClassVar[int]
    ROSRUN: _typing.ClassVar[int]
    ROSLAUNCH: _typing.ClassVar[int]
    id: int
    parent_id: int
    title: str
    command: str
    command_type: int
    def __init__(
        self,
        id: int = ...,
        parent_id: int = ...,
        title: str = ...,
        command: str = ...,
        command_type: int = ...,
    ) -> None: ...

class MeshFile(_message.Message):
    filename: str
    data: _message.Bytes
    def __init__(
        self,
        filename: str = ...,
        data: _message.Bytes | _abc.Sequence[int] = ...,
    ) -> None: ...

class UVCoordinate(_message.Message):
    u: float
    v: float
    def __init__(
        self,
        u: float = ...,
        v: float = ...,
    ) -> None: ...
