# Generated from the definitions of roscpp_tutorials by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class TwoIntsRequest(_message.Message):
    a: int
    b: int
    def __init__(
        self,
        a: int = ...,
        b: int = ...,
    ) -> None: ...

class TwoIntsResponse(_message.Message):
    sum: int
    def __init__(
        self,
        sum: int = ...,
    ) -> None: ...

class TwoInts(_message.Service):
    Request = TwoIntsRequest
    Response = TwoIntsResponse
