# Generated from the definitions of diagnostic_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.diagnostic_msgs import msg as _diagnostic_msgs_msg

class AddDiagnosticsRequest(_message.Message):
    load_namespace: str
    def __init__(
        self,
        load_namespace: str = ...,
    ) -> None: ...

class AddDiagnosticsResponse(_message.Message):
    success: bool
    message: str
    def __init__(
        self,
        success: bool = ...,
        message: str = ...,
    ) -> None: ...

class SelfTestRequest(_message.Message):
    def __init__(self) -> None: ...

class SelfTestResponse(_message.Message):
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
    Request = AddDiagnosticsRequest
    Response = AddDiagnosticsResponse

class SelfTest(_message.Service):
    Request = SelfTestRequest
    Response = SelfTestResponse
