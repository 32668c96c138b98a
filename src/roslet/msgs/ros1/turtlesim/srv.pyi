# Generated from the definitions of turtlesim by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class KillRequest(_message.Message):
    name: str
    def __init__(
        self,
        name: str = ...,
    ) -> None: ...

class KillResponse(_message.Message):
    def __init__(self) -> None: ...

class SetPenRequest(_message.Message):
    r: int
    g: int
    b: int
    width: int
    off: int
    def __init__(
        self,
        r: int = ...,
        g: int = ...,
        b: int = ...,
        width: int = ...,
        off: int = ...,
    ) -> None: ...

class SetPenResponse(_message.Message):
    def __init__(self) -> None: ...

class SpawnRequest(_message.Message):
    x: float
    y: float
    theta: float
    name: str
    def __init__(
        self,
        x: float = ...,
        y: float = ...,
        theta: float = ...,
        name: str = ...,
    ) -> None: ...

class SpawnResponse(_message.Message):
    name: str
    def __init__(
        self,
        name: str = ...,
    ) -> None: ...

class TeleportAbsoluteRequest(_message.Message):
    x: float
    y: float
    theta: float
    def __init__(
        self,
        x: float = ...,
        y: float = ...,
        theta: float = ...,
    ) -> None: ...

class TeleportAbsoluteResponse(_message.Message):
    def __init__(self) -> None: ...

class TeleportRelativeRequest(_message.Message):
    linear: float
    angular: float
    def __init__(
        self,
        linear: float = ...,
        angular: float = ...,
    ) -> None: ...

class TeleportRelativeResponse(_message.Message):
    def __init__(self) -> None: ...

class Kill(_message.Service):
    Request = KillRequest
    Response = KillResponse

class SetPen(_message.Service):
    Request = SetPenRequest
    Response = SetPenResponse

class Spawn(_message.Service):
    Request = SpawnRequest
    Response = SpawnResponse

class TeleportAbsolute(_message.Service):
    Request = TeleportAbsoluteRequest
    Response = TeleportAbsoluteResponse

class TeleportRelative(_message.Service):
    Request = TeleportRelativeRequest
    Response = TeleportRelativeResponse
