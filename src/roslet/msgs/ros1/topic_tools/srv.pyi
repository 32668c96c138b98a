# Generated from the definitions of topic_tools by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class DemuxAddRequest(_message.Message):
    topic: str
    def __init__(
        self,
        topic: str = ...,
    ) -> None: ...

class DemuxAddResponse(_message.Message):
    def __init__(self) -> None: ...

class DemuxDeleteRequest(_message.Message):
    topic: str
    def __init__(
        self,
        topic: str = ...,
    ) -> None: ...

class DemuxDeleteResponse(_message.Message):
    def __init__(self) -> None: ...

class DemuxListRequest(_message.Message):
    def __init__(self) -> None: ...

class DemuxListResponse(_message.Message):
    topics: list[str]
    def __init__(
        self,
        topics: list[str] | None = ...,
    ) -> None: ...

class DemuxSelectRequest(_message.Message):
    topic: str
    def __init__(
        self,
        topic: str = ...,
    ) -> None: ...

class DemuxSelectResponse(_message.Message):
    prev_topic: str
    def __init__(
        self,
        prev_topic: str = ...,
    ) -> None: ...

class MuxAddRequest(_message.Message):
    topic: str
    def __init__(
        self,
        topic: str = ...,
    ) -> None: ...

class MuxAddResponse(_message.Message):
    def __init__(self) -> None: ...

class MuxDeleteRequest(_message.Message):
    topic: str
    def __init__(
        self,
        topic: str = ...,
    ) -> None: ...

class MuxDeleteResponse(_message.Message):
    def __init__(self) -> None: ...

class MuxListRequest(_message.Message):
    def __init__(self) -> None: ...

class MuxListResponse(_message.Message):
    topics: list[str]
    def __init__(
        self,
        topics: list[str] | None = ...,
    ) -> None: ...

class MuxSelectRequest(_message.Message):
    topic: str
    def __init__(
        self,
        topic: str = ...,
    ) -> None: ...

class MuxSelectResponse(_message.Message):
    prev_topic: str
    def __init__(
        self,
        prev_topic: str = ...,
    ) -> None: ...

class DemuxAdd(_message.Service):
    Request = DemuxAddRequest
    Response = DemuxAddResponse

class DemuxDelete(_message.Service):
    Request = DemuxDeleteRequest
    Response = DemuxDeleteResponse

class DemuxList(_message.Service):
    Request = DemuxListRequest
    Response = DemuxListResponse

class DemuxSelect(_message.Service):
    Request = DemuxSelectRequest
    Response = DemuxSelectResponse

class MuxAdd(_message.Service):
    Request = MuxAddRequest
    Response = MuxAddResponse

class MuxDelete(_message.Service):
    Request = MuxDeleteRequest
    Response = MuxDeleteResponse

class MuxList(_message.Service):
    Request = MuxListRequest
    Response = MuxListResponse

class MuxSelect(_message.Service):
    Request = MuxSelectRequest
    Response = MuxSelectResponse
