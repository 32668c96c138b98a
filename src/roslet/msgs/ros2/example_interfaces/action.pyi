# Generated from the definitions of example_interfaces by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg
from roslet.msgs.ros2.unique_identifier_msgs import msg as _unique_identifier_msgs_msg

class Fibonacci_Feedback(_message.Message):
    sequence: _typing.Any
    def __init__(
        self,
        sequence: _typing.Any = ...,
    ) -> None: ...

class Fibonacci_FeedbackMessage(_message.Message):
    goal_id: _unique_identifier_msgs_msg.UUID
    feedback: Fibonacci_Feedback
    def __init__(
        self,
        goal_id: _unique_identifier_msgs_msg.UUID | None = ...,
        feedback: Fibonacci_Feedback | None = ...,
    ) -> None: ...

class Fibonacci_GetResult_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[Fibonacci_GetResult_Request]
    response: list[Fibonacci_GetResult_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[Fibonacci_GetResult_Request] | None = ...,
        response: list[Fibonacci_GetResult_Response] | None = ...,
    ) -> None: ...

class Fibonacci_GetResult_Request(_message.Message):
    goal_id: _unique_identifier_msgs_msg.UUID
    def __init__(
        self,
        goal_id: _unique_identifier_msgs_msg.UUID | None = ...,
    ) -> None: ...

class Fibonacci_GetResult_Response(_message.Message):
    status: int
    result: Fibonacci_Result
    def __init__(
        self,
        status: int = ...,
        result: Fibonacci_Result | None = ...,
    ) -> None: ...

class Fibonacci_Goal(_message.Message):
    order: int
    def __init__(
        self,
        order: int = ...,
    ) -> None: ...

class Fibonacci_Result(_message.Message):
    sequence: _typing.Any
    def __init__(
        self,
        sequence: _typing.Any = ...,
    ) -> None: ...

class Fibonacci_SendGoal_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[Fibonacci_SendGoal_Request]
    response: list[Fibonacci_SendGoal_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[Fibonacci_SendGoal_Request] | None = ...,
        response: list[Fibonacci_SendGoal_Response] | None = ...,
    ) -> None: ...

class Fibonacci_SendGoal_Request(_message.Message):
    goal_id: _unique_identifier_msgs_msg.UUID
    goal: Fibonacci_Goal
    def __init__(
        self,
        goal_id: _unique_identifier_msgs_msg.UUID | None = ...,
        goal: Fibonacci_Goal | None = ...,
    ) -> None: ...

class Fibonacci_SendGoal_Response(_message.Message):
    accepted: bool
    stamp: _builtin_interfaces_msg.Time | _time.Time
    def __init__(
        self,
        accepted: bool = ...,
        stamp: _builtin_interfaces_msg.Time | _time.Time | None = ...,
    ) -> None: ...

class Fibonacci(_message.Action):
    Goal = Fibonacci_Goal
    Result = Fibonacci_Result
    Feedback = Fibonacci_Feedback
    SendGoal = Fibonacci_SendGoal
    GetResult = Fibonacci_GetResult
    FeedbackMessage = Fibonacci_FeedbackMessage

class Fibonacci_GetResult(_message.Service):
    Request = Fibonacci_GetResult_Request
    Response = Fibonacci_GetResult_Response
    Event = Fibonacci_GetResult_Event

class Fibonacci_SendGoal(_message.Service):
    Request = Fibonacci_SendGoal_Request
    Response = Fibonacci_SendGoal_Response
    Event = Fibonacci_SendGoal_Event
