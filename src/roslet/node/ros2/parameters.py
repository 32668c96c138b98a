"""A node's parameters on ROS 2: the store, the services by which others reach it, and the topic that tells of changes."""

from __future__ import annotations

from roslet.engine.ros2 import parameters as store
from roslet.engine.ros2.parameters import (
    Change,
    Descriptor,
    Parameter,
    Parameters,
)
from roslet.errors import ParameterAlreadyDeclared, ParameterNotSet, ParameterRefused
from roslet.node.ros2 import qos as presets

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.node.ros2.network import Ros2Network
    from roslet.node.ros2.services import Ros2Service
    from roslet.node.ros2.topics import Ros2Publisher

# The field of rcl_interfaces/msg/ParameterValue that holds a value of each type.
FIELDS = {
    store.BOOL: "bool_value",
    store.INTEGER: "integer_value",
    store.DOUBLE: "double_value",
    store.STRING: "string_value",
    store.BYTE_ARRAY: "byte_array_value",
    store.BOOL_ARRAY: "bool_array_value",
    store.INTEGER_ARRAY: "integer_array_value",
    store.DOUBLE_ARRAY: "double_array_value",
    store.STRING_ARRAY: "string_array_value",
}
USE_SIM_TIME = "use_sim_time"


def message_of(kind: str, **fields: Any) -> Any:
    """A message of rcl_interfaces."""
    from roslet.gen.runtime import message_class

    return message_class("ros2", f"rcl_interfaces/msg/{kind}")(**fields)


def to_value(parameter: Parameter) -> Any:
    """The ParameterValue of a parameter."""
    field = FIELDS.get(parameter.type)
    fields = {} if field is None else {field: parameter.value}
    return message_of("ParameterValue", type=parameter.type, **fields)


def to_parameter(parameter: Parameter) -> Any:
    """The Parameter message of a parameter."""
    return message_of("Parameter", name=parameter.name, value=to_value(parameter))


def from_value(name: str, value: Any) -> Parameter:
    """The parameter of a ParameterValue. Raises TypeError where it has a type that there is not."""
    if value.type == store.NOT_SET:
        return Parameter(name)
    field = FIELDS.get(value.type)
    if field is None:
        raise TypeError(f"{name}: {value.type} is no type of parameters")
    plain = getattr(value, field)
    if value.type == store.BYTE_ARRAY:
        plain = b"".join(plain) if isinstance(plain, (list, tuple)) else bytes(plain)
    elif value.type >= store.BOOL_ARRAY:
        plain = plain.tolist() if hasattr(plain, "tolist") else list(plain)
        if value.type == store.BOOL_ARRAY:
            plain = [bool(one) for one in plain]
    return Parameter(name, plain, value.type)


def to_descriptor(descriptor: Descriptor) -> Any:
    """The ParameterDescriptor of a description."""
    made = message_of(
        "ParameterDescriptor",
        name=descriptor.name,
        type=descriptor.type,
        description=descriptor.description,
        additional_constraints=descriptor.constraints,
        read_only=descriptor.read_only,
        dynamic_typing=descriptor.dynamic_typing,
    )
    for field, kind in (("floating_point_range", "FloatingPointRange"), ("integer_range", "IntegerRange")):
        limits = getattr(descriptor, field)
        if limits is not None:
            first, last, step = limits
            setattr(made, field, [message_of(kind, from_value=first, to_value=last, step=step)])
    return made


class NodeParameters:
    """`network.parameters`."""

    def __init__(self, network: Ros2Network, overrides: dict[str, Any]) -> None:
        self._network = network
        self._callbacks: dict[str, list[Callable[[Any], object]]] = {}
        self.store = Parameters(overrides, on_change=self._changed)
        self._events: Ros2Publisher | None = None
        self._services: list[Ros2Service] = []
        if network.node._seen:
            self._offer()
        self.store.declare(USE_SIM_TIME, False)

    def _offer(self) -> None:
        """Let others ask, set and hear."""
        network = self._network
        self._events = network.publisher(
            network.resolve("/parameter_events"),
            "rcl_interfaces/msg/ParameterEvent",
            presets.PARAMETER_EVENTS,
        )
        self._services = [
            network.service(
                network.own_service(name),
                f"rcl_interfaces/srv/{kind}",
                handler,
                presets.PARAMETERS,
                background=True,
            )
            for name, kind, handler in self._handlers()
        ]

    def _handlers(self) -> tuple[tuple[str, str, Callable[[Any], Any]], ...]:
        """(name, kind, handler) of the services."""
        return (
            ("describe_parameters", "DescribeParameters", self._describe),
            ("get_parameters", "GetParameters", self._get),
            ("get_parameter_types", "GetParameterTypes", self._types),
            ("list_parameters", "ListParameters", self._list),
            ("set_parameters", "SetParameters", self._set),
            ("set_parameters_atomically", "SetParametersAtomically", self._set_atomically),
        )

    def ask_in_spin(self) -> None:
        """From now on others' requests are served inside spin: the user has callbacks that decide on them."""
        for service in self._services:
            service.background = False

    # -- what a node's user does

    def declare(
        self,
        name: str,
        default: Any = None,
        *,
        read_only: bool = False,
        dynamic_typing: bool = False,
        text: str = "",
        constraints: str = "",
        range: tuple[float, ...] | None = None,  # noqa: A002 - what it is
    ) -> Any:
        """See `GraphApi.declare_parameter`. One that is declared already keeps its value."""
        limits: Any = None if range is None else (tuple(range) + (0,))[:3]  # noqa: RUF005 - runs on MicroPython
        integer = isinstance(default, int)
        descriptor = Descriptor(
            name,
            description=text,
            constraints=constraints,
            read_only=read_only,
            dynamic_typing=dynamic_typing or default is None,
            floating_point_range=None if limits is None or integer else limits,
            integer_range=limits if limits is not None and integer else None,
        )
        try:
            return self.store.declare(name, default, descriptor=descriptor).value
        except ParameterAlreadyDeclared:
            return self.store.get_or(name)

    def get(self, name: str) -> Any:
        """Raises ParameterNotSet."""
        found = self.store.get(name)
        if found.type == store.NOT_SET:
            raise ParameterNotSet(f"parameter {name} is not set")
        return found.value

    def set(self, name: str, value: Any) -> None:
        """Set or declare. Raises ParameterRefused."""
        if not self.store.has(name):
            self.store.declare(name, value, ignore_override=True)
            return
        successful, reason = self.store.set_atomically([Parameter(name, value)])
        if not successful:
            raise ParameterRefused(name, reason)

    def on(self, name: str, callback: Callable[[Any], object]) -> Any:
        self._callbacks.setdefault(name, []).append(callback)
        return self.store.get_or(name)

    def off(self, name: str, callback: Callable[[Any], object]) -> None:
        callbacks = self._callbacks.get(name, [])
        if callback in callbacks:
            callbacks.remove(callback)

    # -- changes

    def undeclare(self, name: str) -> None:
        """Raises ParameterNotSet."""
        parameter = self.store.get(name)
        self.store.undeclare(name)
        self._changed(Change([], [], [Parameter(parameter.name)]))

    def _changed(self, change: Change) -> None:
        # For nobody, the messages' classes need not be made: that would be much of a node's start.
        if self._events is not None and self._events.subscriber_count:
            self._events.publish(self._event(change))
        for one in change.new + change.changed + change.deleted:
            if one.name == USE_SIM_TIME:
                self._network.follow_clock(one.value is True)
            for callback in self._callbacks.get(one.name, ()):
                self._network.node._call_back(callback, one.value)

    def _event(self, change: Change) -> Any:
        stamp = self._network.node.now()
        event = message_of("ParameterEvent", node=self._network.name)
        event.stamp.sec, event.stamp.nanosec = stamp.secs, stamp.nsecs
        event.new_parameters = [to_parameter(one) for one in change.new]
        event.changed_parameters = [to_parameter(one) for one in change.changed]
        event.deleted_parameters = [to_parameter(one) for one in change.deleted]
        return event

    # -- what others ask; every request is answered, as rclpy answers it

    def _get(self, request: Any) -> dict[str, Any]:
        values = []
        for name in request.names:
            try:
                values.append(to_value(self.store.get(name)))
            except ParameterNotSet:
                # rclpy answers nothing at all where one of them is not declared.
                return {"values": []}
        return {"values": values}

    def _types(self, request: Any) -> dict[str, Any]:
        try:
            return {"types": bytes(self.store.get_type(name) for name in request.names)}
        except ParameterNotSet:
            return {"types": b""}

    def _describe(self, request: Any) -> dict[str, Any]:
        try:
            return {"descriptors": [to_descriptor(self.store.describe(name)) for name in request.names]}
        except ParameterNotSet:
            return {"descriptors": []}

    def _list(self, request: Any) -> dict[str, Any]:
        # A depth beyond what a name can have is as good as none: it comes from anybody as a uint64.
        names, prefixes = self.store.list_parameters(list(request.prefixes), min(request.depth, 1 << 31))
        return {"result": message_of("ListParametersResult", names=names, prefixes=prefixes)}

    def _set(self, request: Any) -> dict[str, Any]:
        return {"results": [self._result([one]) for one in request.parameters]}

    def _set_atomically(self, request: Any) -> dict[str, Any]:
        return {"result": self._result(list(request.parameters))}

    def _result(self, messages: list[Any]) -> Any:
        try:
            successful, reason = self.store.set_atomically(
                [from_value(one.name, one.value) for one in messages]
            )
        except (ParameterNotSet, TypeError) as error:
            successful, reason = False, str(error)
        return message_of("SetParametersResult", successful=successful, reason=reason)
