# Generated from the definitions of stereo_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros2.sensor_msgs import msg as _sensor_msgs_msg
from roslet.msgs.ros2.std_msgs import msg as _std_msgs_msg

class DisparityImage(_message.Message):
    header: _std_msgs_msg.Header
    image: _sensor_msgs_msg.Image
    f: float
    t: float
    valid_window: _sensor_msgs_msg.RegionOfInterest
    min_disparity: float
    max_disparity: float
    delta_d: float
    def __init__(
        self,
        header: _std_msgs_msg.Header | None = ...,
        image: _sensor_msgs_msg.Image | None = ...,
        f: float = ...,
        t: float = ...,
        valid_window: _sensor_msgs_msg.RegionOfInterest | None = ...,
        min_disparity: float = ...,
        max_disparity: float = ...,
        delta_d: float = ...,
    ) -> None: ...
