"""`rclpy.parameter`: a parameter with its type, as a message, out of text and out of files."""

from __future__ import annotations

import array
from enum import IntEnum
from types import GenericAlias
from typing import TYPE_CHECKING, Any

from roslet.compat.interfaces import message_class

if TYPE_CHECKING:
    from collections.abc import Sequence

PARAMETER_SEPARATOR_STRING = "."

# rcl_interfaces/msg/ParameterType, and the field of ParameterValue that holds each.
_FIELDS = (
    "",
    "bool_value",
    "integer_value",
    "double_value",
    "string_value",
    "byte_array_value",
    "bool_array_value",
    "integer_array_value",
    "double_array_value",
    "string_array_value",
)
# Exactly these types of Python, one at a time and in lists. A bool is no integer.
_SINGLE: dict[type, int] = {bool: 1, int: 2, float: 3, str: 4}
_LISTS: dict[type, int] = {bytes: 5, bool: 6, int: 7, float: 8, str: 9}
_CODES = {"q": 7, "d": 8}


class _Type(IntEnum):
    """The types that a parameter has, numbered as rcl_interfaces/msg/ParameterType."""

    NOT_SET = 0
    BOOL = 1
    INTEGER = 2
    DOUBLE = 3
    STRING = 4
    BYTE_ARRAY = 5
    BOOL_ARRAY = 6
    INTEGER_ARRAY = 7
    DOUBLE_ARRAY = 8
    STRING_ARRAY = 9

    @classmethod
    def from_parameter_value(cls, parameter_value: Any) -> _Type:
        """The type of a value of Python. An empty list counts as bytes. Raises TypeError where no parameter can have it."""
        if parameter_value is None:
            return cls.NOT_SET
        single = _SINGLE.get(type(parameter_value))
        if single is not None:
            return cls(single)
        if isinstance(parameter_value, array.array) and parameter_value.typecode in _CODES:
            return cls(_CODES[parameter_value.typecode])
        if not isinstance(parameter_value, (list, tuple, array.array)):
            raise TypeError(f"The given value is not one of the allowed types '{parameter_value}'.")
        if not parameter_value:
            return cls.BYTE_ARRAY
        for kind, number in _LISTS.items():
            if all(isinstance(one, kind) for one in parameter_value):
                return cls(number)
        raise TypeError(f"The given value is not a list of one of the allowed types '{parameter_value}'.")

    def check(self, parameter_value: Any) -> bool:
        """Whether a value has this type."""
        if self in (_Type.NOT_SET, _Type.BOOL, _Type.INTEGER, _Type.DOUBLE, _Type.STRING):
            return _Type.from_parameter_value(parameter_value) is self
        if not isinstance(parameter_value, (list, tuple, array.array)):
            return False
        return not parameter_value or _Type.from_parameter_value(parameter_value) is self

    def __str__(self) -> str:
        return str(self.value)

    def __format__(self, format_spec: str) -> str:
        return format(int(self), format_spec)


class Parameter:
    """A name, a type and a value; the value gives the type where none is given. Raises ValueError where they disagree."""

    # Programs annotate with `Parameter[...]`, and Python evaluates that.
    __class_getitem__: Any = classmethod(GenericAlias)

    Type = _Type

    def __init__(self, name: str, type_: _Type | None = None, value: Any = None) -> None:
        if type_ is None:
            type_ = _Type.from_parameter_value(value)
        if not isinstance(type_, _Type):
            raise TypeError("type must be an instance of `Parameter.Type`")
        if not type_.check(value):
            raise ValueError(f"Type '{type_}' and value '{value}' do not agree")
        self._name = name
        self._type = type_
        self._value = value

    @classmethod
    def from_parameter_msg(cls, param_msg: Any) -> Parameter:
        """From a rcl_interfaces/msg/Parameter."""
        value = param_msg.value
        return cls(param_msg.name, _Type(value.type), parameter_value_to_python(value))

    @property
    def name(self) -> str:
        return self._name

    @property
    def type_(self) -> _Type:
        return self._type

    @property
    def value(self) -> Any:
        return self._value

    def get_parameter_value(self) -> Any:
        """The value as a rcl_interfaces/msg/ParameterValue."""
        return _value_message(self._type, self._value)

    def to_parameter_msg(self) -> Any:
        """The whole as a rcl_interfaces/msg/Parameter."""
        made = message_class("rcl_interfaces/msg/Parameter")
        return made(name=self._name, value=self.get_parameter_value())


def _value_message(kind: int, value: Any) -> Any:
    made = message_class("rcl_interfaces/msg/ParameterValue")(type=int(kind))
    if kind:
        setattr(made, _FIELDS[kind], list(value) if kind >= _Type.BYTE_ARRAY else value)
    return made


def get_parameter_value(string_value: str) -> Any:
    """The rcl_interfaces/msg/ParameterValue that a text means as YAML; the text itself where that is no parameter."""
    from roslet.node.values import parse_value

    try:
        value = parse_value(string_value)
        kind = _Type.from_parameter_value(value)
    except (TypeError, ValueError):
        value, kind = string_value, _Type.STRING
    if kind is _Type.NOT_SET:
        value, kind = string_value, _Type.STRING
    return _value_message(kind, value)


def parameter_value_to_python(parameter_value: Any) -> Any:
    """The value in a rcl_interfaces/msg/ParameterValue; None where it is not set. Raises RuntimeError for no type."""
    kind = parameter_value.type
    if not 0 <= kind < len(_FIELDS):
        raise RuntimeError(f"unexpected parameter type {kind}")
    return getattr(parameter_value, _FIELDS[kind]) if kind else None


def parameter_dict_from_yaml_file(
    parameter_file: str,
    use_wildcard: bool = False,
    target_nodes: Sequence[str] | None = None,
    namespace: str = "",
) -> dict[str, Any]:
    """The parameters of a file, by name, as rcl_interfaces/msg/Parameter.

    use_wildcard   those under `/**` too; a node's own come before them
    target_nodes   full names of the nodes whose parameters are meant; None: all of the file
    namespace      put before each name

    Raises RuntimeError where the file has none for a node of `target_nodes`, or is no file of parameters.
    """
    from roslet.errors import InvalidName
    from roslet.node.ros2.parameter_files import read_file

    try:
        read = read_file(parameter_file)
    except InvalidName as error:
        raise RuntimeError(str(error)) from None
    sections: dict[str, dict[str, Any]] = {}
    for pattern, values in read:
        sections.setdefault(pattern if pattern.startswith("/") else "/" + pattern, {}).update(values)
    found: dict[str, Any] = {}
    if use_wildcard and "/**" in sections:
        found.update(sections["/**"])
    wanted = [name for name in sections if name != "/**"] if target_nodes is None else list(target_nodes)
    for name in wanted:
        section = sections.get(name if name.startswith("/") else "/" + name)
        if section is None:
            if use_wildcard and "/**" in sections:
                continue
            raise RuntimeError(
                f"Param file does not contain parameters for {name}, only for nodes: {list(sections)}"
            )
        found.update(section)
    prefix = namespace + PARAMETER_SEPARATOR_STRING if namespace else ""
    return {
        prefix + name: Parameter(prefix + name, value=value).to_parameter_msg()
        for name, value in found.items()
    }


__all__ = [
    "PARAMETER_SEPARATOR_STRING",
    "Parameter",
    "get_parameter_value",
    "parameter_dict_from_yaml_file",
    "parameter_value_to_python",
]
