"""What a definition is: immutable records, the same for both dialects. No I/O, no parsing.

Written by hand on `roslet.record.Record` because `dataclasses` and `typing` would cost more to import than
everything else this room does before the first message. Treat every record as immutable.
"""

from __future__ import annotations

from roslet.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Literal, TypeAlias

    Dialect: TypeAlias = Literal["ros1", "ros2"]
    Kind: TypeAlias = Literal["msg", "srv", "action"]
    Value: TypeAlias = bool | int | float | str | tuple["Value", ...]
else:
    Dialect = Kind = str
    Value = object

ROS1: Dialect = "ros1"
ROS2: Dialect = "ros2"


class TypeName(Record):
    """A full interface name. `std_msgs/msg/String` in ROS 2; ROS 1 writes the same `std_msgs/String`.

    Ordered by package, kind and name.
    """

    __slots__ = ("kind", "name", "package")
    _fields = ("package", "kind", "name")

    def __init__(self, package: str, kind: Kind, name: str) -> None:
        self.package = package
        self.kind: Kind = kind
        self.name = name

    def text(self, dialect: Dialect) -> str:
        """The dialect's spelling: `pkg/Name` in ROS 1, `pkg/kind/Name` in ROS 2."""
        if dialect == "ros1":
            return self.package + "/" + self.name
        return self.package + "/" + self.kind + "/" + self.name

    def __str__(self) -> str:
        return self.package + "/" + self.kind + "/" + self.name

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, TypeName)
            and self.name == other.name
            and self.package == other.package
            and self.kind == other.kind
        )

    def __hash__(self) -> int:
        return hash((self.package, self.kind, self.name))

    def __lt__(self, other: TypeName) -> bool:
        return (self.package, self.kind, self.name) < (other.package, other.kind, other.name)

    def __le__(self, other: TypeName) -> bool:
        return not other < self

    def __gt__(self, other: TypeName) -> bool:
        return other < self

    def __ge__(self, other: TypeName) -> bool:
        return not self < other


class Array(Record):
    """`kind` fixed: exactly `size` elements; bounded: at most `size`; unbounded: `size` is None.

    A ROS 1 fixed array may have size 0; every other size is at least 1 and fits 32 bits unsigned.
    """

    __slots__ = ("kind", "size")
    _fields = ("kind", "size")

    def __init__(self, kind: Literal["fixed", "bounded", "unbounded"], size: int | None = None) -> None:
        self.kind: Literal["fixed", "bounded", "unbounded"] = kind
        self.size = size


class FieldType(Record):
    """One field's type: a primitive or another message, and perhaps an array of it.

    `primitive` is canonical: bool int8 uint8 int16 uint16 int32 uint32 int64 uint64 float32 float64 string
    wstring time duration (the last two in ROS 1 only). `char` and `byte` become uint8/int8 as the dialect
    defines (ROS 1: char is uint8, byte is int8; ROS 2: both are uint8) and stay visible in `spelled`, which
    is the base type exactly as the definition wrote it (without array or bound). `message` is the full name
    of a nested type where `primitive` is None.
    """

    __slots__ = ("array", "message", "primitive", "spelled", "string_bound")
    _fields = ("primitive", "message", "spelled", "string_bound", "array")

    def __init__(
        self,
        primitive: str | None,
        message: TypeName | None,
        spelled: str,
        string_bound: int | None = None,
        array: Array | None = None,
    ) -> None:
        self.primitive = primitive
        self.message = message
        self.spelled = spelled
        self.string_bound = string_bound
        self.array = array

    def __str__(self) -> str:
        """As a definition spells it: `string<=5[<=3]`, `geometry_msgs/Pose[36]`."""
        text = self.spelled
        if self.string_bound is not None:
            text = f"{text}<={self.string_bound}"
        if self.array is None:
            return text
        if self.array.size is None:
            return text + "[]"
        return f"{text}[{'<=' if self.array.kind == 'bounded' else ''}{self.array.size}]"


class Field(Record):
    """A field. `default` is None where the definition gives none; the defaults of an array are a tuple.

    `line` counts from 1 in the file that holds the definition; 0 for a field that no file spells. It is no
    part of what makes two fields equal.
    """

    __slots__ = ("default", "line", "name", "type")
    _fields = ("name", "type", "default", "line")

    def __init__(self, name: str, type: FieldType, default: Value | None = None, line: int = 0) -> None:  # noqa: A002
        self.name = name
        self.type = type
        self.default = default
        self.line = line

    def __eq__(self, other: object) -> bool:
        return type(other) is Field and self._values()[:-1] == other._values()[:-1]

    def __hash__(self) -> int:
        return hash((self.name, self.type, self.default))


class Constant(Record):
    """A constant. `text` is the value's text as the dialect keeps it (ROS 1 hashes it); `line` as in
    `Field`."""

    __slots__ = ("line", "name", "text", "type", "value")
    _fields = ("name", "type", "value", "text", "line")

    def __init__(self, name: str, type: FieldType, value: Value, text: str, line: int = 0) -> None:  # noqa: A002
        self.name = name
        self.type = type
        self.value = value
        self.text = text
        self.line = line

    def __eq__(self, other: object) -> bool:
        return type(other) is Constant and self._values()[:-1] == other._values()[:-1]

    def __hash__(self) -> int:
        return hash((self.name, self.type, self.value, self.text))


class _Interface(Record):
    """What the three kinds share: the source `text` and `file` come last and are no part of equality."""

    __slots__ = ()

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and self._values()[:-2] == other._values()[:-2]

    def __hash__(self) -> int:
        return hash(self._values()[:-2])


class Message(_Interface):
    """A message: what one .msg file holds, or one part of a .srv or .action.

    `text` is the part's source text exactly as the dialect's tools cut it, `file` where it stands.
    """

    __slots__ = ("constants", "dialect", "fields", "file", "name", "text")
    _fields = ("name", "dialect", "fields", "constants", "text", "file")

    def __init__(
        self,
        name: TypeName,
        dialect: Dialect,
        fields: tuple[Field, ...],
        constants: tuple[Constant, ...],
        text: str = "",
        file: str = "",
    ) -> None:
        self.name = name
        self.dialect: Dialect = dialect
        self.fields = fields
        self.constants = constants
        self.text = text
        self.file = file


class Service(_Interface):
    """A service. The parts are named `Name_Request`, `Name_Response` in ROS 2 and `NameRequest`,
    `NameResponse` in ROS 1, of kind srv (of kind action for the services an action derives). `event` exists
    in ROS 2 only."""

    __slots__ = ("dialect", "event", "file", "name", "request", "response", "text")
    _fields = ("name", "dialect", "request", "response", "event", "text", "file")

    def __init__(
        self,
        name: TypeName,
        dialect: Dialect,
        request: Message,
        response: Message,
        event: Message | None = None,
        text: str = "",
        file: str = "",
    ) -> None:
        self.name = name
        self.dialect: Dialect = dialect
        self.request = request
        self.response = response
        self.event = event
        self.text = text
        self.file = file


class Action(_Interface):
    """An action. ROS 2 derives SendGoal and GetResult services and a FeedbackMessage; ROS 1 derives seven
    messages (`NameAction`, `NameActionGoal`, ..., of kind msg). All that is derived stands in `services` and
    `messages`."""

    __slots__ = ("dialect", "feedback", "file", "goal", "messages", "name", "result", "services", "text")
    _fields = ("name", "dialect", "goal", "result", "feedback", "services", "messages", "text", "file")

    def __init__(
        self,
        name: TypeName,
        dialect: Dialect,
        goal: Message,
        result: Message,
        feedback: Message,
        services: tuple[Service, ...] = (),
        messages: tuple[Message, ...] = (),
        text: str = "",
        file: str = "",
    ) -> None:
        self.name = name
        self.dialect: Dialect = dialect
        self.goal = goal
        self.result = result
        self.feedback = feedback
        self.services = services
        self.messages = messages
        self.text = text
        self.file = file


if TYPE_CHECKING:
    Interface: TypeAlias = Message | Service | Action
else:
    Interface = _Interface
