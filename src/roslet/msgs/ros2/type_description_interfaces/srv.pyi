# Generated from the definitions of type_description_interfaces by roslet.gen.stubs. Do not edit.


from roslet.wire import message as _message
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg
from roslet.msgs.ros2.type_description_interfaces import msg as _type_description_interfaces_msg

class GetTypeDescription_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[GetTypeDescription_Request]
    response: list[GetTypeDescription_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[GetTypeDescription_Request] | None = ...,
        response: list[GetTypeDescription_Response] | None = ...,
    ) -> None: ...

class GetTypeDescription_Request(_message.Message):
    type_name: str
    type_hash: str
    include_type_sources: bool
    def __init__(
        self,
        type_name: str = ...,
        type_hash: str = ...,
        include_type_sources: bool = ...,
    ) -> None: ...

class GetTypeDescription_Response(_message.Message):
    successful: bool
    failure_reason: str
    type_description: _type_description_interfaces_msg.TypeDescription
    type_sources: list[_type_description_interfaces_msg.TypeSource]
    extra_information: list[_type_description_interfaces_msg.KeyValue]
    def __init__(
        self,
        successful: bool = ...,
        failure_reason: str = ...,
        type_description: _type_description_interfaces_msg.TypeDescription | None = ...,
        type_sources: list[_type_description_interfaces_msg.TypeSource] | None = ...,
        extra_information: list[_type_description_interfaces_msg.KeyValue] | None = ...,
    ) -> None: ...

class GetTypeDescription(_message.Service):
    Request = GetTypeDescription_Request
    Response = GetTypeDescription_Response
    Event = GetTypeDescription_Event
