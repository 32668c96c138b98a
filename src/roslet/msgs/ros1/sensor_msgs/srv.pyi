# Generated from the definitions of sensor_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.sensor_msgs import msg as _sensor_msgs_msg

class SetCameraInfoRequest(_message.Message):
    camera_info: _sensor_msgs_msg.CameraInfo
    def __init__(
        self,
        camera_info: _sensor_msgs_msg.CameraInfo | None = ...,
    ) -> None: ...

class SetCameraInfoResponse(_message.Message):
    success: bool
    status_message: str
    def __init__(
        self,
        success: bool = ...,
        status_message: str = ...,
    ) -> None: ...

class SetCameraInfo(_message.Service):
    Request = SetCameraInfoRequest
    Response = SetCameraInfoResponse
