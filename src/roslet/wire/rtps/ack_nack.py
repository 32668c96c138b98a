"""ACKNACK. RTPS 2.3, 8.3.7.1 (meaning), 9.4.5.2 (bytes).

    0         4         8              8 + n
    readerId  writerId  readerSNState  count

A reader has all samples before the set's base and asks for those in the set.
"""

from roslet.record import Record
from roslet.wire.fields import OCTETS, Field, Fixed
from roslet.wire.primitives import packer, unpacker
from roslet.wire.rtps import number_set
from roslet.wire.rtps.number_set import NumberSet
from roslet.wire.rtps.submessage import ACKNACK, FLAG_E, truncated

FLAG_F = 0x02  # final: no heartbeat is wanted

FIELDS = (Field("readerId", 0, 32, OCTETS), Field("writerId", 4, 32, OCTETS))
_FIXED = Fixed(FIELDS)
_COUNT = (unpacker(">I"), unpacker("<I"))
_EMIT_COUNT = (packer(">I"), packer("<I"))


class AckNack(Record):
    """`state` is the SequenceNumberSet of what is missing."""

    _fields = ("reader_id", "writer_id", "state", "count", "final")
    __slots__ = _fields

    def __init__(
        self, reader_id: bytes, writer_id: bytes, state: NumberSet, count: int, final: bool = False
    ) -> None:
        self.reader_id = reader_id
        self.writer_id = writer_id
        self.state = state
        self.count = count
        self.final = final

    def emit(self, little: bool = True) -> bytearray:
        """28 octets and the bitmap."""
        flags = (FLAG_F if self.final else 0) | (FLAG_E if little else 0)
        size = 12 + self.state.size()
        data = _FIXED.emit(little, ACKNACK, flags, size, self.reader_id, self.writer_id)
        data.extend(self.state.emit(little))
        data.extend(bytes(4))
        _EMIT_COUNT[1 if little else 0](data, size, self.count & 0xFFFFFFFF)
        return data


def parse(data: memoryview, at: int, end: int, flags: int) -> AckNack:
    """The ACKNACK in data[at:end]. Raises ProtocolError: acknack-truncated and what a number set may be wrong in."""
    if end - at < 8:
        raise truncated(ACKNACK, end - at, 8)
    reader_id, writer_id = _FIXED.parse[flags & 1](data, at)
    state, at = number_set.parse(data, at + 8, end, flags)
    if end - at < 4:
        raise truncated(ACKNACK, end - at, 4)
    return AckNack(reader_id, writer_id, state, _COUNT[flags & 1](data, at)[0], flags & FLAG_F != 0)
