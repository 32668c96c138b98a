# Generated from the definitions of nodelet by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message

class NodeletListRequest(_message.Message):
    def __init__(self) -> None: ...

class NodeletListResponse(_message.Message):
    nodelets: list[str]
    def __init__(
        self,
        nodelets: list[str] | None = ...,
    ) -> None: ...

class NodeletLoadRequest(_message.Message):
    name: str
    type: str
    remap_source_args: list[str]
    remap_target_args: list[str]
    my_argv: list[str]
    bond_id: str
    def __init__(
        self,
        name: str = ...,
        type: str = ...,
        remap_source_args: list[str] | None = ...,
        remap_target_args: list[str] | None = ...,
        my_argv: list[str] | None = ...,
        bond_id: str = ...,
    ) -> None: ...

class NodeletLoadResponse(_message.Message):
    success: bool
    def __init__(
        self,
        success: bool = ...,
    ) -> None: ...

class NodeletUnloadRequest(_message.Message):
    name: str
    def __init__(
        self,
        name: str = ...,
    ) -> None: ...

class NodeletUnloadResponse(_message.Message):
    success: bool
    def __init__(
        self,
        success: bool = ...,
    ) -> None: ...

class NodeletList(_message.Service):
    Request = NodeletListRequest
    Response = NodeletListResponse

class NodeletLoad(_message.Service):
    Request = NodeletLoadRequest
    Response = NodeletLoadResponse

class NodeletUnload(_message.Service):
    Request = NodeletUnloadRequest
    Response = NodeletUnloadResponse
