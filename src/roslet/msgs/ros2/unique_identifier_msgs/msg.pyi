# Generated from the definitions of unique_identifier_msgs by roslet.gen.stubs. Do not edit.

from collections import abc as _abc

from roslet.wire import message as _message

class UUID(_message.Message):
    uuid: _message.Bytes
    def __init__(
        self,
        uuid: _message.Bytes | _abc.Sequence[int] = ...,
    ) -> None: ...
