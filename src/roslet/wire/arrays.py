"""Numeric arrays of messages: what a reader hands out, and what a writer accepts.

A reader gives, without copying: a numpy ndarray where numpy is installed, a `memoryview` cast to the
element's type on a CPython without it. MicroPython has neither and gets an `array.array`, which is a copy.
`bool` arrays without numpy are lists. A view shows the buffer it was made on: it is valid as long as it is
held, and it shows other content as soon as the owner of the buffer reuses it.

A writer accepts a numpy array, anything with the buffer interface of the right element type, a list, tuple or
range.

numpy is imported when the first array type is asked for, never before: `import roslet` must stay quick.
"""

import struct
import sys

from roslet.wire.primitives import BOOL, CPYTHON, MAX_TABLE, number_packers

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    Bytes = bytes | bytearray | memoryview

TYPECODES = {
    "bool": "B",
    "int8": "b",
    "uint8": "B",
    "int16": "h",
    "uint16": "H",
    "int32": "i",
    "uint32": "I",
    "int64": "q",
    "uint64": "Q",
    "float32": "f",
    "float64": "d",
}
"""The `struct` and `array` code of every numeric primitive."""

LARGE = 16384
"""Bytes from which a contiguous array is lent to the caller as a view; below, a copy is cheaper than a
view."""


_array_type: "Any" = None


def _array() -> "Any":
    """`array.array`, imported late: on CPython it brings `collections.abc` with it."""
    global _array_type
    if _array_type is None:
        from array import array

        _array_type = array
    return _array_type


class _NoArray:
    """Stands for numpy's array type where there is no numpy: nothing is an instance of it."""


class Numbers:
    """The arrays of one primitive.

    `type` is numpy's ndarray (a class without instances where there is no numpy) and `tag` its dtype, else
    the type code; `array` is the standard library's array, where it holds what the wire does. `view(buffer, tag,
    count, offset)` makes a reader's array; `empty` is one of no elements, shared and not to be written.
    `zeros(count)` is a new array; `raw(value)` the little-endian bytes of what a writer was given.
    """

    def __init__(self, primitive: str, numpy: "Any") -> None:
        self.primitive = primitive
        self.code = TYPECODES[primitive]
        self.size = struct.calcsize("<" + self.code)
        self.numpy = numpy
        self.packers = number_packers(self.code)
        # The array of the standard library, where its elements have the size and byte order of the wire.
        plain = CPYTHON and sys.byteorder == "little" and primitive != "bool"
        self.array: Any = _array() if plain and _array()(self.code).itemsize == self.size else _NoArray
        if numpy is not None:
            name = "?" if primitive == "bool" else "<" + self.code.replace("b", "i1").replace("B", "u1")
            self.type: Any = numpy.ndarray
            self.tag: Any = numpy.dtype(name)
            self.view: Callable[..., Any] = numpy.frombuffer
            self.empty: Any = numpy.zeros(0, self.tag)
            self.empty.flags.writeable = False
        else:
            self.type = _NoArray
            self.tag = self.code
            self.view = _view_bool if primitive == "bool" else _view
            self.empty = [] if primitive == "bool" else _array()(self.code)

    def zeros(self, count: int) -> "Any":
        """A new array of `count` zeros."""
        if self.numpy is not None:
            return self.numpy.zeros(count, self.tag)
        if self.primitive == "bool":
            return [False] * count
        return _array()(self.code, bytes(count * self.size))

    def raw(self, value: "Any") -> "Bytes":
        """The elements of `value` as little-endian bytes, perhaps lent by `value` itself.

        Raises TypeError, ValueError, OverflowError, LookupError or struct.error for what is no array of the
        type.
        """
        kind = type(value)
        if kind is list or kind is tuple:
            if not value:
                return b""
            if self.primitive == "bool":
                return bytes([BOOL[element] for element in value])
            if not CPYTHON:
                _check_range(value, self.code, self.size)
            if len(value) < MAX_TABLE:
                return self.packers[len(value)](*value)  # type: ignore[no-any-return]
            return struct.pack("<%d%s" % (len(value), self.code), *value)
        if CPYTHON:
            return self._raw_buffer(value)
        if kind is _array():
            data = memoryview(value)
            if len(value) and struct.calcsize(self.code) * len(value) == len(bytes(data)):
                return bytes(data)
        return self.raw(_listed(value))

    def _raw_buffer(self, value: "Any") -> "Bytes":
        numpy = self.numpy
        if numpy is not None and isinstance(value, (numpy.ndarray, numpy.generic)):
            return _lend(value if value.dtype == self.tag else self._convert(value))
        if isinstance(value, (memoryview, _array())):
            view = memoryview(value)
            code = view.format
            if code == "l" or code == "L":  # 4 or 8 bytes, as the C compiler decided
                code = {"l4": "i", "L4": "I", "l8": "q", "L8": "Q"}[code + str(view.itemsize)]
            if self.primitive == "bool":
                return bytes([BOOL[element] for element in value])
            if code == self.code and sys.byteorder == "little":
                return _lend(view)
        if isinstance(value, (bytes, bytearray)) and self.code not in "bB":
            # Bytes are a sequence of small integers, but somebody who gives them means something else.
            raise TypeError("expected an array of %s, got %s" % (self.primitive, type(value).__name__))
        return self.raw(_listed(value))

    def _convert(self, value: "Any") -> "Any":
        """An ndarray of another dtype, converted if every element keeps its value (floats: up to
        rounding)."""
        numpy = self.numpy
        if not value.size:  # numpy.array([]) is of float64
            return value.astype(self.tag)
        kind = value.dtype.kind
        if self.code in "fd":
            if kind not in "fiu":
                raise TypeError("expected an array of %s, got %s" % (self.primitive, value.dtype))
            with numpy.errstate(over="ignore"):
                converted = value.astype(self.tag)
            if kind == "f" and bool((numpy.isinf(converted) & ~numpy.isinf(value)).any()):
                raise OverflowError("a value is too large for " + self.primitive)
            return converted
        if kind not in ("biu" if self.primitive == "bool" else "iu"):
            raise TypeError("expected an array of %s, got %s" % (self.primitive, value.dtype))
        low, high = int(value.min()), int(value.max())
        if self.primitive == "bool":
            least, most = 0, 1
        else:
            limits = numpy.iinfo(self.tag)
            least, most = int(limits.min), int(limits.max)
        if low < least or high > most:
            raise OverflowError("a value does not fit %s" % self.primitive)
        return value.astype(self.tag)

    def from_bytes(self, data: "Bytes", big: bool) -> "Any":
        """A new array from bytes of either byte order; `data` has whole elements."""
        count = len(data) // self.size
        if self.numpy is not None:
            made = self.numpy.frombuffer(bytes(data), self.tag.newbyteorder(">" if big else "<"), count)
            return made.astype(self.tag)
        values = struct.unpack("%s%d%s" % (">" if big else "<", count, self.code), bytes(data))
        if self.primitive == "bool":
            return [value != 0 for value in values]
        return _array()(self.code, values)


def _check_range(values: "Any", code: str, size: int) -> None:
    """What MicroPython's struct leaves out: it keeps the low bits of an integer that is too large."""
    if code in "fd":
        return
    low, high = (
        (0, (1 << 8 * size) - 1) if code in "BHIQ" else (-(1 << 8 * size - 1), (1 << 8 * size - 1) - 1)
    )
    for value in values:
        if not low <= value <= high:
            raise OverflowError("%r does not fit" % value)


def _listed(value: "Any") -> "list[Any]":
    if isinstance(value, (str, dict)):
        raise TypeError("expected an array, got " + type(value).__name__)
    return list(value)


def _lend(value: "Any") -> "Bytes":
    """The bytes of an ndarray or memoryview: small ones as a copy, large contiguous ones as a view."""
    if value.nbytes < LARGE:
        return value.tobytes()  # type: ignore[no-any-return]
    view = memoryview(value)
    if not view.c_contiguous:
        return value.tobytes()  # type: ignore[no-any-return]
    return view.cast("B")


def _view(buffer: "Any", code: str, count: int, offset: int) -> "Any":
    """A reader's array without numpy."""
    size = struct.calcsize("<" + code)
    if offset + count * size > len(buffer):
        raise ValueError("beyond the end")
    data = buffer[offset : offset + count * size]
    if CPYTHON and sys.byteorder == "little":
        return memoryview(data).cast(code)  # type: ignore[call-overload]
    return _array()(code, struct.unpack("<%d%s" % (count, code), data))


def _view_bool(buffer: "Any", _code: str, count: int, offset: int) -> "list[bool]":
    if offset + count > len(buffer):
        raise ValueError("beyond the end")
    return [byte != 0 for byte in buffer[offset : offset + count]]


_made: "dict[str, Numbers]" = {}


def numbers(primitive: str) -> Numbers:
    """The arrays of a numeric primitive or bool. The first call imports numpy if it is installed."""
    made = _made.get(primitive)
    if made is None:
        made = _made[primitive] = Numbers(primitive, _numpy())
    return made


def _numpy() -> "Any":
    if not CPYTHON:
        return None
    try:
        import numpy
    except ImportError:
        return None
    return numpy


def octets(value: "Any") -> "Bytes":
    """The bytes of what a writer was given for a uint8 array, lent without copying where possible.

    Accepts bytes, bytearray, memoryviews and arrays of bytes, ndarrays of integers, and sequences of
    integers. Raises TypeError, ValueError or OverflowError for anything else.
    """
    kind = type(value)
    if kind is bytes or kind is bytearray:
        return value  # type: ignore[no-any-return]
    if kind is list or kind is tuple:
        if not CPYTHON:
            _check_range(value, "B", 1)
        return bytes(value)
    if not CPYTHON:
        if kind is memoryview:
            return value  # type: ignore[no-any-return]
        if kind is _array():
            return memoryview(value)
    elif isinstance(value, (memoryview, _array())):
        view = memoryview(value)
        if view.format in ("B", "c") and view.c_contiguous:
            return view if view.format == "B" and view.ndim == 1 else view.cast("B")
    elif hasattr(value, "dtype"):
        return numbers("uint8").raw(value)
    if isinstance(value, (str, int, dict)):
        raise TypeError("expected bytes, got " + kind.__name__)
    return bytes(list(value))


def place(buffer: "Any", offset: int, data: "Any", parts: "list[tuple[int, Any]] | None") -> int:
    """Copy a large payload to `offset`, or append it to `parts` instead; the offset after it in `buffer`.

    Raises ValueError if it does not fit.
    """
    if parts is not None:
        parts.append((offset, data))
        return offset
    end = offset + len(data)
    if end > len(buffer):
        raise ValueError("beyond the end")
    if CPYTHON:
        # Assigning to a slice of a bytearray itself would make a second copy.
        memoryview(buffer)[offset:end] = data
    else:
        buffer[offset:end] = data
    return end
