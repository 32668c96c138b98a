# Generated from the definitions of pcl_msgs by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class UpdateFilenameRequest(_message.Message):
    filename: str
    def __init__(
        self,
        filename: str = ...,
    ) -> None: ...

class UpdateFilenameResponse(_message.Message):
    success: bool
    def __init__(
        self,
        success: bool = ...,
    ) -> None: ...

class UpdateFilename(_message.Service):
    Request = UpdateFilenameRequest
    Response = UpdateFilenameResponse
