"""Fixed headers, described once: name, byte offset, width, kind.

The same table gives this codec its `struct` formats and the gateware its header readers and writers. Offsets count from the
start of a header; in RTPS submessages (2.3, 9.4) from the end of the submessage header.
"""

from roslet.record import Record
from roslet.wire.primitives import packer, unpacker

UINT, INT, OCTETS = 0, 1, 2
"""Kinds: integers follow the endianness flag of the submessage, octets never do."""

_FORMATS = {(8, UINT): "B", (16, UINT): "H", (32, UINT): "I", (16, INT): "h", (32, INT): "i"}


class Field(Record):
    """One field of a fixed header. `offset` in bytes, `bits` wide; `kind` is UINT, INT or OCTETS."""

    _fields = ("name", "offset", "bits", "kind")
    __slots__ = _fields

    def __init__(self, name: str, offset: int, bits: int, kind: int = UINT) -> None:
        self.name = name
        self.offset = offset
        self.bits = bits
        self.kind = kind


def struct_format(fields: "tuple[Field, ...]") -> str:
    """The `struct` format, without byte order. Raises ValueError where offsets leave a gap or overlap."""
    at = 0
    form = ""
    for field in fields:
        if field.offset != at:
            raise ValueError("%s is at %d, not at %d" % (field.name, field.offset, at))
        form += "%ds" % (field.bits // 8) if field.kind == OCTETS else _FORMATS[(field.bits, field.kind)]
        at += field.bits // 8
    return form


SUBMESSAGE_HEADER = (
    Field("submessageId", 0, 8),
    Field("flags", 1, 8),
    Field("octetsToNextHeader", 2, 16),
)
"""9.4.5.1. The length follows the endianness flag, which is bit 0 of `flags`."""

LENGTH = (unpacker(">H"), unpacker("<H"))
"""LENGTH[flags & 1](buffer, offset) is the one-tuple of a submessage's length."""


class Fixed:
    """The codec of one field table: `parse[flags & 1](buffer, offset)` is the tuple of values."""

    def __init__(self, fields: "tuple[Field, ...]", submessage: bool = True) -> None:
        form = struct_format(fields)
        last = fields[-1]
        self.fields = fields
        self.size = last.offset + last.bits // 8
        self.parse = (unpacker(">" + form), unpacker("<" + form))
        front = "BBH" if submessage else ""
        self._emit = (packer(">" + front + form), packer("<" + front + form))
        self._front = 4 if submessage else 0

    def emit(self, little: bool, *values: "int | bytes") -> bytearray:
        """Exactly the fixed part, with the submessage header's three values first where there is one."""
        data = bytearray(self._front + self.size)
        self._emit[1 if little else 0](data, 0, *values)
        return data
