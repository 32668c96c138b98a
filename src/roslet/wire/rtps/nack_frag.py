"""NACK_FRAG. RTPS 2.3, 8.3.7.11 (meaning), 9.4.5.13 (bytes).

    0         4         8         16                   16 + n
    readerId  writerId  writerSN  fragmentNumberState  count

A reader asks for the fragments in the set; unlike ACKNACK's, the base acknowledges nothing.
"""

from roslet.record import Record
from roslet.wire.fields import INT, OCTETS, Field, Fixed
from roslet.wire.primitives import packer, unpacker
from roslet.wire.rtps import number_set
from roslet.wire.rtps.number_set import NumberSet
from roslet.wire.rtps.submessage import FLAG_E, NACK_FRAG, invalid, truncated

FIELDS = (
    Field("readerId", 0, 32, OCTETS),
    Field("writerId", 4, 32, OCTETS),
    Field("writerSN.high", 8, 32, INT),
    Field("writerSN.low", 12, 32),
)
_FIXED = Fixed(FIELDS)
_COUNT = (unpacker(">I"), unpacker("<I"))
_EMIT_COUNT = (packer(">I"), packer("<I"))


class NackFrag(Record):
    """`state` is the FragmentNumberSet of what is missing of sample `sequence`."""

    _fields = ("reader_id", "writer_id", "sequence", "state", "count")
    __slots__ = _fields

    def __init__(
        self, reader_id: bytes, writer_id: bytes, sequence: int, state: NumberSet, count: int
    ) -> None:
        self.reader_id = reader_id
        self.writer_id = writer_id
        self.sequence = sequence
        self.state = state
        self.count = count

    def emit(self, little: bool = True) -> bytearray:
        """32 octets and the bitmap."""
        size = 20 + self.state.size(True)
        data = _FIXED.emit(
            little,
            NACK_FRAG,
            FLAG_E if little else 0,
            size,
            self.reader_id,
            self.writer_id,
            self.sequence >> 32,
            self.sequence & 0xFFFFFFFF,
        )
        data.extend(self.state.emit(little, True))
        data.extend(bytes(4))
        _EMIT_COUNT[1 if little else 0](data, size, self.count & 0xFFFFFFFF)
        return data


def parse(data: memoryview, at: int, end: int, flags: int) -> NackFrag:
    """The NACK_FRAG in data[at:end]. Raises ProtocolError: nack-frag-truncated, nack-frag-invalid, number sets'."""
    if end - at < 16:
        raise truncated(NACK_FRAG, end - at, 16)
    reader_id, writer_id, high, low = _FIXED.parse[flags & 1](data, at)
    sequence = (high << 32) | low
    if sequence <= 0:
        raise invalid(NACK_FRAG, "sequence number %d" % sequence)
    state, at = number_set.parse(data, at + 16, end, flags, True)
    if end - at < 4:
        raise truncated(NACK_FRAG, end - at, 4)
    return NackFrag(reader_id, writer_id, sequence, state, _COUNT[flags & 1](data, at)[0])
