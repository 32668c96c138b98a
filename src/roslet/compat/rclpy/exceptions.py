"""`rclpy.exceptions`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from roslet.compat.rclpy.parameter import Parameter


class NotInitializedException(Exception):
    """rclpy is used before `rclpy.init()`."""

    def __init__(self, message: str | None = None) -> None:
        more = f" msg:{message}" if message else ""
        super().__init__(f"rclpy.init() has not been called.{more}")


class NoTypeSupportImportedException(Exception):
    """A class is no generated one."""

    def __init__(self) -> None:
        super().__init__("no type_support imported")


class RCLError(RuntimeError):
    """What the real client library could not do."""


class RMWError(RuntimeError):
    """What the real middleware could not do."""


class UnknownROSArgsError(RuntimeError):
    """Among the arguments after --ros-args is one that means nothing."""


class InvalidHandle(RuntimeError):
    """Something is used that was destroyed."""

    def __init__(self, message: str = "cannot use Destroyable because destruction was requested") -> None:
        super().__init__(message)


class TimerCancelledError(RCLError):
    """A cancelled timer was called."""


class NodeNameNonExistentError(RCLError):
    """The graph knows no such node."""


class NameValidationException(Exception):
    """A name is not valid; the message points at the character."""

    def __init__(self, name_type: str, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__(f"Invalid {name_type}: {error_msg}:\n  '{name}'\n   {' ' * invalid_index}^")


class InvalidNamespaceException(NameValidationException):
    """A namespace is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("namespace", name, error_msg, invalid_index)


class InvalidNodeNameException(NameValidationException):
    """A node's name is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("node name", name, error_msg, invalid_index)


class InvalidTopicNameException(NameValidationException):
    """A topic's name is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("topic name", name, error_msg, invalid_index)


class InvalidServiceNameException(NameValidationException):
    """A service's name is not valid."""

    def __init__(self, name: str, error_msg: str, invalid_index: int) -> None:
        super().__init__("service name", name, error_msg, invalid_index)


class ParameterException(Exception):
    """The base of what goes wrong with parameters."""

    def __init__(self, error_msg: str, parameters: object) -> None:
        super().__init__(f"{error_msg}: {parameters}")


class ParameterNotDeclaredException(ParameterException):
    """No such parameter was declared."""

    def __init__(self, parameters: object) -> None:
        super().__init__("Invalid access to undeclared parameter(s)", parameters)


class ParameterAlreadyDeclaredException(ParameterException):
    """The parameter was declared before."""

    def __init__(self, parameters: object) -> None:
        super().__init__("Parameter(s) already declared", parameters)


class InvalidParameterException(ParameterException):
    """The name of a parameter is not valid."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__("Invalid parameter name", parameter_name)


class InvalidParameterTypeException(ParameterException):
    """A parameter's value is of another type than it was declared with."""

    def __init__(self, desired_parameter: Parameter, expected_type: str) -> None:
        value: Any = desired_parameter.value
        found = type(desired_parameter).Type.from_parameter_value(value).name
        name = desired_parameter.name
        super().__init__(
            f"Trying to set parameter '{name}' to '{value}' of type '{found}', expecting type '{expected_type}'",
            name,
        )


class InvalidParameterValueException(ParameterException):
    """A parameter's value was refused, by a callback or by its descriptor."""

    def __init__(self, parameter: str, value: object, reason: str) -> None:
        super().__init__(f"Invalid parameter value ({value}) for parameter. Reason: {reason}", parameter)


class ParameterImmutableException(ParameterException):
    """A read-only parameter was to be changed."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__("Attempted to modify read-only parameter", parameter_name)


class ParameterUninitializedException(ParameterException):
    """A parameter was declared with a type only, and has no value yet."""

    def __init__(self, parameter_name: str) -> None:
        super().__init__(f"The parameter '{parameter_name}' is not initialized", parameter_name)


class ROSInterruptException(Exception):
    """The end of the context interrupted what was under way."""

    def __init__(self) -> None:
        super().__init__("rclpy.shutdown() has been called")


__all__ = [
    "InvalidHandle",
    "InvalidNamespaceException",
    "InvalidNodeNameException",
    "InvalidParameterException",
    "InvalidParameterTypeException",
    "InvalidParameterValueException",
    "InvalidServiceNameException",
    "InvalidTopicNameException",
    "NameValidationException",
    "NoTypeSupportImportedException",
    "NodeNameNonExistentError",
    "NotInitializedException",
    "ParameterAlreadyDeclaredException",
    "ParameterException",
    "ParameterImmutableException",
    "ParameterNotDeclaredException",
    "ParameterUninitializedException",
    "RCLError",
    "RMWError",
    "ROSInterruptException",
    "TimerCancelledError",
    "UnknownROSArgsError",
]
