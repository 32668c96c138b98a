# Generated from the definitions of lifecycle_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros2.lifecycle_msgs import msg as _lifecycle_msgs_msg
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg

class ChangeState_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[ChangeState_Request]
    response: list[ChangeState_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[ChangeState_Request] | None = ...,
        response: list[ChangeState_Response] | None = ...,
    ) -> None: ...

class ChangeState_Request(_message.Message):
    transition: _lifecycle_msgs_msg.Transition
    def __init__(
        self,
        transition: _lifecycle_msgs_msg.Transition | None = ...,
    ) -> None: ...

class ChangeState_Response(_message.Message):
    success: bool
    def __init__(
        self,
        success: bool = ...,
    ) -> None: ...

class GetAvailableStates_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[GetAvailableStates_Request]
    response: list[GetAvailableStates_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[GetAvailableStates_Request] | None = ...,
        response: list[GetAvailableStates_Response] | None = ...,
    ) -> None: ...

class GetAvailableStates_Request(_message.Message):
    def __init__(self) -> None: ...

class GetAvailableStates_Response(_message.Message):
    available_states: list[_lifecycle_msgs_msg.State]
    def __init__(
        self,
        available_states: list[_lifecycle_msgs_msg.State] | None = ...,
    ) -> None: ...

class GetAvailableTransitions_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[GetAvailableTransitions_Request]
    response: list[GetAvailableTransitions_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[GetAvailableTransitions_Request] | None = ...,
        response: list[GetAvailableTransitions_Response] | None = ...,
    ) -> None: ...

class GetAvailableTransitions_Request(_message.Message):
    def __init__(self) -> None: ...

class GetAvailableTransitions_Response(_message.Message):
    available_transitions: list[_lifecycle_msgs_msg.TransitionDescription]
    def __init__(
        self,
        available_transitions: list[_lifecycle_msgs_msg.TransitionDescription] | None = ...,
    ) -> None: ...

class GetState_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[GetState_Request]
    response: list[GetState_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[GetState_Request] | None = ...,
        response: list[GetState_Response] | None = ...,
    ) -> None: ...

class GetState_Request(_message.Message):
    def __init__(self) -> None: ...

class GetState_Response(_message.Message):
    current_state: _lifecycle_msgs_msg.State
    def __init__(
        self,
        current_state: _lifecycle_msgs_msg.State | None = ...,
    ) -> None: ...

class ChangeState(_message.Service):
    Request = ChangeState_Request
    Response = ChangeState_Response
    Event = ChangeState_Event

class GetAvailableStates(_message.Service):
    Request = GetAvailableStates_Request
    Response = GetAvailableStates_Response
    Event = GetAvailableStates_Event

class GetAvailableTransitions(_message.Service):
    Request = GetAvailableTransitions_Request
    Response = GetAvailableTransitions_Response
    Event = GetAvailableTransitions_Event

class GetState(_message.Service):
    Request = GetState_Request
    Response = GetState_Response
    Event = GetState_Event
