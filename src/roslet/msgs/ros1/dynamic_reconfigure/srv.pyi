# Generated from the definitions of dynamic_reconfigure by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros1.dynamic_reconfigure import msg as _dynamic_reconfigure_msg

class ReconfigureRequest(_message.Message):
    config: _dynamic_reconfigure_msg.Config
    def __init__(
        self,
        config: _dynamic_reconfigure_msg.Config | None = ...,
    ) -> None: ...

class ReconfigureResponse(_message.Message):
    config: _dynamic_reconfigure_msg.Config
    def __init__(
        self,
        config: _dynamic_reconfigure_msg.Config | None = ...,
    ) -> None: ...

class Reconfigure(_message.Service):
    Request = ReconfigureRequest
    Response = ReconfigureResponse
