# Generated from the definitions of turtlesim by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class Color(_message.Message):
    r: int
    g: int
    b: int
    def __init__(
        self,
        r: int = ...,
        g: int = ...,
        b: int = ...,
    ) -> None: ...

class Pose(_message.Message):
    x: float
    y: float
    theta: float
    linear_velocity: float
    angular_velocity: float
    def __init__(
        self,
        x: float = ...,
        y: float = ...,
        theta: float = ...,
        linear_velocity: float = ...,
        angular_velocity: float = ...,
    ) -> None: ...
