"""What rclpy programs expect of message, service and action classes, given to roslet's ROS 2 classes.

`adapt(cls)` gives one class what rosidl's generator gives: a constructor by keywords alone, `package.msg.Name(field=...)` as
text, `get_fields_and_field_types`, `SLOT_TYPES`, and fields of numbers that are `array.array` (sequences) or numpy arrays of
their type (arrays), whatever is assigned to them. `message_class(name)` is an adapted class by name.
"""

from __future__ import annotations

import array
import os
from typing import TYPE_CHECKING, Any

from roslet.wire.arrays import TYPECODES
from roslet.wire.cursor import BOUNDED, FIXED, SINGLE, UNBOUNDED
from roslet.wire.message import Action, Message, Service

if TYPE_CHECKING:
    from collections.abc import Callable

_adapted: set[type] = set()

# Whether constructors refuse keywords that name no field, which rosidl's ignore unless this is set or `check_fields` given.
_CHECK_FIELDS = os.environ.get("ROS_PYTHON_CHECK_FIELDS") == "1"

# What rosidl calls the primitives that its definitions call otherwise.
_SPELLINGS = {"float32": "float", "float64": "double", "bool": "boolean", "byte": "octet", "char": "uint8"}


def message_class(name: str) -> Any:
    """The adapted class of a ROS 2 message, service or action: `pkg/msg/Name`. Raises UnknownType, DefinitionError."""
    from roslet.gen.runtime import interface_class

    return adapt(interface_class("ros2", name))


def adapt(kind: Any) -> Any:
    """Give a class, and those it is made of, what rosidl's have; returns it. Twice is allowed."""
    if kind in _adapted:
        return kind
    _adapted.add(kind)
    if issubclass(kind, Message):
        _adapt_message(kind)
    elif issubclass(kind, (Service, Action)):
        kind.__new__ = _refuse(kind)
        for value in list(vars(kind).values()):
            if isinstance(value, type) and issubclass(value, (Message, Service)):
                adapt(value)
        if issubclass(kind, Action):
            _adapt_action(kind)
    return kind


def _refuse(kind: Any) -> Any:
    what = "Service" if issubclass(kind, Service) else "Action"

    def __new__(cls: type, *_: Any, **__: Any) -> Any:
        raise NotImplementedError(f"{what} classes can not be instantiated")

    return __new__


def _adapt_action(kind: Any) -> None:
    """The parts that rclpy looks for under `Impl`."""
    kind.Impl = type(
        "Impl",
        (),
        {
            "SendGoalService": kind.SendGoal,
            "GetResultService": kind.GetResult,
            "FeedbackMessage": kind.FeedbackMessage,
            "CancelGoalService": message_class("action_msgs/srv/CancelGoal"),
            "GoalStatusMessage": message_class("action_msgs/msg/GoalStatusArray"),
        },
    )


def _adapt_message(kind: Any) -> None:
    fields = {name: _spelled(text) for name, text in kind._fields_and_types}
    octets = {name for name, text in kind._fields_and_types if text.startswith("byte[")}
    package, part, name = kind._type.split("/")
    for row in kind._spec:
        if not isinstance(row[1], str):
            adapt(row[1])
        convert = Octets if row[0] in octets else _converter(row)
        if convert is not None:
            setattr(kind, row[0], _Converted(getattr(kind, row[0]), convert))
    kind.__init__ = _constructor(kind)
    kind.__repr__ = _printer(kind, f"{package}.{part}.{name}")
    kind.get_fields_and_field_types = classmethod(lambda cls: dict(fields))
    kind.SLOT_TYPES = tuple(fields.values())
    kind._fields_and_field_types = fields


def _spelled(text: str) -> str:
    """A field's type as rosidl spells it: `sequence<uint8>`, `double[36]`, `std_msgs/Header`."""
    base, bracket, size = text.partition("[")
    name, bound, limit = base.partition("<=")
    if "/" in name:
        package, _, last = name.partition("/")
        name = package + "/" + last.rpartition("/")[2]
    name = _SPELLINGS.get(name, name)
    if bound:
        name = f"{name}<{limit}>"
    if not bracket:
        return name
    size = size.rstrip("]")
    if not size:
        return f"sequence<{name}>"
    if size.startswith("<="):
        return f"sequence<{name}, {size[2:]}>"
    return f"{name}[{size}]"


class _Converted:
    """A field whose values are converted when they are assigned; stands in front of the slot that holds them."""

    def __init__(self, slot: Any, convert: Callable[[Any], Any]) -> None:
        self._read = slot.__get__
        self._write = slot.__set__
        self._convert = convert

    def __get__(self, instance: Any, owner: Any) -> Any:
        return self if instance is None else self._read(instance, owner)

    def __set__(self, instance: Any, value: Any) -> None:
        self._write(instance, self._convert(value))


def _converter(row: Any) -> Callable[[Any], Any] | None:
    _, base, shape, _, _ = row
    if not isinstance(base, str) or shape == SINGLE or base not in TYPECODES or base == "bool":
        return None
    if shape in (BOUNDED, UNBOUNDED):
        return _to_array(TYPECODES[base])
    assert shape == FIXED
    try:
        import numpy
    except ImportError:
        return _to_array(TYPECODES[base])
    kind = numpy.dtype(base)

    def to_numpy(value: Any) -> Any:
        if isinstance(value, (bytes, bytearray)):
            return numpy.frombuffer(value, kind).copy()
        return numpy.array(value, dtype=kind)

    return to_numpy


class Octets(array.array):  # type: ignore[type-arg]
    """Several of type `byte`: to programs a list of bytes of one octet each, as rosidl has it; to the serialiser, octets."""

    def __new__(cls, value: Any = b"") -> Any:
        if not isinstance(value, (bytes, bytearray, memoryview)):
            value = bytes(value) if hasattr(value, "dtype") else b"".join(value)
        return super().__new__(cls, "B", bytes(value))

    def __getitem__(self, index: Any) -> Any:
        found = super().__getitem__(index)
        return Octets(found.tobytes()) if isinstance(index, slice) else bytes((found,))

    def __setitem__(self, index: Any, value: Any) -> None:
        super().__setitem__(index, Octets(value) if isinstance(index, slice) else value[0])

    def __iter__(self) -> Any:
        return (bytes((one,)) for one in self.tobytes())

    def __eq__(self, other: object) -> bool:
        return list(self) == list(other) if isinstance(other, (list, tuple, Octets)) else NotImplemented

    __hash__ = None

    def __repr__(self) -> str:
        return repr(list(self))

    def append(self, value: Any) -> None:
        super().append(value[0])

    def extend(self, values: Any) -> None:
        super().extend(Octets(values))


def _to_array(code: str) -> Callable[[Any], array.array[Any]]:
    make = array.array

    def convert(value: Any) -> array.array[Any]:
        if isinstance(value, make) and value.typecode == code:
            return value
        if hasattr(value, "tobytes") and not isinstance(value, make):
            view = memoryview(value)
            if view.format.lstrip("<=@") == code:
                return make(code, view.tobytes())
        return make(code, value)

    return convert


def _constructor(kind: Any) -> Callable[..., None]:
    names = frozenset(row[0] for row in kind._spec)
    before = kind.__dict__["__init__"]
    made: list[Callable[..., None]] = []

    def __init__(self: Any, **kwargs: Any) -> None:
        if not made:
            # The generated constructor is compiled at the first message, not at the import.
            made.append(before.make() if hasattr(before, "make") else before)
        if not kwargs.keys() <= names:
            checked = kwargs.pop("check_fields", _CHECK_FIELDS)
            unknown = sorted(kwargs.keys() - names)
            if checked and unknown:
                raise AssertionError(f"Invalid arguments passed to constructor: {', '.join(unknown)}")
            kwargs = {name: value for name, value in kwargs.items() if name in names}
        made[0](self, **kwargs)

    # An error names what was called as Python names it.
    __init__.__qualname__ = kind.__qualname__ + ".__init__"
    return __init__


def _printer(kind: Any, name: str) -> Callable[[Any], str]:
    fields = [row[0] for row in kind._spec]

    def __repr__(self: Any) -> str:
        inside = ", ".join(f"{field}={_shown(getattr(self, field))}" for field in fields)
        return f"{name}({inside})"

    return __repr__


def _shown(value: Any) -> str:
    if isinstance(value, array.array) and not isinstance(value, Octets):
        return repr(value.tolist())
    return repr(value)


__all__ = ["adapt", "message_class"]
