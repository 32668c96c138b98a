# Generated from the definitions of rcl_interfaces by roslet.gen.stubs. Do not edit.

import typing as _typing
from collections import abc as _abc

from roslet.wire import message as _message
from roslet.msgs.ros2.rcl_interfaces import msg as _rcl_interfaces_msg
from roslet.msgs.ros2.service_msgs import msg as _service_msgs_msg

class DescribeParameters_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[DescribeParameters_Request]
    response: list[DescribeParameters_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[DescribeParameters_Request] | None = ...,
        response: list[DescribeParameters_Response] | None = ...,
    ) -> None: ...

class DescribeParameters_Request(_message.Message):
    names: list[str]
    def __init__(
        self,
        names: list[str] | None = ...,
    ) -> None: ...

class DescribeParameters_Response(_message.Message):
    descriptors: list[_rcl_interfaces_msg.ParameterDescriptor]
    def __init__(
        self,
        descriptors: list[_rcl_interfaces_msg.ParameterDescriptor] | None = ...,
    ) -> None: ...

class GetLoggerLevels_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[GetLoggerLevels_Request]
    response: list[GetLoggerLevels_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[GetLoggerLevels_Request] | None = ...,
        response: list[GetLoggerLevels_Response] | None = ...,
    ) -> None: ...

class GetLoggerLevels_Request(_message.Message):
    names: list[str]
    def __init__(
        self,
        names: list[str] | None = ...,
    ) -> None: ...

class GetLoggerLevels_Response(_message.Message):
    levels: list[_rcl_interfaces_msg.LoggerLevel]
    def __init__(
        self,
        levels: list[_rcl_interfaces_msg.LoggerLevel] | None = ...,
    ) -> None: ...

class GetParameterTypes_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[GetParameterTypes_Request]
    response: list[GetParameterTypes_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[GetParameterTypes_Request] | None = ...,
        response: list[GetParameterTypes_Response] | None = ...,
    ) -> None: ...

class GetParameterTypes_Request(_message.Message):
    names: list[str]
    def __init__(
        self,
        names: list[str] | None = ...,
    ) -> None: ...

class GetParameterTypes_Response(_message.Message):
    types: _message.Bytes
    def __init__(
        self,
        types: _message.Bytes | _abc.Sequence[int] = ...,
    ) -> None: ...

class GetParameters_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[GetParameters_Request]
    response: list[GetParameters_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[GetParameters_Request] | None = ...,
        response: list[GetParameters_Response] | None = ...,
    ) -> None: ...

class GetParameters_Request(_message.Message):
    names: list[str]
    def __init__(
        self,
        names: list[str] | None = ...,
    ) -> None: ...

class GetParameters_Response(_message.Message):
    values: list[_rcl_interfaces_msg.ParameterValue]
    def __init__(
        self,
        values: list[_rcl_interfaces_msg.ParameterValue] | None = ...,
    ) -> None: ...

class ListParameters_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[ListParameters_Request]
    response: list[ListParameters_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[ListParameters_Request] | None = ...,
        response: list[ListParameters_Response] | None = ...,
    ) -> None: ...

class ListParameters_Request(_message.Message):
    DEPTH_RECURSIVE: _typing.ClassVar[int]
    prefixes: list[str]
    depth: int
    def __init__(
        self,
        prefixes: list[str] | None = ...,
        depth: int = ...,
    ) -> None: ...

class ListParameters_Response(_message.Message):
    result: _rcl_interfaces_msg.ListParametersResult
    def __init__(
        self,
        result: _rcl_interfaces_msg.ListParametersResult | None = ...,
    ) -> None: ...

class SetLoggerLevels_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[SetLoggerLevels_Request]
    response: list[SetLoggerLevels_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[SetLoggerLevels_Request] | None = ...,
        response: list[SetLoggerLevels_Response] | None = ...,
    ) -> None: ...

class SetLoggerLevels_Request(_message.Message):
    levels: list[_rcl_interfaces_msg.LoggerLevel]
    def __init__(
        self,
        levels: list[_rcl_interfaces_msg.LoggerLevel] | None = ...,
    ) -> None: ...

class SetLoggerLevels_Response(_message.Message):
    results: list[_rcl_interfaces_msg.SetLoggerLevelsResult]
    def __init__(
        self,
        results: list[_rcl_interfaces_msg.SetLoggerLevelsResult] | None = ...,
    ) -> None: ...

class SetParametersAtomically_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[SetParametersAtomically_Request]
    response: list[SetParametersAtomically_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[SetParametersAtomically_Request] | None = ...,
        response: list[SetParametersAtomically_Response] | None = ...,
    ) -> None: ...

class SetParametersAtomically_Request(_message.Message):
    parameters: list[_rcl_interfaces_msg.Parameter]
    def __init__(
        self,
        parameters: list[_rcl_interfaces_msg.Parameter] | None = ...,
    ) -> None: ...

class SetParametersAtomically_Response(_message.Message):
    result: _rcl_interfaces_msg.SetParametersResult
    def __init__(
        self,
        result: _rcl_interfaces_msg.SetParametersResult | None = ...,
    ) -> None: ...

class SetParameters_Event(_message.Message):
    info: _service_msgs_msg.ServiceEventInfo
    request: list[SetParameters_Request]
    response: list[SetParameters_Response]
    def __init__(
        self,
        info: _service_msgs_msg.ServiceEventInfo | None = ...,
        request: list[SetParameters_Request] | None = ...,
        response: list[SetParameters_Response] | None = ...,
    ) -> None: ...

class SetParameters_Request(_message.Message):
    parameters: list[_rcl_interfaces_msg.Parameter]
    def __init__(
        self,
        parameters: list[_rcl_interfaces_msg.Parameter] | None = ...,
    ) -> None: ...

class SetParameters_Response(_message.Message):
    results: list[_rcl_interfaces_msg.SetParametersResult]
    def __init__(
        self,
        results: list[_rcl_interfaces_msg.SetParametersResult] | None = ...,
    ) -> None: ...

class DescribeParameters(_message.Service):
    Request = DescribeParameters_Request
    Response = DescribeParameters_Response
    Event = DescribeParameters_Event

class GetLoggerLevels(_message.Service):
    Request = GetLoggerLevels_Request
    Response = GetLoggerLevels_Response
    Event = GetLoggerLevels_Event

class GetParameterTypes(_message.Service):
    Request = GetParameterTypes_Request
    Response = GetParameterTypes_Response
    Event = GetParameterTypes_Event

class GetParameters(_message.Service):
    Request = GetParameters_Request
    Response = GetParameters_Response
    Event = GetParameters_Event

class ListParameters(_message.Service):
    Request = ListParameters_Request
    Response = ListParameters_Response
    Event = ListParameters_Event

class SetLoggerLevels(_message.Service):
    Request = SetLoggerLevels_Request
    Response = SetLoggerLevels_Response
    Event = SetLoggerLevels_Event

class SetParameters(_message.Service):
    Request = SetParameters_Request
    Response = SetParameters_Response
    Event = SetParameters_Event

class SetParametersAtomically(_message.Service):
    Request = SetParametersAtomically_Request
    Response = SetParametersAtomically_Response
    Event = SetParametersAtomically_Event
