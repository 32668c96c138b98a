# Generated from the definitions of tf2_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg

class FrameGraph_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[FrameGraph_Request]
    response: list[FrameGraph_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[FrameGraph_Request] | None = ...,
        response: list[FrameGraph_Response] | None = ...,
    ) -> None: ...

class FrameGraph_Request(_message.Message):
    def __init__(self) -> None: ...

class FrameGraph_Response(_message.Message):
    frame_yaml: str
    def __init__(
        self,
        frame_yaml: str = ...,
    ) -> None: ...

class FrameGraph(_message.Service):
    Request = FrameGraph_Request
    Response = FrameGraph_Response
    Event = FrameGraph_Event
