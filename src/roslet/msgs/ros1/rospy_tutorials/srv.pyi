# Generated from the definitions of rospy_tutorials by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class AddTwoIntsRequest(_message.Message):
    a: int
    b: int
    def __init__(
        self,
        a: int = ...,
        b: int = ...,
    ) -> None: ...

class AddTwoIntsResponse(_message.Message):
    sum: int
    def __init__(
        self,
        sum: int = ...,
    ) -> None: ...

class BadTwoIntsRequest(_message.Message):
    a: int
    b: int
    def __init__(
        self,
        a: int = ...,
        b: int = ...,
    ) -> None: ...

class BadTwoIntsResponse(_message.Message):
    sum: int
    def __init__(
        self,
        sum: int = ...,
    ) -> None: ...

class AddTwoInts(_message.Service):
    Request = AddTwoIntsRequest
    Response = AddTwoIntsResponse

class BadTwoInts(_message.Service):
    Request = BadTwoIntsRequest
    Response = BadTwoIntsResponse
