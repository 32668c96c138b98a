"""GAP. RTPS 2.3, 8.3.7.4 (meaning), 9.4.5.5 (bytes).

    0         4         8         16
    readerId  writerId  gapStart  gapList  [group information, with FLAG_G]

The numbers gapStart .. gapList.base - 1, and those in gapList, will never come.
"""

from roslet.record import Record
from roslet.wire.fields import INT, OCTETS, Field, Fixed
from roslet.wire.rtps import number_set
from roslet.wire.rtps.number_set import NumberSet
from roslet.wire.rtps.submessage import FLAG_E, GAP, invalid, truncated

FLAG_G = 0x02

FIELDS = (
    Field("readerId", 0, 32, OCTETS),
    Field("writerId", 4, 32, OCTETS),
    Field("gapStart.high", 8, 32, INT),
    Field("gapStart.low", 12, 32),
)
_FIXED = Fixed(FIELDS)


class Gap(Record):
    """`start` to `gaps.base - 1`, and the members of `gaps`, are irrelevant to the reader."""

    _fields = ("reader_id", "writer_id", "start", "gaps")
    __slots__ = _fields

    def __init__(self, reader_id: bytes, writer_id: bytes, start: int, gaps: NumberSet) -> None:
        self.reader_id = reader_id
        self.writer_id = writer_id
        self.start = start
        self.gaps = gaps

    def emit(self, little: bool = True) -> bytearray:
        """32 octets and the bitmap."""
        size = 16 + self.gaps.size()
        data = _FIXED.emit(
            little,
            GAP,
            FLAG_E if little else 0,
            size,
            self.reader_id,
            self.writer_id,
            self.start >> 32,
            self.start & 0xFFFFFFFF,
        )
        data.extend(self.gaps.emit(little))
        return data


def parse(data: memoryview, at: int, end: int, flags: int) -> Gap:
    """The GAP in data[at:end]. Raises ProtocolError: gap-truncated, gap-invalid, number sets'."""
    if end - at < 16:
        raise truncated(GAP, end - at, 16)
    reader_id, writer_id, high, low = _FIXED.parse[flags & 1](data, at)
    start = (high << 32) | low
    gaps, at = number_set.parse(data, at + 16, end, flags)
    if start <= 0 or gaps.base < start:
        raise invalid(GAP, "from %d, list from %d" % (start, gaps.base))
    return Gap(reader_id, writer_id, start, gaps)
