# Generated from the definitions of builtin_interfaces by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class Duration(_message.Stamp):
    sec: int
    nanosec: int
    def __init__(
        self,
        sec: int = ...,
        nanosec: int = ...,
    ) -> None: ...

class Time(_message.Stamp):
    sec: int
    nanosec: int
    def __init__(
        self,
        sec: int = ...,
        nanosec: int = ...,
    ) -> None: ...
