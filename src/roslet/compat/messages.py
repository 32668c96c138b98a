"""What rospy programs expect of a message class, given to roslet's classes.

`dress()` gives the base class the methods of genpy's: `serialize(buffer)`, `deserialize(bytes)` that fills the message it is
called on, `str`. `adapt(cls)` gives one class genpy's constructor and class attributes. `simplify(cls)` makes the function
that turns a received message's arrays into what rospy delivers: tuples, and bytes for uint8 arrays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat.printing import message_text
from roslet.errors import InvalidMessage, MalformedMessage
from roslet.wire.arrays import TYPECODES
from roslet.wire.cursor import FIXED, SINGLE
from roslet.wire.message import Message, Service
from roslet.wire.time import Duration, Time

if TYPE_CHECKING:
    from collections.abc import Callable

    Simplifier = Callable[[Any], None]


class MessageException(Exception):
    """`genpy.MessageException`: a message cannot be filled from the values given."""


class SerializationError(MessageException):
    """`genpy.SerializationError`: a field holds what its type cannot."""


class DeserializationError(MessageException):
    """`genpy.DeserializationError`: the bytes are no message of the type."""


for _kind in (MessageException, SerializationError, DeserializationError):
    _kind.__module__ = "genpy.message"  # as a traceback shows it

_bare_serialize = Message.serialize


def _bare_deserialize(kind: type[Message], data: Any) -> Any:
    return kind.deserialize_from(memoryview(data), 0, len(data))


_dressed = False
_adapted: set[type] = set()
_simplifiers: dict[type, Simplifier | None] = {}
_numpy_simplifiers: dict[type, Simplifier | None] = {}


class _Deserialize:
    """`deserialize` of both worlds: called on a class it makes a message, called on a message it fills and returns it."""

    def __get__(self, instance: Message | None, owner: type[Message]) -> Callable[[Any], Any]:
        if instance is None:
            return lambda data: _bare_deserialize(owner, data)

        def fill(data: Any) -> Message:
            kind = type(instance)
            try:
                read = _bare_deserialize(kind, bytes(data))
            except MalformedMessage as error:
                raise DeserializationError(str(error)) from None
            tidy(kind, read)
            for row in kind._spec:
                setattr(instance, row[0], getattr(read, row[0]))
            return instance

        return fill


def _serialize(self: Message, buff: Any = None) -> bytes | None:
    """The message's bytes; with `buff`, a file-like object, they are written there instead."""
    if buff is None:
        return _bare_serialize(self)
    try:
        buff.write(_bare_serialize(self))
    except InvalidMessage as error:
        raise SerializationError(str(error)) from None
    return None


def _deserialize_numpy(self: Message, data: Any, _numpy: Any) -> Message:
    kind = type(self)
    read = _bare_deserialize(kind, bytes(data))
    for row in kind._spec:
        setattr(self, row[0], getattr(read, row[0]))
    return self


def _check_types(self: Message, exc: Exception | None = None) -> None:
    try:
        _bare_serialize(self)
    except InvalidMessage as error:
        raise SerializationError(str(error)) from None
    if exc is not None:
        raise SerializationError(str(exc))


def dress() -> None:
    """Give roslet's message, service and time classes what genpy's have. Doing it twice is allowed."""
    global _dressed
    if _dressed:
        return
    _dressed = True
    base: Any = Message
    base.serialize = _serialize
    base.deserialize = _Deserialize()
    base.serialize_numpy = lambda self, buff, _numpy: _serialize(self, buff)
    base.deserialize_numpy = _deserialize_numpy
    base.__str__ = message_text
    base.__repr__ = message_text
    base._check_types = _check_types
    base._get_types = lambda self: list(self._slot_types)
    for kind, name in ((Time, "Time"), (Duration, "Duration")):
        spoken: Any = kind
        spoken.__repr__ = lambda self, name=name: f"genpy.{name}[{self.to_nsec()}]"
        spoken._slot_types = ["int32", "int32"]


def adapt(kind: Any) -> Any:
    """Give a message or service class, and those it is made of, what genpy's have; returns it. Twice is allowed.

    A class of the program's own, made of a message class, has it from there.
    """
    if kind in _adapted:
        return kind
    _adapted.add(kind)
    dress()
    if issubclass(kind, Message) and "_spec" not in kind.__dict__:
        for base in kind.__bases__:
            if issubclass(base, Message):
                adapt(base)
    elif issubclass(kind, Service):
        kind._request_class = adapt(kind.Request)
        kind._response_class = adapt(kind.Response)
    elif issubclass(kind, Message):
        kind.__slots__ = list(kind.__slots__)  # genpy has a list; programs add to it or look for an index
        kind._slot_types = [text for _, text in kind._fields_and_types]
        for row in kind._spec:
            if not isinstance(row[1], str):
                adapt(row[1])
        kind.__init__ = _constructor(kind)
        # A generated class has its own of these two.
        kind.serialize = _serialize
        kind.deserialize = _Deserialize()
    return kind


def _constructor(kind: Any) -> Callable[..., None]:
    """genpy's constructor: every field by position, or some by name; None stands for a field's default."""
    names = [row[0] for row in kind._spec]
    numbers = [row[0] for row in kind._spec if row[2] == FIXED and row[1] in TYPECODES and row[1] != "uint8"]
    before = kind.__dict__["__init__"]
    made: list[Callable[..., None]] = []

    def original() -> Callable[..., None]:
        # The generated constructor stands there unmade; it is compiled at the first message, not at the import.
        made.append(before.make() if hasattr(before, "make") else before)
        return made[0]

    def __init__(self: Any, *args: Any, **kwds: Any) -> None:
        construct = made[0] if made else original()
        if not args and not kwds:
            construct(self)
            given: dict[str, Any] = {}
        elif args:
            if kwds:
                raise TypeError("Message constructor may only use args OR keywords, not both")
            if len(args) != len(names):
                raise TypeError(f"Invalid number of arguments, args should be {names} args are{args}")
            if all(value is not None for value in args):
                for name, value in zip(names, args, strict=True):
                    setattr(self, name, value)
                return
            given = dict(zip(names, args, strict=True))
        else:
            given = kwds
            for name in given:
                if name not in names:
                    raise AttributeError(f"{name} is not an attribute of {kind.__name__}")
        if given:
            given = {name: value for name, value in given.items() if value is not None}
            construct(self, **given)
        for name in numbers:
            if name not in given:
                setattr(self, name, getattr(self, name).tolist())

    return __init__


# -- what was received


def tidy(kind: type[Message], message: Message) -> None:
    """Turn the arrays of a received message into tuples and bytes, in place."""
    function = simplify(kind)
    if function is not None:
        function(message)


def simplify(kind: type[Message], numpy: bool = False) -> Simplifier | None:
    """The function that does what `tidy` does for messages of `kind`; None where there is nothing to do.

    With `numpy` numeric arrays become ndarrays, uint8 ones too, and only what rospy.numpy_msg leaves as it is does not.
    """
    cache = _numpy_simplifiers if numpy else _simplifiers
    if kind not in cache:
        cache[kind] = (
            None  # a type holds no type of its own kind; this ends what a broken table would loop on
        )
        cache[kind] = _make_simplifier(kind, numpy)
    return cache[kind]


def _make_simplifier(kind: type[Message], numpy: bool) -> Simplifier | None:
    direct: list[tuple[str, Callable[[Any], Any]]] = []
    nested: list[tuple[str, Simplifier]] = []
    lists: list[tuple[str, Simplifier]] = []
    for name, base, shape, _size, _bound in kind._spec:
        if isinstance(base, str):
            if shape != SINGLE and base in TYPECODES:
                direct.append((name, _array_converter(base, numpy)))
            continue
        inner = simplify(base, numpy)
        if inner is not None:
            (nested if shape == SINGLE else lists).append((name, inner))
    if not direct and not nested and not lists:
        return None

    def run(message: Any) -> None:
        for name, convert in direct:
            setattr(message, name, convert(getattr(message, name)))
        for name, inner in nested:
            inner(getattr(message, name))
        for name, inner in lists:
            for element in getattr(message, name):
                inner(element)

    return run


def _array_converter(primitive: str, numpy: bool) -> Callable[[Any], Any]:
    if numpy:
        import numpy as np

        if primitive == "uint8":
            return lambda value: np.frombuffer(value, np.uint8)
        return np.asarray
    if primitive == "uint8":
        return bytes
    if primitive == "bool":
        return lambda value: value.tolist() if hasattr(value, "tolist") else list(value)
    return lambda value: tuple(value.tolist() if hasattr(value, "tolist") else value)
