# Generated from the definitions of rosgraph_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.wire import time as _time
from roslet.msgs.ros2.builtin_interfaces import msg as _builtin_interfaces_msg

class Clock(_message.Message):
    clock: _builtin_interfaces_msg.Time | _time.Time
    def __init__(
        self,
        clock: _builtin_interfaces_msg.Time | _time.Time | None = ...,
    ) -> None: ...
