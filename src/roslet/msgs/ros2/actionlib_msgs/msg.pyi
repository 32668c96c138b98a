# Generated from the definitions of actionlib_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg
from roslet.msgs.ros2.std_msgs import msg as _std_msgs_msg

class GoalID(_message.Message):
    stamp: _builtin_interfaces_msg.Time | _time.Time
    id: str
    def __init__(
        self,
        stamp: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        id: str = ...,
    ) -> None: ...

class GoalStatus(_message.Message):
    PENDING: _typing.ClassVar[int]
    ACTIVE: _typing.ClassVar[int]
    PREEMPTED: _typing.ClassVar[int]
    SUCCEEDED: _typing.ClassVar[int]
    ABORTED: _typing.ClassVar[int]
    REJECTED: _typing.ClassVar[int]
    PREEMPTING: _typing.ClassVar[int]
    RECALLING: _typing.ClassVar[int]
    RECALLED: _typing.ClassVar[int]
    LOST: _typing.ClassVar[int]
    goal_id: GoalID
    status: int
    text: str
    def __init__(
        self,
        goal_id: GoalID | None = ...,
        status: int = ...,
        text: str = ...,
    ) -> None: ...

class GoalStatusArray(_message.Message):
    header: _std_msgs_msg.Header
    status_list: list[GoalStatus]
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status_list: list[GoalStatus] | None = ...,
    ) -> None: ...
