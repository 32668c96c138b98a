# Generated from the definitions of roscpp by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.roscpp import msg as _roscpp_msg

class EmptyRequest(_message.Message):
    def __init__(self) -> None: ...

class EmptyResponse(_message.Message):
    def __init__(self) -> None: ...

class GetLoggersRequest(_message.Message):
    def __init__(self) -> None: ...

class GetLoggersResponse(_message.Message):
    loggers: list[_roscpp_msg.Logger]
    def __init__(
        self,
        loggers: list[_roscpp_msg.Logger] | None = ...,
    ) -> None: ...

class SetLoggerLevelRequest(_message.Message):
    logger: str
    level: str
    def __init__(
        self,
        logger: str = ...,
        level: str = ...,
    ) -> None: ...

class SetLoggerLevelResponse(_message.Message):
    def __init__(self) -> None: ...

class Empty(_message.Service):
    Request = EmptyRequest
    Response = EmptyResponse

class GetLoggers(_message.Service):
    Request = GetLoggersRequest
    Response = GetLoggersResponse

class SetLoggerLevel(_message.Service):
    Request = SetLoggerLevelRequest
    Response = SetLoggerLevelResponse
