# Generated from the definitions of nav_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros2.geometry_msgs import msg as _geometry_msgs_msg
from roslet.msgs.ros2.nav_msgs import msg as _nav_msgs_msg
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg

class GetMap_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[GetMap_Request]
    response: list[GetMap_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[GetMap_Request] | None = ...,
        response: list[GetMap_Response] | None = ...,
    ) -> None: ...

class GetMap_Request(_message.Message):
    def __init__(self) -> None: ...

class GetMap_Response(_message.Message):
    map: _nav_msgs_msg.OccupancyGrid
    def __init__(
        self,
        map: _nav_msgs_msg.OccupancyGrid | None = ...,
    ) -> None: ...

class GetPlan_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[GetPlan_Request]
    response: list[GetPlan_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[GetPlan_Request] | None = ...,
        response: list[GetPlan_Response] | None = ...,
    ) -> None: ...

class GetPlan_Request(_message.Message):
    start: _geometry_msgs_msg.PoseStamped
    goal: _geometry_msgs_msg.PoseStamped
    tolerance: float
    def __init__(
        self,
        start: _geometry_msgs_msg.PoseStamped | None = ...,
        goal: _geometry_msgs_msg.PoseStamped | None = ...,
        tolerance: float = ...,
    ) -> None: ...

class GetPlan_Response(_message.Message):
    plan: _nav_msgs_msg.Path
    def __init__(
        self,
        plan: _nav_msgs_msg.Path | None = ...,
    ) -> None: ...

class LoadMap_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[LoadMap_Request]
    response: list[LoadMap_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[LoadMap_Request] | None = ...,
        response: list[LoadMap_Response] | None = ...,
    ) -> None: ...

class LoadMap_Request(_message.Message):
    map_url: str
    def __init__(
        self,
        map_url: str = ...,
    ) -> None: ...

class LoadMap_Response(_message.Message):
    RESULT_SUCCESS: _typing.ClassVar[int]
    RESULT_MAP_DOES_NOT_EXIST: _typing.ClassVar[int]
    RESULT_INVALID_MAP_DATA: _typing.ClassVar[int]
    RESULT_INVALID_MAP_METADATA: _typing.ClassVar[int]
    RESULT_UNDEFINED_FAILURE: _typing.ClassVar[int]
    map: _nav_msgs_msg.OccupancyGrid
    result: int
    def __init__(
        self,
        map: _nav_msgs_msg.OccupancyGrid | None = ...,
        result: int = ...,
    ) -> None: ...

class SetMap_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[SetMap_Request]
    response: list[SetMap_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[SetMap_Request] | None = ...,
        response: list[SetMap_Response] | None = ...,
    ) -> None: ...

class SetMap_Request(_message.Message):
    map: _nav_msgs_msg.OccupancyGrid
    initial_pose: _geometry_msgs_msg.PoseWithCovarianceStamped
    def __init__(
        self,
        map: _nav_msgs_msg.OccupancyGrid | None = ...,
        initial_pose: _geometry_msgs_msg.PoseWithCovarianceStamped | None = ...,
    ) -> None: ...

class SetMap_Response(_message.Message):
    success: bool
    def __init__(
        self,
        success: bool = ...,
    ) -> None: ...

class GetMap(_message.Service):
    Request = GetMap_Request
    Response = GetMap_Response
    Event = GetMap_Event

class GetPlan(_message.Service):
    Request = GetPlan_Request
    Response = GetPlan_Response
    Event = GetPlan_Event

class LoadMap(_message.Service):
    Request = LoadMap_Request
    Response = LoadMap_Response
    Event = LoadMap_Event

class SetMap(_message.Service):
    Request = SetMap_Request
    Response = SetMap_Response
    Event = SetMap_Event
