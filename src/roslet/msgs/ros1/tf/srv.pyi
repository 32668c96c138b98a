# Generated from the definitions of tf by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class FrameGraphRequest(_message.Message):
    def __init__(self) -> None: ...

class FrameGraphResponse(_message.Message):
    dot_graph: str
    def __init__(
        self,
        dot_graph: str = ...,
    ) -> None: ...

class FrameGraph(_message.Service):
    Request = FrameGraphRequest
    Response = FrameGraphResponse
