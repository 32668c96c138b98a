# Generated from the definitions of tf2_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg
from roslet.msgs.ros2.geometry_msgs import msg as _geometry_msgs_msg
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg
from roslet.msgs.ros2.tf2_msgs import msg as _tf2_msgs_msg
from roslet.msgs.ros2.unique_identifier_msgs import msg as _unique_identifier_msgs_msg

class LookupTransform_Feedback(_message.Message):
    def __init__(self) -> None: ...

class LookupTransform_FeedbackMessage(_message.Message):
    goal_id: _unique_identifier_msgs_msg.UUID
    feedback: LookupTransform_Feedback
    def __init__(
        self,
        goal_id: _unique_identifier_msgs_msg.UUID | None = ...,
        feedback: LookupTransform_Feedback | None = ...,
    ) -> None: ...

class LookupTransform_GetResult_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[LookupTransform_GetResult_Request]
    response: list[LookupTransform_GetResult_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[LookupTransform_GetResult_Request] | None = ...,
        response: list[LookupTransform_GetResult_Response] | None = ...,
    ) -> None: ...

class LookupTransform_GetResult_Request(_message.Message):
    goal_id: _unique_identifier_msgs_msg.UUID
    def __init__(
        self,
        goal_id: _unique_identifier_msgs_msg.UUID | None = ...,
    ) -> None: ...

class LookupTransform_GetResult_Response(_message.Message):
    status: int
    result: LookupTransform_Result
    def __init__(
        self,
        status: int = ...,
        result: LookupTransform_Result | None = ...,
    ) -> None: ...

class LookupTransform_Goal(_message.Message):
    target_frame: str
    source_frame: str
    source_time: _builtin_interfaces_msg.Time | _time.Time
    timeout: _builtin_interfaces_msg.Duration | _time.Duration
    target_time: _builtin_interfaces_msg.Time | _time.Time
    fixed_frame: str
    advanced: bool
    def __init__(
        self,
        target_frame: str = ...,
        source_frame: str = ...,
        source_time: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        timeout: _builtin_interfaces_msg.Duration | _time.Duration | None = ...,
        target_time: _builtin_interfaces_msg.Time | _time.Time | None = ...,
        fixed_frame: str = ...,
        advanced: bool = ...,
    ) -> None: ...

class LookupTransform_Result(_message.Message):
    transform: _geometry_msgs_msg.TransformStamped
    error: _tf2_msgs_msg.TF2Error
    def __init__(
        self,
        transform: _geometry_msgs_msg.TransformStamped | None = ...,
        error: _tf2_msgs_msg.TF2Error | None = ...,
    ) -> None: ...

class LookupTransform_SendGoal_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[LookupTransform_SendGoal_Request]
    response: list[LookupTransform_SendGoal_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[LookupTransform_SendGoal_Request] | None = ...,
        response: list[LookupTransform_SendGoal_Response] | None = ...,
    ) -> None: ...

class LookupTransform_SendGoal_Request(_message.Message):
    goal_id: _unique_identifier_msgs_msg.UUID
    goal: LookupTransform_Goal
    def __init__(
        self,
        goal_id: _unique_identifier_msgs_msg.UUID | None = ...,
        goal: LookupTransform_Goal | None = ...,
    ) -> None: ...

class LookupTransform_SendGoal_Response(_message.Message):
    accepted: bool
    stamp: _builtin_interfaces_msg.Time | _time.Time
    def __init__(
        self,
        accepted: bool = ...,
        stamp: _builtin_interfaces_msg.Time | _time.Time | None = ...,
    ) -> None: ...

class LookupTransform(_message.Action):
    Goal = LookupTransform_Goal
    Result = LookupTransform_Result
    Feedback = LookupTransform_Feedback
    SendGoal = LookupTransform_SendGoal
    GetResult = LookupTransform_GetResult
    FeedbackMessage = LookupTransform_FeedbackMessage

class LookupTransform_GetResult(_message.Service):
    Request = LookupTransform_GetResult_Request
    Response = LookupTransform_GetResult_Response
    Event = LookupTransform_GetResult_Event

class LookupTransform_SendGoal(_message.Service):
    Request = LookupTransform_SendGoal_Request
    Response = LookupTransform_SendGoal_Response
    Event = LookupTransform_SendGoal_Event
