# Generated from the definitions of tf2_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros1.actionlib_msgs import msg as _actionlib_msgs_msg
from roslet.msgs.ros1.geometry_msgs import msg as _geometry_msgs_msg
from roslet.msgs.ros1.std_msgs import msg as _std_msgs_msg

class LookupTransformAction(_message.Message):
    action_goal: LookupTransformActionGoal
    action_result: LookupTransformActionResult
    action_feedback: LookupTransformActionFeedback
    def __init__(
        self,
        action_goal: LookupTransformActionGoal | None = ...,
        action_result: LookupTransformActionResult | None = ...,
        action_feedback: LookupTransformActionFeedback | None = ...,
    ) -> None: ...

class LookupTransformActionFeedback(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    feedback: LookupTransformFeedback
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        feedback: LookupTransformFeedback | None = ...,
    ) -> None: ...

class LookupTransformActionGoal(_message.Message):
    header: _std_msgs_msg.Header
    goal_id: _actionlib_msgs_msg.GoalID
    goal: LookupTransformGoal
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        goal_id: _actionlib_msgs_msg.GoalID | None = ...,
        goal: LookupTransformGoal | None = ...,
    ) -> None: ...

class LookupTransformActionResult(_message.Message):
    header: _std_msgs_msg.Header
    status: _actionlib_msgs_msg.GoalStatus
    result: LookupTransformResult
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        status: _actionlib_msgs_msg.GoalStatus | None = ...,
        result: LookupTransformResult | None = ...,
    ) -> None: ...

class LookupTransformFeedback(_message.Message):
    def __init__(self) -> None: ...

class LookupTransformGoal(_message.Message):
    target_frame: str
    source_frame: str
    source_time: _time.Time
    timeout: _time.Duration
    target_time: _time.Time
    fixed_frame: str
    advanced: bool
    def __init__(
        self,
        target_frame: str = ...,
        source_frame: str = ...,
        source_time: _time.Time | None = ...,
        timeout: _time.Duration | None = ...,
        target_time: _time.Time | None = ...,
        fixed_frame: str = ...,
        advanced: bool = ...,
    ) -> None: ...

class LookupTransformResult(_message.Message):
    transform: _geometry_msgs_msg.TransformStamped
    error: TF2Error
    def __init__(
        self,
        transform: _geometry_msgs_msg.TransformStamped | None = ...,
        error: TF2Error | None = ...,
    ) -> None: ...

class TF2Error(_message.Message):
    NO_ERROR: _typing.ClassVar[int]
    LOOKUP_ERROR: _typing.ClassVar[int]
    CONNECTIVITY_ERROR: _typing.ClassVar[int]
    EXTRAPOLATION_ERROR: _typing.ClassVar[int]
    INVALID_ARGUMENT_ERROR: _typing.ClassVar[int]
    TIMEOUT_ERROR: _typing.ClassVar[int]
    TRANSFORM_ERROR: _typing.ClassVar[int]
    error: int
    error_string: str
    def __init__(
        self,
        error: int = ...,
        error_string: str = ...,
    ) -> None: ...

class TFMessage(_message.Message):
    transforms: list[_geometry_msgs_msg.TransformStamped]
    def __init__(
        self,
        transforms: list[_geometry_msgs_msg.TransformStamped] | None = ...,
    ) -> None: ...
