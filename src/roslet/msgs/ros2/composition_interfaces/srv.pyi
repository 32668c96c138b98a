# Generated from the definitions of composition_interfaces by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message
from roslet.msgs.ros2.rcl_interfaces import msg as _rcl_interfaces_msg
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg

class ListNodes_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[ListNodes_Request]
    response: list[ListNodes_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[ListNodes_Request] | None = ...,
        response: list[ListNodes_Response] | None = ...,
    ) -> None: ...

class ListNodes_Request(_message.Message):
    def __init__(self) -> None: ...

class ListNodes_Response(_message.Message):
    full_node_names: list[str]
    unique_ids: _typing.Any
    def __init__(
        self,
        full_node_names: list[str] | None = ...,
        unique_ids: _typing.Any = ...,
    ) -> None: ...

class LoadNode_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[LoadNode_Request]
    response: list[LoadNode_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[LoadNode_Request] | None = ...,
        response: list[LoadNode_Response] | None = ...,
    ) -> None: ...

class LoadNode_Request(_message.Message):
    package_name: str
    plugin_name: str
    node_name: str
    node_namespace: str
    log_level: int
    remap_rules: list[str]
    parameters: list[_rcl_interfaces_msg.Parameter]
    extra_arguments: list[_rcl_interfaces_msg.Parameter]
    def __init__(
        self,
        package_name: str = ...,
        plugin_name: str = ...,
        node_name: str = ...,
        node_namespace: str = ...,
        log_level: int = ...,
        remap_rules: list[str] | None = ...,
        parameters: list[_rcl_interfaces_msg.Parameter] | None = ...,
        extra_arguments: list[_rcl_interfaces_msg.Parameter] | None = ...,
    ) -> None: ...

class LoadNode_Response(_message.Message):
    success: bool
    error_message: str
    full_node_name: str
    unique_id: int
    def __init__(
        self,
        success: bool = ...,
        error_message: str = ...,
        full_node_name: str = ...,
        unique_id: int = ...,
    ) -> None: ...

class UnloadNode_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[UnloadNode_Request]
    response: list[UnloadNode_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[UnloadNode_Request] | None = ...,
        response: list[UnloadNode_Response] | None = ...,
    ) -> None: ...

class UnloadNode_Request(_message.Message):
    unique_id: int
    def __init__(
        self,
        unique_id: int = ...,
    ) -> None: ...

class UnloadNode_Response(_message.Message):
    success: bool
    error_message: str
    def __init__(
        self,
        success: bool = ...,
        error_message: str = ...,
    ) -> None: ...

class ListNodes(_message.Service):
    Request = ListNodes_Request
    Response = ListNodes_Response
    Event = ListNodes_Event

class LoadNode(_message.Service):
    Request = LoadNode_Request
    Response = LoadNode_Response
    Event = LoadNode_Event

class UnloadNode(_message.Service):
    Request = UnloadNode_Request
    Response = UnloadNode_Response
    Event = UnloadNode_Event
