# Generated from the definitions of roscpp by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class Logger(_message.Message):
    name: str
    level: str
    def __init__(
        self,
        name: str = ...,
        level: str = ...,
    ) -> None: ...
