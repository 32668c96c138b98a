"""A writer and a reader that walk a message's field table: slower than generated code, and exact about what
is wrong.

They serve when generated code failed (to say where and why), for big-endian and version 2 CDR, for sizes, and
as the second opinion in the tests. Alignment belongs to the cursor. Runs on MicroPython.

A field table (`Message._spec`) is a tuple of fields, each a tuple

    (attribute, base, kind, size, bound)

base: a primitive's name, or the class of a nested message; kind: SINGLE, FIXED, BOUNDED or UNBOUNDED; size:
the number of elements of a FIXED array, the most elements of a BOUNDED one; bound: the most bytes of a string
(16-bit units of a wide one) or None.
"""

import struct

from roslet.errors import InvalidMessage, MalformedMessage
from roslet.wire.arrays import TYPECODES, numbers, octets
from roslet.wire.primitives import BOOL, FAILURES, decode, decode_wide, encode, encode_wide, new
from roslet.wire.time import Duration, Time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    Spec = tuple[tuple[str, Any, int, int, int | None], ...]

SINGLE, FIXED, BOUNDED, UNBOUNDED = 0, 1, 2, 3

# A message without fields takes no bytes in ROS 1, so that a count of such elements is checked against nothing. No
# definition in use has an array of empty messages; this many serve whoever counts with one.
MAX_EMPTY_ELEMENTS = 1024

_RANGES = {
    "int8": (-(1 << 7), (1 << 7) - 1),
    "uint8": (0, (1 << 8) - 1),
    "int16": (-(1 << 15), (1 << 15) - 1),
    "uint16": (0, (1 << 16) - 1),
    "int32": (-(1 << 31), (1 << 31) - 1),
    "uint32": (0, (1 << 32) - 1),
    "int64": (-(1 << 63), (1 << 63) - 1),
    "uint64": (0, (1 << 64) - 1),
}

_SIZES = {name: struct.calcsize("<" + code) for name, code in TYPECODES.items()}


def _shown(value: "Any") -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _type_name(value: "Any") -> str:
    return type(value).__name__


def _iterable(value: "Any") -> bool:
    try:
        iter(value)
    except TypeError:
        return False
    return True


class Writer:
    """Appends a message's bytes to `data`. `largest` is the largest alignment: 1 in ROS 1, 8 in CDR, 4 in CDR
    version 2; `terminator` the number of NULs after a string; positions count from the writer's start.

    Raises InvalidMessage with the value path for a value that its field cannot hold.
    """

    def __init__(self, order: str, largest: int, terminator: int) -> None:
        self.order = order
        self.largest = largest
        self.terminator = terminator
        self.data = bytearray()
        self.position = 0

    def put(self, data: "bytes | bytearray | memoryview") -> None:
        """Append bytes."""
        self.data.extend(data)
        self.position += len(data)

    def align(self, size: int) -> None:
        """Pad to a multiple of `size`, or of the largest alignment."""
        if size > self.largest:
            size = self.largest
        pad = -self.position % size
        if pad:
            self.put(bytes(pad))

    def count(self, value: int, path: str) -> None:
        """Append a length or count."""
        if value >> 32:
            raise InvalidMessage("%d elements do not fit a 32-bit count" % value, path)
        self.align(4)
        self.put(struct.pack(self.order + "I", value))

    def message(self, value: "Any", spec: "Spec", path: str) -> None:
        """Append all fields of `value`."""
        dot = path + "." if path else ""
        for attribute, base, kind, size, bound in spec:
            try:
                element = getattr(value, attribute)
            except AttributeError:
                if path:
                    raise InvalidMessage(
                        "a value of type %s has no field %s" % (_type_name(value), attribute), path
                    ) from None
                raise InvalidMessage("the field was never set", attribute) from None
            where = dot + attribute
            if kind == SINGLE:
                self.value(element, base, bound, where)
            else:
                self.array(element, base, kind, size, bound, where)
        if not spec and self.terminator:
            self.put(b"\0")

    def value(self, value: "Any", base: "Any", bound: "int | None", path: str) -> None:
        """Append one value of a primitive or a nested message."""
        if not isinstance(base, str):
            self.message(value, base._spec, path)
        elif base == "string":
            self.text(value, bound, path)
        elif base == "wstring":
            self.wide(value, bound, path)
        elif base == "time" or base == "duration":
            integer = "uint32" if base == "time" else "int32"
            for name in ("secs", "nsecs"):
                if not hasattr(value, name):
                    raise InvalidMessage("expected a %s, got %s" % (base, _type_name(value)), path)
                self.number(getattr(value, name), integer, path + "." + name)
        else:
            self.number(value, base, path)

    def number(self, value: "Any", primitive: str, path: str) -> None:
        """Append a number or bool."""
        if primitive == "bool":
            try:
                value = BOOL[value]
            except FAILURES:
                raise InvalidMessage("expected a bool, got " + _shown(value), path) from None
            self.put(b"\1" if value else b"\0")
            return
        size = _SIZES[primitive]
        self.align(size)
        try:
            if primitive in _RANGES and not isinstance(value, int):
                value = value.__index__()
            if primitive in _RANGES:
                low, high = _RANGES[primitive]
                if not low <= value <= high:
                    raise InvalidMessage("%s cannot hold %d" % (primitive, value), path)
            data = struct.pack(self.order + TYPECODES[primitive], value)
        except OverflowError:
            raise InvalidMessage("%s cannot hold %s" % (primitive, _shown(value)), path) from None
        except FAILURES:
            raise InvalidMessage(
                "expected a %s, got %s %s" % (primitive, _type_name(value), _shown(value)), path
            ) from None
        self.put(data)

    def text(self, value: "Any", bound: "int | None", path: str) -> None:
        """Append a string. Bytes are taken as they are, as ROS 1's own Python does."""
        if isinstance(value, str):
            try:
                value = encode(value)
            except FAILURES:
                raise InvalidMessage("not encodable as UTF-8: " + _shown(value), path) from None
        elif not isinstance(value, (bytes, bytearray)):
            raise InvalidMessage("expected a string, got %s %s" % (_type_name(value), _shown(value)), path)
        if bound is not None and len(value) > bound:
            raise InvalidMessage("at most %d bytes, got %d" % (bound, len(value)), path)
        self.count(len(value) + self.terminator, path)
        self.put(value)
        if self.terminator:
            self.put(b"\0")

    def wide(self, value: "Any", bound: "int | None", path: str) -> None:
        """Append a wide string."""
        if not isinstance(value, str):
            raise InvalidMessage("expected a string, got %s %s" % (_type_name(value), _shown(value)), path)
        data = encode_wide(value, self.order == ">")
        units = len(data) // 4
        if bound is not None and units > bound:
            raise InvalidMessage("at most %d 16-bit units, got %d" % (bound, units), path)
        self.count(units, path)
        self.put(data)

    def array(self, value: "Any", base: "Any", kind: int, size: int, bound: "int | None", path: str) -> None:
        """Append an array, with its count unless it is FIXED."""
        numeric = isinstance(base, str) and base in TYPECODES
        if numeric:
            data = self.raw(value, base, path)
            length = len(data) // _SIZES[base]
        else:
            if not isinstance(value, (list, tuple)):
                if isinstance(value, (str, bytes, bytearray, dict)) or not _iterable(value):
                    raise InvalidMessage(
                        "expected a list, got %s %s" % (_type_name(value), _shown(value)), path
                    )
                value = list(value)
            length = len(value)
        if kind == FIXED and length != size:
            raise InvalidMessage("expected exactly %d elements, got %d" % (size, length), path)
        if kind == BOUNDED and length > size:
            raise InvalidMessage("at most %d elements, got %d" % (size, length), path)
        if kind != FIXED:
            self.count(length, path)
        if numeric:
            if length:
                self.align(_SIZES[base])
                self.numbers(data, base)
            return
        for at, element in enumerate(value):
            self.value(element, base, bound, "%s[%d]" % (path, at))

    def raw(self, value: "Any", primitive: str, path: str) -> "bytes | bytearray | memoryview":
        """An array's elements as little-endian bytes; raises InvalidMessage naming the first wrong
        element."""
        try:
            return octets(value) if primitive == "uint8" else numbers(primitive).raw(value)
        except FAILURES as error:
            if not isinstance(value, (str, bytes, bytearray, dict)) and _iterable(value):
                probe = Writer("<", 1, 0)
                for at, element in enumerate(value):
                    probe.number(element, primitive, "%s[%d]" % (path, at))
            raise InvalidMessage(
                "expected %s, got %s (%s)"
                % ("bytes" if primitive == "uint8" else "an array of " + primitive, _type_name(value), error),
                path,
            ) from None

    def numbers(self, data: "Any", primitive: str) -> None:
        """Append little-endian elements in the writer's byte order."""
        size = _SIZES[primitive]
        if self.order == ">" and size > 1:
            code = "%d%s" % (len(data) // size, TYPECODES[primitive])
            data = struct.pack(">" + code, *struct.unpack("<" + code, bytes(data)))
        self.put(data)


class Sizer(Writer):
    """A writer that only counts, so that large arrays cost no copy."""

    def put(self, data: "bytes | bytearray | memoryview") -> None:
        self.position += len(data)


class Reader:
    """Reads a message from buffer[start:end]; `order`, `largest` and `terminator` as in `Writer`. `origin` is
    where positions and offsets count from for alignment.

    Raises MalformedMessage with the offset from `start` and the path. Allocates nothing for a count that the
    bytes left cannot hold.
    """

    def __init__(
        self, buffer: "Any", start: int, origin: int, end: int, order: str, largest: int, terminator: int
    ) -> None:
        self.buffer = buffer
        self.start = start
        self.origin = origin
        self.position = origin
        self.end = end
        self.order = order
        self.largest = largest
        self.terminator = terminator

    def malformed(self, message: str, path: str) -> MalformedMessage:
        """An error at the present position, or at the end where padding would lie behind it."""
        return MalformedMessage(message, min(self.position, self.end) - self.start, path)

    def take(self, size: int, path: str) -> int:
        """Advance by `size` bytes; the position before. Raises where there are fewer."""
        at = self.position
        if size > self.end - at:
            raise self.malformed("%d bytes needed, %d left" % (size, max(self.end - at, 0)), path)
        self.position = at + size
        return at

    def align(self, size: int) -> None:
        """Skip padding."""
        if size > self.largest:
            size = self.largest
        self.position += (self.origin - self.position) % size

    def number(self, primitive: str, path: str) -> "Any":
        """A number or bool."""
        size = _SIZES[primitive]
        self.align(size)
        at = self.take(size, path)
        value = struct.unpack_from(self.order + TYPECODES[primitive], self.buffer, at)[0]
        return value != 0 if primitive == "bool" else value

    def message(self, kind: "Any", path: str) -> "Any":
        """An object of the message class `kind`."""
        value = new(kind)
        dot = path + "." if path else ""
        for attribute, base, array, size, bound in kind._spec:
            where = dot + attribute
            single = array == SINGLE
            element = (
                self.value(base, bound, where) if single else self.array(base, array, size, bound, where)
            )
            setattr(value, attribute, element)
        if not kind._spec and self.terminator:
            self.take(1, path)
        return value

    def value(self, base: "Any", bound: "int | None", path: str) -> "Any":
        """One value of a primitive or a nested message."""
        if not isinstance(base, str):
            return self.message(base, path)
        if base == "string":
            return self.text(bound, path)
        if base == "wstring":
            return self.wide(bound, path)
        if base == "time" or base == "duration":
            value = new(Time if base == "time" else Duration)
            integer = "uint32" if base == "time" else "int32"
            value.secs = self.number(integer, path + ".secs")
            value.nsecs = self.number(integer, path + ".nsecs")
            return value
        return self.number(base, path)

    def text(self, bound: "int | None", path: str) -> str:
        """A string."""
        length = self.number("uint32", path)
        at = self.take(length, path)
        if length:
            length -= self.terminator
        if bound is not None and length > bound:
            raise MalformedMessage("at most %d bytes, got %d" % (bound, length), at - self.start, path)
        return decode(self.buffer[at : at + length])

    def wide(self, bound: "int | None", path: str) -> str:
        """A wide string."""
        units = self.number("uint32", path)
        at = self.take(units * 4, path)
        if bound is not None and units > bound:
            raise MalformedMessage("at most %d 16-bit units, got %d" % (bound, units), at - self.start, path)
        try:
            return decode_wide(self.buffer[at : at + units * 4], self.order == ">")
        except ValueError:
            raise MalformedMessage("a unit that is no character", at - self.start, path) from None

    def array(self, base: "Any", kind: int, size: int, bound: "int | None", path: str) -> "Any":
        """An array."""
        if kind == FIXED:
            count = size
        else:
            count = self.number("uint32", path)
            if kind == BOUNDED and count > size:
                raise self.malformed("at most %d elements, got %d" % (size, count), path)
        if isinstance(base, str) and base in TYPECODES:
            return self.numbers(base, count, kind, path)
        least = self.least(base)
        left = max(self.end - self.position, 0)
        if least * count > left or (not least and kind != FIXED and count > MAX_EMPTY_ELEMENTS):
            raise self.malformed("%d elements cannot be in %d bytes" % (count, left), path)
        values = []
        for at in range(count):
            values.append(self.value(base, bound, "%s[%d]" % (path, at)))
        return values

    def least(self, base: "Any") -> int:
        """A lower bound of an element's bytes."""
        if not isinstance(base, str):
            least = 1 if not base._spec and self.terminator else 0
            for _attribute, inner, kind, size, _bound in base._spec:
                if kind == SINGLE:
                    least += self.least(inner)
                elif kind == FIXED:
                    least += size * self.least(inner)
                else:
                    least += 4
            return least
        if base == "time" or base == "duration":
            return 8
        return _SIZES.get(base, 4)

    def numbers(self, primitive: str, count: int, kind: int, path: str) -> "Any":
        """A numeric array."""
        size = _SIZES[primitive]
        if count:
            self.align(size)
        at = self.take(count * size, path)
        if primitive == "uint8":
            data = self.buffer[at : at + count]
            return bytes(data) if kind == FIXED and count <= SMALL_OCTETS else data
        arrays = numbers(primitive)
        if not count:
            return arrays.zeros(0) if kind == FIXED else arrays.empty
        if self.order == ">" and size > 1:
            return arrays.from_bytes(self.buffer[at : at + count * size], True)
        return arrays.view(self.buffer, arrays.tag, count, at)


SMALL_OCTETS = 64
"""A fixed uint8 array of at most so many elements (identifiers, hashes) is read as bytes: hashable, and its
own memory; a larger one as a view."""
