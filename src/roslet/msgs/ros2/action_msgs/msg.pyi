# Generated from the definitions of action_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg
from roslet.msgs.ros2.unique_identifier_msgs import msg as _unique_identifier_msgs_msg

class GoalInfo(_message.Message):
    goal_id: _unique_identifier_msgs_msg.UUID
    stamp: _builtin_interfaces_msg.Time | _time.Time
    def __init__(
        self,
        goal_id: _unique_identifier_msgs_msg.UUID | None = ...,
        stamp: _builtin_interfaces_msg.Time | _time.Time | None = ...,
    ) -> None: ...

class GoalStatus(_message.Message):
    STATUS_UNKNOWN: _typing.ClassVar[int]
    STATUS_ACCEPTED: _typing.ClassVar[int]
    STATUS_EXECUTING: _typing.ClassVar[int]
    STATUS_CANCELING: _typing.ClassVar[int]
    STATUS_SUCCEEDED: _typing.ClassVar[int]
    STATUS_CANCELED: _typing.ClassVar[int]
    STATUS_ABORTED: _typing.ClassVar[int]
    goal_info: GoalInfo
    status: int
    def __init__(
        self,
        goal_info: GoalInfo | None = ...,
        status: int = ...,
    ) -> None: ...

class GoalStatusArray(_message.Message):
    status_list: list[GoalStatus]
    def __init__(
        self,
        status_list: list[GoalStatus] | None = ...,
    ) -> None: ...
