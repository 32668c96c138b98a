# Generated from the definitions of visualization_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg
from roslet.msgs.ros2.visualization_msgs import msg as _visualization_msgs_msg

class GetInteractiveMarkers_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[GetInteractiveMarkers_Request]
    response: list[GetInteractiveMarkers_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[GetInteractiveMarkers_Request] | None = ...,
        response: list[GetInteractiveMarkers_Response] | None = ...,
    ) -> None: ...

class GetInteractiveMarkers_Request(_message.Message):
    def __init__(self) -> None: ...

class GetInteractiveMarkers_Response(_message.Message):
    sequence_number: int
    markers: list[_visualization_msgs_msg.InteractiveMarker]
    def __init__(
        self,
        sequence_number: int = ...,
        markers: list[_visualization_msgs_msg.InteractiveMarker] | None = ...,
    ) -> None: ...

class GetInteractiveMarkers(_message.Service):
    Request = GetInteractiveMarkers_Request
    Response = GetInteractiveMarkers_Response
    Event = GetInteractiveMarkers_Event
