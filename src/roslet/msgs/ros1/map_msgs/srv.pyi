# Generated from the definitions of map_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.map_msgs import msg as _map_msgs_msg
from roslet.msgs.ros1.nav_msgs import msg as _nav_msgs_msg
from roslet.msgs.ros1.sensor_msgs import msg as _sensor_msgs_msg
from roslet.msgs.ros1.std_msgs import msg as _std_msgs_msg

class GetMapROIRequest(_message.Message):
    x: float
    y: float
    l_x: float
    l_y: float
    def __init__(
        self,
        x: float = ...,
        y: float = ...,
        l_x: float = ...,
        l_y: float = ...,
    ) -> None: ...

class GetMapROIResponse(_message.Message):
    sub_map: _nav_msgs_msg.OccupancyGrid
    def __init__(
        self,
        sub_map: _nav_msgs_msg.OccupancyGrid | None = ...,
    ) -> None: ...

class GetPointMapROIRequest(_message.Message):
    x: float
    y: float
    z: float
    r: float
    l_x: float
    l_y: float
    l_z: float
    def __init__(
        self,
        x: float = ...,
        y: float = ...,
        z: float = ...,
        r: float = ...,
        l_x: float = ...,
        l_y: float = ...,
        l_z: float = ...,
    ) -> None: ...

class GetPointMapROIResponse(_message.Message):
    sub_map: _sensor_msgs_msg.PointCloud2
    def __init__(
        self,
        sub_map: _sensor_msgs_msg.PointCloud2 | None = ...,
    ) -> None: ...

class GetPointMapRequest(_message.Message):
    def __init__(self) -> None: ...

class GetPointMapResponse(_message.Message):
    map: _sensor_msgs_msg.PointCloud2
    def __init__(
        self,
        map: _sensor_msgs_msg.PointCloud2 | None = ...,
    ) -> None: ...

class ProjectedMapsInfoRequest(_message.Message):
    projected_maps_info: list[_map_msgs_msg.ProjectedMapInfo]
    def __init__(
        self,
        projected_maps_info: list[_map_msgs_msg.ProjectedMapInfo] | None = ...,
    ) -> None: ...

class ProjectedMapsInfoResponse(_message.Message):
    def __init__(self) -> None: ...

class SaveMapRequest(_message.Message):
    filename: _std_msgs_msg.String
    def __init__(
        self,
        filename: _std_msgs_msg.String | None = ...,
    ) -> None: ...

class SaveMapResponse(_message.Message):
    def __init__(self) -> None: ...

class SetMapProjectionsRequest(_message.Message):
    def __init__(self) -> None: ...

class SetMapProjectionsResponse(_message.Message):
    projected_maps_info: list[_map_msgs_msg.ProjectedMapInfo]
    def __init__(
        self,
        projected_maps_info: list[_map_msgs_msg.ProjectedMapInfo] | None = ...,
    ) -> None: ...

class GetMapROI(_message.Service):
    Request = GetMapROIRequest
    Response = GetMapROIResponse

class GetPointMap(_message.Service):
    Request = GetPointMapRequest
    Response = GetPointMapResponse

class GetPointMapROI(_message.Service):
    Request = GetPointMapROIRequest
    Response = GetPointMapROIResponse

class ProjectedMapsInfo(_message.Service):
    Request = ProjectedMapsInfoRequest
    Response = ProjectedMapsInfoResponse

class SaveMap(_message.Service):
    Request = SaveMapRequest
    Response = SaveMapResponse

class SetMapProjections(_message.Service):
    Request = SetMapProjectionsRequest
    Response = SetMapProjectionsResponse
