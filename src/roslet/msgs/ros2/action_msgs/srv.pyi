# Generated from the definitions of action_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros2.action_msgs import msg as _action_msgs_msg
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg

class CancelGoal_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[CancelGoal_Request]
    response: list[CancelGoal_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[CancelGoal_Request] | None = ...,
        response: list[CancelGoal_Response] | None = ...,
    ) -> None: ...

class CancelGoal_Request(_message.Message):
    goal_info: _action_msgs_msg.GoalInfo
    def __init__(
        self,
        goal_info: _action_msgs_msg.GoalInfo | None = ...,
    ) -> None: ...

class CancelGoal_Response(_message.Message):
    ERROR_NONE: _typing.ClassVar[int]
    ERROR_REJECTED: _typing.ClassVar[int]
    ERROR_UNKNOWN_GOAL_ID: _typing.ClassVar[int]
    ERROR_GOAL_TERMINATED: _typing.ClassVar[int]
    return_code: int
    goals_canceling: list[_action_msgs_msg.GoalInfo]
    def __init__(
        self,
        return_code: int = ...,
        goals_canceling: list[_action_msgs_msg.GoalInfo] | None = ...,
    ) -> None: ...

class CancelGoal(_message.Service):
    Request = CancelGoal_Request
    Response = CancelGoal_Response
    Event = CancelGoal_Event
