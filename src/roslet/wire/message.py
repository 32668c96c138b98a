"""The base of every generated message class, and what generated code falls back on. Runs on MicroPython."""

from roslet.errors import RosletError
from roslet.wire import cdr, ros1
from roslet.wire.arrays import TYPECODES
from roslet.wire.cursor import SINGLE
from roslet.wire.primitives import CPYTHON

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any, ClassVar, TypeAlias

    from typing_extensions import Self

    Bytes: TypeAlias = bytes | bytearray | memoryview

GATHER_MINIMUM = 16384
"""Bytes from which a payload is handed out for a gathering send instead of being copied."""

_SCRATCH = 8192
_MAX_SCRATCHES = 8
_scratches: "list[memoryview]" = []

# A view's own method is quicker than the constructor of bytes; MicroPython has only the latter.
_take: "Callable[[memoryview], bytes]" = memoryview.tobytes if hasattr(memoryview, "tobytes") else bytes


def _joined(scratch: memoryview, end: int, parts: "list[tuple[int, Any]]") -> bytes:
    """The bytes of a gathered message."""
    pieces: list[Any] = []
    done = 0
    for offset, payload in parts:
        pieces.append(scratch[done:offset])
        pieces.append(payload)
        done = offset
    pieces.append(scratch[done:end])
    return b"".join(pieces)


class BufferTooSmall(RosletError):
    """The buffer given to `serialize_into` ends too early. `size` is the message's serialised size in
    bytes."""

    def __init__(self, size: int) -> None:
        super().__init__("the message needs %d bytes" % size)
        self.size = size


class Message:
    """A message of one type of one dialect.

    A generated class has its fields as slots, the definition's constants as class attributes, and the
    attributes below. Arrays of a received message may be views on the buffer it was read from (`_views`):
    valid as long as they are held, but only as long as the owner of the buffer does not reuse it; `copy()`
    takes the message out of it.

    Field names that are Python keywords, or names of the methods here, have a trailing underscore.

    On MicroPython `struct` keeps the low bits of a single integer that is out of range where CPython raises; arrays
    are checked on both.
    """

    __slots__ = ("_connection_header",)  # no field: what a rospy program is told of where a message came from

    _type: "ClassVar[str]" = ""
    """The type's name as the dialect spells it."""
    _encoding: "ClassVar[str]" = "ros1"
    """"ros1" or "cdr"."""
    _spec: "ClassVar[Any]" = ()
    """The field table, see `roslet.wire.cursor`."""
    _fields_and_types: "ClassVar[tuple[tuple[str, str], ...]]" = ()
    """Every field's name (as the definition has it) and its type as the definition spells it."""
    _views: "ClassVar[bool]" = False
    _fixed_size: "ClassVar[int | None]" = None
    """Bytes of every serialised message of the type, if they are all of one size; with CDR's encapsulation
    header."""
    _minimum_size: "ClassVar[int]" = 0
    _maximum_size: "ClassVar[int | None]" = None
    _md5sum: "ClassVar[str]" = ""
    _full_text: "ClassVar[str]" = ""
    _has_header: "ClassVar[bool]" = False
    _type_hash: "ClassVar[str]" = ""

    def serialize_into(
        self, buffer: "bytearray | memoryview", offset: int = 0, parts: "list[tuple[int, Any]] | None" = None
    ) -> int:
        """Write the message (in CDR: the encapsulation header and the body) from `offset`; the offset after
        it.

        `parts`, if given, is an empty list: payloads of at least GATHER_MINIMUM bytes are then appended to it
        as (offset in `buffer` before which the payload belongs, bytes-like) instead of being copied, and the
        offset returned is that of the rest. Raises InvalidMessage for a value that its field cannot hold,
        BufferTooSmall if the buffer is; what the buffer then holds from `offset` on is unspecified.
        """
        raise NotImplementedError

    @classmethod
    def deserialize_from(cls, buffer: "Any", start: int, end: int) -> "Self":
        """The message that takes all of buffer[start:end]; `buffer` is a memoryview of bytes. In CDR bytes
        after the body are ignored.

        Raises MalformedMessage (offset from `start`, value path), having allocated no more than the input
        justifies.
        """
        raise NotImplementedError

    def serialized_size(self) -> int:
        """The number of bytes that `serialize` returns. Raises InvalidMessage."""
        size = self._fixed_size
        if size is not None:
            return size
        return cdr.size(self) if self._encoding == "cdr" else ros1.size(self)

    def serialize(self) -> bytes:
        """The message's bytes. Raises InvalidMessage."""
        # Taking a scratch buffer off the list is atomic: each thread has its own.
        try:
            scratch = _scratches.pop()
        except IndexError:
            scratch = memoryview(bytearray(_SCRATCH))
        parts: list[tuple[int, Any]] = []
        try:
            end = self.serialize_into(scratch, 0, parts)
        except BufferTooSmall as error:
            large = bytearray(error.size)
            return bytes(memoryview(large)[: self.serialize_into(large)])
        data = _joined(scratch, end, parts) if parts else _take(scratch[:end])
        if len(_scratches) < _MAX_SCRATCHES:
            _scratches.append(scratch)
        return data

    @classmethod
    def deserialize(cls, buffer: "Any") -> "Self":
        """The message that takes all of `buffer`, any bytes-like object. Raises MalformedMessage."""
        return deserialize_any(cls, buffer)  # type: ignore[no-any-return]

    def copy(self) -> "Self":
        """A deep copy, whose arrays and bytes have memory of their own."""
        made = object.__new__(type(self))
        for attribute, base, kind, _size, _bound in self._spec:
            setattr(made, attribute, _copied(getattr(self, attribute), base, kind))
        return made

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Message) or other._spec is not self._spec:
            return NotImplemented
        for field in self._spec:
            attribute = field[0]
            if not same(getattr(self, attribute), getattr(other, attribute)):
                return False
        return True

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        inside = ", ".join(["%s=%r" % (field[0], getattr(self, field[0], None)) for field in self._spec])
        return "%s(%s)" % (type(self).__name__, inside)


class Stamp(Message):
    """The base of builtin_interfaces/Time and Duration of ROS 2: what `roslet.Time` and `Duration` offer as well, so that
    one program serves on both networks."""

    __slots__ = ()

    if TYPE_CHECKING:  # slots of the generated classes

        @property
        def sec(self) -> int: ...
        @sec.setter
        def sec(self, value: int) -> None: ...
        @property
        def nanosec(self) -> int: ...
        @nanosec.setter
        def nanosec(self, value: int) -> None: ...

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Message) or not hasattr(other, "nanosec"):
            return Message.__eq__(self, other)
        return self.to_nsec() == other.to_nsec()  # type: ignore[attr-defined, no-any-return]

    __hash__ = None

    def to_sec(self) -> float:
        """Seconds as a float; of a present-day time about 100 ns are lost in the rounding."""
        return self.sec + self.nanosec / 1e9

    def to_nsec(self) -> int:
        """Whole nanoseconds, exact."""
        return self.sec * 1000000000 + self.nanosec

    @property
    def secs(self) -> int:
        """`sec`, by its name on ROS 1."""
        return self.sec

    @secs.setter
    def secs(self, value: int) -> None:
        self.sec = value

    @property
    def nsecs(self) -> int:
        """`nanosec`, by its name on ROS 1."""
        return self.nanosec

    @nsecs.setter
    def nsecs(self, value: int) -> None:
        self.nanosec = value


def same(one: "Any", other: "Any") -> bool:
    """Whether two field values are equal: arrays by their elements, whatever holds them."""
    if one is other:
        return True
    if isinstance(one, (str, int, float, Message)) or type(one) is type(other) is bytes:
        equal = one == other
        if equal is True or equal is False:
            return equal
    try:
        length = len(one)
        if length != len(other):
            return False
    except TypeError:
        return bool(one == other)
    if isinstance(one, str) or isinstance(other, str):
        return False
    if hasattr(one, "tobytes") and type(one) is type(other):  # ndarrays, or memoryviews
        equal = one == other
        return equal if equal is True or equal is False else bool(equal.all())
    return all(same(one[at], other[at]) for at in range(length))


def _copied(value: "Any", base: "Any", kind: int) -> "Any":
    if kind == SINGLE:
        if not isinstance(base, str):
            # What stands in for a Stamp, such as roslet.Time, becomes one.
            return value.copy() if isinstance(value, Message) else base(value.sec, value.nanosec)
        if base == "time" or base == "duration":
            made = object.__new__(type(value))
            made.secs = value.secs
            made.nsecs = value.nsecs
            return made
        return value
    if isinstance(base, str) and base in TYPECODES:
        if isinstance(value, (list, tuple)):
            return list(value)
        if hasattr(value, "copy"):
            return value.copy()
        if isinstance(value, memoryview):
            if getattr(value, "format", "B") == "B":
                return bytes(value)
            return memoryview(bytes(value)).cast(value.format)  # type: ignore[call-overload]
        return value[:]
    return [_copied(element, base, SINGLE) for element in value]


serialize_any = Message.serialize
"""The inherited `serialize`, for generated code that has a quicker one for most messages."""


def deserialize_any(kind: "type[Message]", buffer: "Any") -> "Any":
    """The inherited `deserialize`, for the same."""
    view = memoryview(buffer)
    if CPYTHON and (view.format != "B" or view.ndim != 1):
        view = view.cast("B")
    return kind.deserialize_from(view, 0, len(view))


def rescue_write(
    message: "Any", buffer: "Any", offset: int, parts: "list[tuple[int, Any]] | None", error: Exception
) -> int:
    """What generated code does when its fast path raised: write by the field table, which accepts everything
    that is valid, or raise the exact error. Same contract as `Message.serialize_into`."""
    if isinstance(error, RosletError):
        raise error
    if parts is not None:
        del parts[:]
    codec = cdr if message._encoding == "cdr" else ros1
    size: int = codec.size(message)
    if offset + size > len(buffer):
        raise BufferTooSmall(size)
    buffer[offset : offset + size] = codec.write(message)
    return offset + size


def rescue_read(kind: "Any", buffer: "Any", start: int, end: int) -> "Any":
    """What generated code does when its fast path raised: read by the field table, which knows every
    representation, or raise the exact error. Same contract as `Message.deserialize_from`."""
    if end > len(buffer):
        end = len(buffer)
    codec = cdr if kind._encoding == "cdr" else ros1
    return codec.read(kind, buffer, start, end)


class Service:
    """A service type: `Request` and `Response` are its message classes."""

    _type: "ClassVar[str]" = ""
    _md5sum: "ClassVar[str]" = ""
    _type_hash: "ClassVar[str]" = ""
    Request: "ClassVar[type[Message]]" = Message
    Response: "ClassVar[type[Message]]" = Message


class Action:
    """An action type: `Goal`, `Result`, `Feedback`, and what the dialect derives of them (ROS 2: the services
    `SendGoal` and `GetResult` and the message `FeedbackMessage`; ROS 1: the messages `ActionGoal`,
    `ActionResult`, `ActionFeedback` and `Action`)."""

    _type: "ClassVar[str]" = ""
    _md5sum: "ClassVar[str]" = ""
    _type_hash: "ClassVar[str]" = ""
    Goal: "ClassVar[type[Message]]" = Message
    Result: "ClassVar[type[Message]]" = Message
    Feedback: "ClassVar[type[Message]]" = Message
