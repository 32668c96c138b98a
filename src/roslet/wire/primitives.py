"""The one place where the fastest primitive that the interpreter has is chosen, once, at import.

CPython has `struct.Struct`, whose bound methods save a lookup of the format in every call, and UTF-8 that
keeps every byte; MicroPython has neither. Generated code calls what stands here.
"""

import struct
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

CPYTHON = sys.implementation.name == "cpython"

new: "Callable[[type], Any]" = object.__new__
"""Creates an object without running its `__init__`."""

BOOL: "dict[object, int]" = {False: 0, True: 1}
"""A bool's byte. What is neither true nor false, nor equal to 0 or 1, is a KeyError."""

ZEROS = (b"", b"\0", b"\0\0", b"\0\0\0", b"\0\0\0\0", bytes(5), bytes(6), bytes(7), bytes(8), bytes(9))
"""ZEROS[n] is n bytes of padding."""


def packers(form: str, align: int) -> "tuple[Callable[..., None], ...]":
    """`packers(form, align)[pad]` writes `pad` bytes of padding, less than `align`, and then `form`."""
    return tuple([packer("<%dx%s" % (pad, form[1:]) if pad else form) for pad in range(align)])


MAX_TABLE = 1024
"""Formats that one table of string lengths keeps; what is beyond is made anew each time."""


if CPYTHON:

    class _Table(dict):  # type: ignore[type-arg]
        """Functions of one format with a string in it, by the string's length; made when first asked for."""

        def __init__(self, make: "Callable[[int], Callable[..., Any]]") -> None:
            self.make = make

        def __missing__(self, key: int) -> "Callable[..., Any]":
            made = self.make(key)
            if len(self) < MAX_TABLE:
                self[key] = made
            return made

    _by_length: "Any" = _Table

else:

    class _Maker:
        """The same for MicroPython, whose dict calls no `__missing__`: nothing is kept, and little is made."""

        def __init__(self, make: "Callable[[int], Callable[..., Any]]") -> None:
            self.make = make

        def __getitem__(self, key: int) -> "Callable[..., Any]":
            return self.make(key)

    _by_length = _Maker


def text_packers(head: str, tail: str, terminator: int) -> "Any":
    """`text_packers(head, tail, terminator)[size]` packs `head`, a string in `size` + `terminator` bytes (NULs behind
    it), and `tail`."""
    return _by_length(lambda size: packer("<%s%ds%s" % (head, size + terminator, tail)))


def padded_text_packers(head: str, tail: str, terminator: int) -> "Any":
    """The same with up to seven bytes of padding in front; the key is `size << 3 | padding`."""
    return _by_length(lambda key: packer("<%dx%s%ds%s" % (key & 7, head, (key >> 3) + terminator, tail)))


def text_bytes_packers(head: str, tail: str, terminator: int) -> "Any":
    """As `text_packers`, but what they pack they return."""
    return _by_length(lambda size: bytes_packer("<%s%ds%s" % (head, size + terminator, tail)))


def number_packers(code: str) -> "Any":
    """`number_packers(code)[count]` returns the bytes of `count` numbers."""
    return _by_length(lambda count: bytes_packer("<%d%s" % (count, code)))


def text_unpackers(tail: str, terminator: int) -> "Any":
    """`text_unpackers(tail, terminator)[size]` unpacks a string of `size` bytes, of which `terminator` are left out, and
    `tail`."""
    return _by_length(
        lambda size: unpacker("<%ds%dx%s" % (max(size - terminator, 0), min(size, terminator), tail))
    )


def padded_text_unpackers(tail: str, terminator: int) -> "Any":
    """The same with up to seven bytes of padding behind the string; the key is `size << 3 | padding`."""
    return _by_length(
        lambda key: unpacker(
            "<%ds%dx%s" % (max((key >> 3) - terminator, 0), min(key >> 3, terminator) + (key & 7), tail)
        )
    )


if CPYTHON:
    FAILURES: "tuple[type[Exception], ...]" = (
        struct.error,
        TypeError,
        ValueError,  # UnicodeError among them
        AttributeError,
        LookupError,
        OverflowError,
        BufferError,
    )

    def packer(form: str) -> "Callable[..., None]":
        """`pack_into` of one format: call it with buffer, offset, values."""
        return struct.Struct(form).pack_into

    def bytes_packer(form: str) -> "Callable[..., bytes]":
        """`pack` of one format: call it with the values."""
        return struct.Struct(form).pack

    def unpacker(form: str) -> "Callable[..., tuple[Any, ...]]":
        """`unpack_from` of one format: call it with buffer, offset."""
        return struct.Struct(form).unpack_from

    _UINT32 = unpacker("<I")

    def uint32(buffer: "bytes | bytearray | memoryview", at: int) -> int:
        """The number in four octets, the lowest first; of MicroPython's heap it takes nothing."""
        return _UINT32(buffer, at)[0]  # type: ignore[no-any-return]

    def decode(data: "bytes | bytearray | memoryview") -> str:
        """UTF-8; a byte that is none becomes a lone surrogate, so that encoding gives it back."""
        return str(data, "utf-8", "surrogateescape")

    def encode(text: str) -> bytes:
        """The reverse of `decode`. Raises UnicodeEncodeError for other lone surrogates."""
        return text.encode("utf-8", "surrogateescape")

    def decode_wide(data: "bytes | bytearray | memoryview", big: bool) -> str:
        """UTF-16 units, each in four bytes, as Fast DDS and rmw_cyclonedds send them; lone surrogates stay what they are.
        Raises ValueError where a unit is no code point either."""
        text = str(data, "utf-32-be" if big else "utf-32-le", "surrogatepass")
        if text.isascii():
            return text
        return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")

    def encode_wide(text: str, big: bool) -> bytes:
        """The reverse of `decode_wide`."""
        units = text.encode("utf-16-be" if big else "utf-16-le", "surrogatepass")
        data = bytearray(2 * len(units))
        at = 2 if big else 0
        data[at::4], data[at + 1 :: 4] = units[0::2], units[1::2]
        return bytes(data)

else:
    FAILURES = (TypeError, ValueError, AttributeError, LookupError, OverflowError)

    _packers: "dict[str, Callable[..., Any]]" = {}  # by format: many modules have the same, and memory is short
    _unpackers: "dict[str, Callable[..., Any]]" = {}

    def packer(form: str) -> "Callable[..., None]":
        found = _packers.get(form)
        if found is None:
            found = _packers[form] = _packer(form)
        return found

    def _packer(form: str) -> "Callable[..., None]":
        pack_into = struct.pack_into

        def pack(buffer: "Any", offset: int, *values: object) -> None:
            pack_into(form, buffer, offset, *values)

        if "x" not in form:
            return pack
        zeros = bytes(struct.calcsize(form))

        def pack_zeroed(buffer: "Any", offset: int, *values: object) -> None:
            buffer[offset : offset + len(zeros)] = zeros  # MicroPython skips padding without writing it
            pack_into(form, buffer, offset, *values)

        return pack_zeroed

    def bytes_packer(form: str) -> "Callable[..., bytes]":
        pack = struct.pack

        def make(*values: object) -> bytes:
            return pack(form, *values)

        return make

    def unpacker(form: str) -> "Callable[..., tuple[Any, ...]]":
        found = _unpackers.get(form)
        if found is None:
            unpack_from = struct.unpack_from

            def unpack(buffer: "Any", offset: int) -> "tuple[Any, ...]":
                return unpack_from(form, buffer, offset)

            found = _unpackers[form] = unpack
        return found

    def uint32(buffer: "bytes | bytearray | memoryview", at: int) -> int:
        return buffer[at] | buffer[at + 1] << 8 | buffer[at + 2] << 16 | buffer[at + 3] << 24

    def decode(data: "bytes | bytearray | memoryview") -> str:
        """UTF-8; a byte that is none becomes a question mark: MicroPython's str holds nothing else."""
        try:
            return str(data, "utf-8")
        except ValueError:
            return "".join([chr(byte) if byte < 128 else "?" for byte in data])

    def encode(text: str) -> bytes:
        return text.encode("utf-8")

    def decode_wide(data: "bytes | bytearray | memoryview", big: bool) -> str:
        form = ">I" if big else "<I"
        out = []
        first = 0
        for at in range(0, len(data) - 3, 4):
            unit = struct.unpack_from(form, data, at)[0]
            if unit > 0x10FFFF:
                raise ValueError("no code point")
            if 0xD800 <= unit < 0xDC00:
                first = unit
            elif 0xDC00 <= unit < 0xE000 and first:
                out.append(chr(0x10000 + ((first - 0xD800) << 10) + (unit - 0xDC00)))
                first = 0
            else:
                out.append(chr(unit))
        return "".join(out)

    def encode_wide(text: str, big: bool) -> bytes:
        out = bytearray()
        form = ">I" if big else "<I"
        for letter in text:
            code = ord(letter)
            if code >= 0x10000:
                code -= 0x10000
                out.extend(struct.pack(form, 0xD800 + (code >> 10)))
                code = 0xDC00 + (code & 0x3FF)
            out.extend(struct.pack(form, code))
        return bytes(out)
