"""How the values of parameters lie in bytes: (parse, emit) pairs for `typed`. RTPS 2.3, 9.6.2.2.2; CDR of CORBA 3.0 15.3.

A parse function gets (data, start, end, flags) and relies on nothing but start <= end; it raises ProtocolError
parameter-truncated or parameter-too-many-elements. An emit function gets (value, little).
"""

from roslet.errors import ProtocolError
from roslet.wire.primitives import decode, encode, packer, unpacker
from roslet.wire.rtps import locator, times

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.wire.rtps.locator import Locator

    View = bytes | bytearray | memoryview
    Codec = tuple[Callable[[View, int, int, int], Any], Callable[[Any, bool], bytes]]

_U32 = (unpacker(">I"), unpacker("<I"))
_EMIT_U32 = (packer(">I"), packer("<I"))
_I32 = (unpacker(">i"), unpacker("<i"))
_EMIT_I32 = (packer(">i"), packer("<i"))
_I16 = (unpacker(">h"), unpacker("<h"))
_EMIT_I16 = (packer(">h"), packer("<h"))

# More partitions, properties or representations than anybody has; each costs an object.
MAX_ELEMENTS = 128


def truncated(have: int, need: int) -> ProtocolError:
    """A value that is shorter than its type or its count says."""
    return ProtocolError("parameter-truncated", "%d bytes, needs %d" % (have, need))


def _need(at: int, end: int, size: int) -> None:
    if end - at < size:
        raise truncated(end - at, size)


def parse_u32(data: "View", at: int, end: int, flags: int) -> int:
    _need(at, end, 4)
    value: int = _U32[flags & 1](data, at)[0]
    return value


def emit_u32(value: int, little: bool) -> bytes:
    data = bytearray(4)
    _EMIT_U32[1 if little else 0](data, 0, value)
    return bytes(data)


def parse_i32(data: "View", at: int, end: int, flags: int) -> int:
    _need(at, end, 4)
    value: int = _I32[flags & 1](data, at)[0]
    return value


def emit_i32(value: int, little: bool) -> bytes:
    data = bytearray(4)
    _EMIT_I32[1 if little else 0](data, 0, value)
    return bytes(data)


def parse_bool(data: "View", at: int, end: int, flags: int) -> bool:
    _need(at, end, 1)
    return data[at] != 0


def emit_bool(value: bool, little: bool) -> bytes:
    return b"\1" if value else b"\0"


def parse_duration(data: "View", at: int, end: int, flags: int) -> int:
    _need(at, end, 8)
    return times.parse_duration(data, at, flags)


def emit_duration(value: int, little: bool) -> bytes:
    return times.emit_duration(value, little)


def parse_locator(data: "View", at: int, end: int, flags: int) -> "Locator":
    _need(at, end, locator.SIZE)
    return locator.parse(data, at, flags)


def emit_locator(value: "Locator", little: bool) -> bytes:
    return bytes(value.emit(little))


def fixed_octets(size: int) -> "Codec":
    """The codec of exactly `size` octets."""

    def parse(data: "View", at: int, end: int, flags: int) -> bytes:
        _need(at, end, size)
        return bytes(data[at : at + size])

    def emit(value: bytes, little: bool) -> bytes:
        return bytes(value)

    return parse, emit


def _counted(data: "View", at: int, end: int, flags: int) -> "tuple[int, int]":
    """(start, end) of the octets behind a count."""
    length = parse_u32(data, at, end, flags)
    _need(at + 4, end, length)
    return at + 4, at + 4 + length


def parse_octets(data: "View", at: int, end: int, flags: int) -> bytes:
    start, stop = _counted(data, at, end, flags)
    return bytes(data[start:stop])


def emit_octets(value: bytes, little: bool) -> bytes:
    return emit_u32(len(value), little) + bytes(value)


def _text(data: "View", start: int, stop: int) -> str:
    if stop > start and data[stop - 1] == 0:
        stop -= 1
    return decode(bytes(data[start:stop]))


def parse_string(data: "View", at: int, end: int, flags: int) -> str:
    start, stop = _counted(data, at, end, flags)
    return _text(data, start, stop)


def emit_string(value: str, little: bool) -> bytes:
    text = encode(value) + b"\0"
    return emit_u32(len(text), little) + text


def _count(data: "View", at: int, end: int, flags: int) -> int:
    count = parse_u32(data, at, end, flags)
    if count > MAX_ELEMENTS:
        raise ProtocolError("parameter-too-many-elements", "%d, at most %d are taken" % (count, MAX_ELEMENTS))
    return count


def _strings(data: "View", at: int, end: int, flags: int, count: int) -> "tuple[str, ...]":
    origin = at
    found = []
    for _ in range(count):
        at += -(at - origin) & 3
        start, at = _counted(data, at, end, flags)
        found.append(_text(data, start, at))
    return tuple(found)


def parse_strings(data: "View", at: int, end: int, flags: int) -> "tuple[str, ...]":
    return _strings(data, at + 4, end, flags, _count(data, at, end, flags))


def _emit_strings(values: "tuple[str, ...]", little: bool) -> bytes:
    out = b""
    for value in values:
        out += bytes(-len(out) & 3) + emit_string(value, little)
    return out


def emit_strings(values: "tuple[str, ...]", little: bool) -> bytes:
    return emit_u32(len(values), little) + _emit_strings(values, little)


def parse_properties(data: "View", at: int, end: int, flags: int) -> "tuple[tuple[str, str], ...]":
    """Name and value pairs; binary properties behind them are not looked at."""
    flat = _strings(data, at + 4, end, flags, 2 * _count(data, at, end, flags))
    return tuple([(flat[index], flat[index + 1]) for index in range(0, len(flat), 2)])


def emit_properties(values: "tuple[tuple[str, str], ...]", little: bool) -> bytes:
    flat = [text for pair in values for text in pair]
    return emit_u32(len(values), little) + _emit_strings(tuple(flat), little)


def parse_shorts(data: "View", at: int, end: int, flags: int) -> "tuple[int, ...]":
    count = _count(data, at, end, flags)
    _need(at + 4, end, 2 * count)
    unpack = _I16[flags & 1]
    return tuple([unpack(data, at + 4 + 2 * index)[0] for index in range(count)])


def emit_shorts(values: "tuple[int, ...]", little: bool) -> bytes:
    data = bytearray(4 + 2 * len(values))
    _EMIT_U32[1 if little else 0](data, 0, len(values))
    for index, value in enumerate(values):
        _EMIT_I16[1 if little else 0](data, 4 + 2 * index, value)
    return bytes(data)


def structure(parts: "list[Codec]", sizes: "list[int]") -> "Codec":
    """The codec of a tuple of parts of fixed sizes, one behind the other."""

    def parse(data: "View", at: int, end: int, flags: int) -> "tuple[Any, ...]":
        _need(at, end, sum(sizes))
        found = []
        for index, part in enumerate(parts):
            found.append(part[0](data, at, at + sizes[index], flags))
            at += sizes[index]
        return tuple(found)

    def emit(value: "tuple[Any, ...]", little: bool) -> bytes:
        return b"".join([part[1](value[index], little) for index, part in enumerate(parts)])

    return parse, emit


U32: "Codec" = (parse_u32, emit_u32)
I32: "Codec" = (parse_i32, emit_i32)
BOOL: "Codec" = (parse_bool, emit_bool)
DURATION: "Codec" = (parse_duration, emit_duration)
LOCATOR: "Codec" = (parse_locator, emit_locator)
OCTETS: "Codec" = (parse_octets, emit_octets)
STRING: "Codec" = (parse_string, emit_string)
STRINGS: "Codec" = (parse_strings, emit_strings)
PROPERTIES: "Codec" = (parse_properties, emit_properties)
SHORTS: "Codec" = (parse_shorts, emit_shorts)
GUID: "Codec" = fixed_octets(16)
PAIR: "Codec" = fixed_octets(2)
KIND_AND_DURATION: "Codec" = structure([U32, DURATION], [4, 8])
KIND_AND_DEPTH: "Codec" = structure([U32, I32], [4, 4])
PRESENTATION: "Codec" = structure([U32, BOOL, BOOL], [4, 1, 1])
THREE_LIMITS: "Codec" = structure([I32, I32, I32], [4, 4, 4])
DURABILITY_SERVICE: "Codec" = structure([DURATION, U32, I32, I32, I32, I32], [8, 4, 4, 4, 4, 4])
