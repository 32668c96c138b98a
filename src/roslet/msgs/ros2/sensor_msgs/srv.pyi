# Generated from the definitions of sensor_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros2.sensor_msgs import msg as _sensor_msgs_msg
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg

class SetCameraInfo_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[SetCameraInfo_Request]
    response: list[SetCameraInfo_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[SetCameraInfo_Request] | None = ...,
        response: list[SetCameraInfo_Response] | None = ...,
    ) -> None: ...

class SetCameraInfo_Request(_message.Message):
    camera_info: _sensor_msgs_msg.CameraInfo
    def __init__(
        self,
        camera_info: _sensor_msgs_msg.CameraInfo | None = ...,
    ) -> None: ...

class SetCameraInfo_Response(_message.Message):
    success: bool
    status_message: str
    def __init__(
        self,
        success: bool = ...,
        status_message: str = ...,
    ) -> None: ...

class SetCameraInfo(_message.Service):
    Request = SetCameraInfo_Request
    Response = SetCameraInfo_Response
    Event = SetCameraInfo_Event
