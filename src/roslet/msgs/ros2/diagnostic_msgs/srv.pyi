# Generated from the definitions of diagnostic_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros2.diagnostic_msgs import msg as _diagnostic_msgs_msg
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg

class AddDiagnostics_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[AddDiagnostics_Request]
    response: list[AddDiagnostics_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[AddDiagnostics_Request] | None = ...,
        response: list[AddDiagnostics_Response] | None = ...,
    ) -> None: ...

class AddDiagnostics_Request(_message.Message):
    load_namespace: str
    def __init__(
        self,
        load_namespace: str = ...,
    ) -> None: ...

class AddDiagnostics_Response(_message.Message):
    success: bool
    message: str
    def __init__(
        self,
        success: bool = ...,
        message: str = ...,
    ) -> None: ...

class SelfTest_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[SelfTest_Request]
    response: list[SelfTest_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[SelfTest_Request] | None = ...,
        response: list[SelfTest_Response] | None = ...,
    ) -> None: ...

class SelfTest_Request(_message.Message):
    def __init__(self) -> None: ...

class SelfTest_Response(_message.Message):
    id: str
    passed: int
    status: list[_diagnostic_msgs_msg.DiagnosticStatus]
    def __init__(
        self,
        id: str = ...,
        passed: int = ...,
        status: list[_diagnostic_msgs_msg.DiagnosticStatus] | None = ...,
    ) -> None: ...

class AddDiagnostics(_message.Service):
    Request = AddDiagnostics_Request
    Response = AddDiagnostics_Response
    Event = AddDiagnostics_Event

class SelfTest(_message.Service):
    Request = SelfTest_Request
    Response = SelfTest_Response
    Event = SelfTest_Event
