# Generated from the definitions of nav_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros1.geometry_msgs import msg as _geometry_msgs_msg
from roslet.msgs.ros1.nav_msgs import msg as _nav_msgs_msg

class GetMapRequest(_message.Message):
    def __init__(self) -> None: ...

class GetMapResponse(_message.Message):
    map: _nav_msgs_msg.OccupancyGrid
    def __init__(
        self,
        map: _nav_msgs_msg.OccupancyGrid | None = ...,
    ) -> None: ...

class GetPlanRequest(_message.Message):
    start: _geometry_msgs_msg.PoseStamped
    goal: _geometry_msgs_msg.PoseStamped
    tolerance: float
    def __init__(
        self,
        start: _geometry_msgs_msg.PoseStamped | None = ...,
        goal: _geometry_msgs_msg.PoseStamped | None = ...,
        tolerance: float = ...,
    ) -> None: ...

class GetPlanResponse(_message.Message):
    plan: _nav_msgs_msg.Path
    def __init__(
        self,
        plan: _nav_msgs_msg.Path | None = ...,
    ) -> None: ...

class LoadMapRequest(_message.Message):
    map_url: str
    def __init__(
        self,
        map_url: str = ...,
    ) -> None: ...

class LoadMapResponse(_message.Message):
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

class SetMapRequest(_message.Message):
    map: _nav_msgs_msg.OccupancyGrid
    initial_pose: _geometry_msgs_msg.PoseWithCovarianceStamped
    def __init__(
        self,
        map: _nav_msgs_msg.OccupancyGrid | None = ...,
        initial_pose: _geometry_msgs_msg.PoseWithCovarianceStamped | None = ...,
    ) -> None: ...

class SetMapResponse(_message.Message):
    success: bool
    def __init__(
        self,
        success: bool = ...,
    ) -> None: ...

class GetMap(_message.Service):
    Request = GetMapRequest
    Response = GetMapResponse

class GetPlan(_message.Service):
    Request = GetPlanRequest
    Response = GetPlanResponse

class LoadMap(_message.Service):
    Request = LoadMapRequest
    Response = LoadMapResponse

class SetMap(_message.Service):
    Request = SetMapRequest
    Response = SetMapResponse
