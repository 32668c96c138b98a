"""The parameters of an rclpy node: roslet's store with rclpy's sentences, values, messages and exceptions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat.interfaces import message_class
from roslet.compat.rclpy.exceptions import (
    InvalidParameterException,
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from roslet.compat.rclpy.parameter import Parameter
from roslet.compat.rclpy.service import Requests
from roslet.engine.ros2 import parameters as store
from roslet.errors import (
    ParameterAlreadyDeclared,
    ParameterNotDeclared,
    ParameterReadOnly,
    ParameterRefused,
    ParameterUninitialized,
)
from roslet.node.ros2 import parameters as services
from roslet.node.ros2 import qos as presets

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from roslet.compat.rclpy._network import RclpyNetwork


class Store(store.Parameters):
    """What refuses a value says so in rclpy's words."""

    def _refusal(self, name: str, reason: str) -> str:
        return reason

    def _unsuitable(self, parameter: store.Parameter, descriptor: store.Descriptor, setting: bool) -> str:
        reason = super()._unsuitable(parameter, descriptor, setting)
        if not reason:
            return ""
        name, value = parameter.name, parameter.value
        if setting and descriptor.read_only:
            return f"Trying to set a read-only parameter: {name}."
        if not descriptor.dynamic_typing and parameter.type != descriptor.type:
            if parameter.type == store.NOT_SET:
                return "Static parameter cannot be undeclared"
            return f"Wrong parameter type, expected '{descriptor.type}' got '{parameter.type}'"
        whole = parameter.type == store.INTEGER
        limits = descriptor.integer_range if whole else descriptor.floating_point_range
        assert limits is not None
        low, high, step = limits
        if not min(low, high) < value < max(low, high):
            stop = "." if whole else ""
            return f"Parameter {name} out of range{stop} Min: {low}, Max: {high}, value: {value}"
        close = "a valid step" if whole else "close enough to a valid step"
        return f"The parameter value for {name} is not {close}. Min: {low}, max: {high}, value: {value}, step: {step}"


class NodeParameters(services.NodeParameters):
    """`network.parameters`; the node gives it what publishes events, and a group for the services."""

    def __init__(self, network: RclpyNetwork, overrides: dict[str, Any], allow_undeclared: bool) -> None:
        self._network = network
        self._callbacks = {}
        self.store = Store(overrides, allow_undeclared, self._changed)
        self._events = None
        self._services = []

    def serve(self, group: Any) -> list[Requests]:
        """The services by which others reach them, for the node's executor."""
        network = self._network
        return [
            Requests(
                network.service(  # type: ignore[arg-type]
                    network.own_service(name),
                    message_class(f"rcl_interfaces/srv/{kind}"),
                    handler,
                    presets.PARAMETERS,
                ),
                group,
                None,
            )
            for name, kind, handler in self._handlers()
        ]


# -- between rclpy's values and the store's


def to_store(parameter: Parameter) -> store.Parameter:
    """Raises TypeError for a value that no parameter can have."""
    return store.Parameter(parameter.name, parameter.value, int(parameter.type_))


def from_store(parameter: store.Parameter) -> Parameter:
    value = parameter.value
    if parameter.type == store.BYTE_ARRAY:
        value = [bytes((one,)) for one in value]
    return Parameter(parameter.name, Parameter.Type(parameter.type), value)


def to_description(message: Any) -> store.Descriptor:
    """A ParameterDescriptor as the store has it."""

    def limits(ranges: Any) -> Any:
        return (ranges[0].from_value, ranges[0].to_value, ranges[0].step) if len(ranges) else None

    return store.Descriptor(
        message.name,
        message.type,
        message.description,
        message.additional_constraints,
        message.read_only,
        message.dynamic_typing,
        limits(message.floating_point_range),
        limits(message.integer_range),
    )


class ParametersOfNode:
    """The part of `rclpy.node.Node` that is parameters. Once the node is destroyed they can be asked for still; what
    changes them raises InvalidHandle."""

    _node_network: RclpyNetwork
    _node_set_callbacks: dict[tuple[str, Any], list[Callable[[Any], Any]]]

    def _node_check(self) -> None:
        raise NotImplementedError

    @property
    def _node_store(self) -> store.Parameters:
        return self._node_network.parameters.store

    # -- declaring

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: Any = None, ignore_override: bool = False
    ) -> Parameter:
        """Declare a parameter with a default, or with a type alone (`Parameter.Type`); returns it as it is then, with what
        arguments and overrides say unless `ignore_override`.

        Raises ParameterAlreadyDeclaredException, InvalidParameterException, InvalidParameterValueException,
        InvalidParameterTypeException.
        """
        return self.declare_parameters("", [(name, value, descriptor)], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Sequence[Sequence[Any]], ignore_override: bool = False
    ) -> list[Parameter]:
        """Declare several, each (name), (name, value) or (name, value, descriptor), within a namespace of parameters."""
        self._node_check()
        within = self._node_store
        found = []
        for given in parameters:
            if not 1 <= len(given) <= 3 or not isinstance(given[0], str):
                raise TypeError(f"expected (name, value, descriptor), not {given!r}")
            name, value, descriptor = (*given, None, None)[:3]
            full = f"{namespace}.{name}" if namespace else name
            if not name:
                raise InvalidParameterException(full)
            found.append((full, value, descriptor))
        known = [name for name, *_ in found if within.has(name)]
        if known:
            raise ParameterAlreadyDeclaredException(known)
        return [self._node_declare(within, *one, ignore_override) for one in found]

    def _node_declare(
        self, within: store.Parameters, name: str, value: Any, descriptor: Any, ignore_override: bool
    ) -> Parameter:
        described = to_description(descriptor) if descriptor is not None else store.Descriptor()
        kind = store.NOT_SET
        if isinstance(value, Parameter.Type):
            kind, value = int(value), None
        elif value is None:
            described = described.replace(dynamic_typing=True)
        else:
            kind = int(Parameter.Type.from_parameter_value(value))
            value = to_store(Parameter(name, value=value)).value
        if described.dynamic_typing:
            kind = store.NOT_SET
        try:
            return from_store(within.declare(name, value, kind, described, ignore_override))
        except ParameterAlreadyDeclared:
            raise ParameterAlreadyDeclaredException([name]) from None
        except ParameterRefused as error:
            given = within.overrides.get(name, value) if not ignore_override else value
            if error.wrong_type:
                wanted = Parameter.Type(kind or described.type).name
                raise InvalidParameterTypeException(Parameter(name, value=given), wanted) from None
            raise InvalidParameterValueException(name, given, error.reason) from None

    def undeclare_parameter(self, name: str) -> None:
        """Raises ParameterNotDeclaredException, ParameterImmutableException."""
        self._node_check()
        within = self._node_store
        if not within.has(name):
            raise ParameterNotDeclaredException(name)
        try:
            within.undeclare(name)
        except ParameterReadOnly:
            raise ParameterImmutableException(name) from None

    # -- asking

    def has_parameter(self, name: str) -> bool:
        """Whether it is declared."""
        return self._node_store.has(name)

    def get_parameter(self, name: str) -> Parameter:
        """Raises ParameterNotDeclaredException, ParameterUninitializedException."""
        try:
            return from_store(self._node_store.get(name))
        except ParameterUninitialized:
            raise ParameterUninitializedException(name) from None
        except ParameterNotDeclared:
            raise ParameterNotDeclaredException(name) from None

    def get_parameters(self, names: Sequence[str]) -> list[Parameter]:
        """Raises as `get_parameter`, TypeError where a name is no text."""
        if not all(isinstance(name, str) for name in names):
            raise TypeError("All names must be instances of type str")
        return [self.get_parameter(name) for name in names]

    def get_parameter_or(self, name: str, alternative_value: Parameter | None = None) -> Parameter:
        """The parameter, or the alternative where it is not declared or has no value."""
        within = self._node_store
        if within.get_or(name) is None:
            return Parameter(name) if alternative_value is None else alternative_value
        return self.get_parameter(name)

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, Parameter]:
        """Those below a prefix, by what follows it; NOT_SET where one has no value yet."""
        begin = prefix + "." if prefix else ""
        return {
            name[len(begin) :]: self.get_parameter_or(name)
            for name in self._node_store.names()
            if name.startswith(begin)
        }

    def get_parameter_type(self, name: str) -> int:
        """The number of its type. Raises ParameterNotDeclaredException."""
        try:
            return self._node_store.get_type(name)
        except ParameterNotDeclared:
            raise ParameterNotDeclaredException(name) from None

    def get_parameter_types(self, names: Sequence[str]) -> list[int]:
        """Raises ParameterNotDeclaredException."""
        return [self.get_parameter_type(name) for name in names]

    def list_parameters(self, prefixes: Sequence[str], depth: int) -> Any:
        """A ListParametersResult: those below any prefix, all where there is none, `depth` levels deep, 0 for all."""
        names, found = self._node_store.list_parameters(list(prefixes), depth)
        return message_class("rcl_interfaces/msg/ListParametersResult")(names=names, prefixes=found)

    def describe_parameter(self, name: str) -> Any:
        """A ParameterDescriptor. Raises ParameterNotDeclaredException."""
        try:
            return services.to_descriptor(self._node_store.describe(name))
        except ParameterNotDeclared:
            raise ParameterNotDeclaredException(name) from None

    def describe_parameters(self, names: Sequence[str]) -> list[Any]:
        """ParameterDescriptors. Raises ParameterNotDeclaredException."""
        return [self.describe_parameter(name) for name in names]

    # -- setting

    def set_parameters(self, parameter_list: Sequence[Parameter]) -> list[Any]:
        """Set each by itself; a SetParametersResult for each. Raises ParameterNotDeclaredException where one is not
        declared, TypeError for what is no Parameter."""
        _check_parameters(parameter_list)
        return [self._node_set([one]) for one in parameter_list]

    def set_parameters_atomically(self, parameter_list: Sequence[Parameter]) -> Any:
        """Set all or none; one SetParametersResult. Raises as `set_parameters`."""
        _check_parameters(parameter_list)
        return self._node_set(parameter_list)

    def _node_set(self, parameters: Sequence[Parameter]) -> Any:
        self._node_check()
        try:
            successful, reason = self._node_store.set_atomically([to_store(one) for one in parameters])
        except ParameterNotDeclared:
            within = self._node_store
            raise ParameterNotDeclaredException(
                [one.name for one in parameters if not within.has(one.name)]
            ) from None
        return message_class("rcl_interfaces/msg/SetParametersResult")(successful=successful, reason=reason)

    def set_descriptor(self, name: str, descriptor: Any, alternative_value: Any = None) -> Any:
        """Describe a parameter anew; its ParameterValue. `alternative_value`, a ParameterValue, is taken where the present
        one does not suit. Raises ParameterNotDeclaredException, ParameterImmutableException,
        InvalidParameterValueException."""
        self._node_check()
        otherwise = None if alternative_value is None else services.from_value(name, alternative_value).value
        try:
            return services.to_value(
                self._node_store.set_descriptor(name, to_description(descriptor), otherwise)
            )
        except ParameterNotDeclared:
            raise ParameterNotDeclaredException(name) from None
        except ParameterReadOnly:
            raise ParameterImmutableException(name) from None
        except ParameterRefused as error:
            raise InvalidParameterValueException(name, otherwise, error.reason) from None

    # -- callbacks

    def add_pre_set_parameters_callback(self, callback: Callable[[list[Parameter]], list[Parameter]]) -> None:
        """`callback(parameters)` gives those to be set in their place."""

        def before(parameters: list[store.Parameter]) -> list[store.Parameter]:
            return [to_store(one) for one in callback([from_store(one) for one in parameters])]

        self._node_store.add_pre_set(before)
        self._node_set_callbacks.setdefault(("pre", callback), []).append(before)

    def add_on_set_parameters_callback(self, callback: Callable[[list[Parameter]], Any]) -> None:
        """`callback(parameters)` gives a SetParametersResult: whether they may be set."""

        def check(parameters: list[store.Parameter]) -> tuple[bool, str]:
            result = callback([from_store(one) for one in parameters])
            return result.successful, result.reason

        self._node_store.add_on_set(check)
        self._node_set_callbacks.setdefault(("on", callback), []).append(check)

    def add_post_set_parameters_callback(self, callback: Callable[[list[Parameter]], None]) -> None:
        """`callback(parameters)` is told what has been set."""

        def after(parameters: list[store.Parameter]) -> None:
            callback([from_store(one) for one in parameters])

        self._node_store.add_post_set(after)
        self._node_set_callbacks.setdefault(("post", callback), []).append(after)

    def remove_pre_set_parameters_callback(self, callback: Callable[..., Any]) -> None:
        """Raises ValueError where it was not added."""
        self._node_store.remove_pre_set(self._node_callback("pre", callback))

    def remove_on_set_parameters_callback(self, callback: Callable[..., Any]) -> None:
        """Raises ValueError where it was not added."""
        self._node_store.remove_on_set(self._node_callback("on", callback))

    def remove_post_set_parameters_callback(self, callback: Callable[..., Any]) -> None:
        """Raises ValueError where it was not added."""
        self._node_store.remove_post_set(self._node_callback("post", callback))

    def _node_callback(self, when: str, callback: Any) -> Any:
        made = self._node_set_callbacks.get((when, callback))
        if not made:
            raise ValueError("Callback is not in list")
        return made.pop()


def _check_parameters(parameters: Sequence[Any]) -> None:
    for one in parameters:
        if not isinstance(one, Parameter):
            raise TypeError(f"expected a Parameter, not {type(one).__name__}")


__all__ = ["NodeParameters", "ParametersOfNode", "Store", "from_store", "to_description", "to_store"]
