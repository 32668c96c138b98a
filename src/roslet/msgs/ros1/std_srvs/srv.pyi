# Generated from the definitions of std_srvs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class EmptyRequest(_message.Message):
    def __init__(self) -> None: ...

class EmptyResponse(_message.Message):
    def __init__(self) -> None: ...

class SetBoolRequest(_message.Message):
    data: bool
    def __init__(
        self,
        data: bool = ...,
    ) -> None: ...

class SetBoolResponse(_message.Message):
    success: bool
    message: str
    def __init__(
        self,
        success: bool = ...,
        message: str = ...,
    ) -> None: ...

class TriggerRequest(_message.Message):
    def __init__(self) -> None: ...

class TriggerResponse(_message.Message):
    success: bool
    message: str
    def __init__(
        self,
        success: bool = ...,
        message: str = ...,
    ) -> None: ...

class Empty(_message.Service):
    Request = EmptyRequest
    Response = EmptyResponse

class SetBool(_message.Service):
    Request = SetBoolRequest
    Response = SetBoolResponse

class Trigger(_message.Service):
    Request = TriggerRequest
    Response = TriggerResponse
