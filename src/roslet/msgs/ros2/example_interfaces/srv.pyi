# Generated from the definitions of example_interfaces by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg

class AddTwoInts_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[AddTwoInts_Request]
    response: list[AddTwoInts_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[AddTwoInts_Request] | None = ...,
        response: list[AddTwoInts_Response] | None = ...,
    ) -> None: ...

class AddTwoInts_Request(_message.Message):
    a: int
    b: int
    def __init__(
        self,
        a: int = ...,
        b: int = ...,
    ) -> None: ...

class AddTwoInts_Response(_message.Message):
    sum: int
    def __init__(
        self,
        sum: int = ...,
    ) -> None: ...

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

class AddTwoInts(_message.Service):
    Request = AddTwoInts_Request
    Response = AddTwoInts_Response
    Event = AddTwoInts_Event

class SetBool(_message.Service):
    Request = SetBool_Request
    Response = SetBool_Response
    Event = SetBool_Event

class Trigger(_message.Service):
    Request = Trigger_Request
    Response = Trigger_Response
    Event = Trigger_Event
