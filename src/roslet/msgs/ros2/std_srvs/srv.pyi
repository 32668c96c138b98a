# Generated from the definitions of std_srvs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg

class Empty_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[Empty_Request]
    response: list[Empty_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[Empty_Request] | None = ...,
        response: list[Empty_Response] | None = ...,
    ) -> None: ...

class Empty_Request(_message.Message):
    def __init__(self) -> None: ...

class Empty_Response(_message.Message):
    def __init__(self) -> None: ...

class SetBool_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[SetBool_Request]
    response: list[SetBool_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[SetBool_Request] | None = ...,
        response: list[SetBool_Response] | None = ...,
    ) -> None: ...

class SetBool_Request(_message.Message):
    data: bool
    def __init__(
        self,
        data: bool = ...,
    ) -> None: ...

class SetBool_Response(_message.Message):
    success: bool
    message: str
    def __init__(
        self,
        success: bool = ...,
        message: str = ...,
    ) -> None: ...

class Trigger_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[Trigger_Request]
    response: list[Trigger_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[Trigger_Request] | None = ...,
        response: list[Trigger_Response] | None = ...,
    ) -> None: ...

class Trigger_Request(_message.Message):
    def __init__(self) -> None: ...

class Trigger_Response(_message.Message):
    success: bool
    message: str
    def __init__(
        self,
        success: bool = ...,
        message: str = ...,
    ) -> None: ...

class Empty(_message.Service):
    Request = Empty_Request
    Response = Empty_Response
    Event = Empty_Event

class SetBool(_message.Service):
    Request = SetBool_Request
    Response = SetBool_Response
    Event = SetBool_Event

class Trigger(_message.Service):
    Request = Trigger_Request
    Response = Trigger_Response
    Event = Trigger_Event
