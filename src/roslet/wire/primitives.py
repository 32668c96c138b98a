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

    def unpacker(form: str) -> "Callable[..., tuple[Any, ...]]":
        """`unpack_from` of one format: call it with buffer, offset."""
        return struct.Struct(form).unpack_from

    def decode(data: "bytes | bytearray | memoryview") -> str:
        """UTF-8; a byte that is none becomes a lone surrogate, so that encoding gives it back."""
        return str(data, "utf-8", "surrogateescape")

    def encode(text: str) -> bytes:
        """The reverse of `decode`. Raises UnicodeEncodeError for other lone surrogates."""
        return text.encode("utf-8", "surrogateescape")

    def decode_wide(data: "bytes | bytearray | memoryview", big: bool) -> str:
        """UTF-16 without byte order mark; lone surrogates stay what they are."""
        return str(data, "utf-16-be" if big else "utf-16-le", "surrogatepass")

    def encode_wide(text: str, big: bool) -> bytes:
        """The reverse of `decode_wide`."""
        return text.encode("utf-16-be" if big else "utf-16-le", "surrogatepass")

else:
    FAILURES = (TypeError, ValueError, AttributeError, LookupError, OverflowError)

    def packer(form: str) -> "Callable[..., None]":
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

    def unpacker(form: str) -> "Callable[..., tuple[Any, ...]]":
        unpack_from = struct.unpack_from

        def unpack(buffer: "Any", offset: int) -> "tuple[Any, ...]":
            return unpack_from(form, buffer, offset)

        return unpack

    def decode(data: "bytes | bytearray | memoryview") -> str:
        """UTF-8; a byte that is none becomes a question mark: MicroPython's str holds nothing else."""
        try:
            return str(data, "utf-8")
        except ValueError:
            return "".join([chr(byte) if byte < 128 else "?" for byte in data])

    def encode(text: str) -> bytes:
        return text.encode("utf-8")

    def decode_wide(data: "bytes | bytearray | memoryview", big: bool) -> str:
        high, low = (0, 1) if big else (1, 0)
        out = []
        first = 0
        for at in range(0, len(data) - 1, 2):
            unit = data[at + high] << 8 | data[at + low]
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
        form = ">H" if big else "<H"
        for letter in text:
            code = ord(letter)
            if code >= 0x10000:
                code -= 0x10000
                out.extend(struct.pack(form, 0xD800 + (code >> 10)))
                code = 0xDC00 + (code & 0x3FF)
            out.extend(struct.pack(form, code))
        return bytes(out)
