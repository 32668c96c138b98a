# Generated from the definitions of tf2_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class FrameGraphRequest(_message.Message):
    def __init__(self) -> None: ...

class FrameGraphResponse(_message.Message):
    frame_yaml: str
    def __init__(
        self,
        frame_yaml: str = ...,
    ) -> None: ...

class FrameGraph(_message.Service):
    Request = FrameGraphRequest
    Response = FrameGraphResponse
