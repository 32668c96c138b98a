# Generated from the definitions of tf by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.geometry_msgs import msg as _geometry_msgs_msg

class tfMessage(_message.Message):
    transforms: list[_geometry_msgs_msg.TransformStamped]
    def __init__(
        self,
        transforms: list[_geometry_msgs_msg.TransformStamped] | None = ...,
    ) -> None: ...
