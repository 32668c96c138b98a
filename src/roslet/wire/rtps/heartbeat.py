"""HEARTBEAT. RTPS 2.3, 8.3.7.5 (meaning), 9.4.5.6 (bytes).

    0         4         8        16      24
    readerId  writerId  firstSN  lastSN  count  [group information, with FLAG_G]

A writer tells which samples it has: firstSN to lastSN, or none where lastSN is firstSN - 1.
"""

from roslet.record import Record
from roslet.wire.fields import INT, OCTETS, Field, Fixed
from roslet.wire.rtps.submessage import FLAG_E, HEARTBEAT, invalid, truncated

FLAG_F = 0x02  # final: no answer is needed
FLAG_L = 0x04  # liveliness was asserted
FLAG_G = 0x08  # group information follows; it is skipped

FIELDS = (
    Field("readerId", 0, 32, OCTETS),
    Field("writerId", 4, 32, OCTETS),
    Field("firstSN.high", 8, 32, INT),
    Field("firstSN.low", 12, 32),
    Field("lastSN.high", 16, 32, INT),
    Field("lastSN.low", 20, 32),
    Field("count", 24, 32),
)
_FIXED = Fixed(FIELDS)
SIZE = 4 + _FIXED.size


class Heartbeat(Record):
    """`first` and `last` sequence number; `count` grows with every heartbeat (modulo 2**32)."""

    _fields = ("reader_id", "writer_id", "first", "last", "count", "final", "liveliness")
    __slots__ = _fields

    def __init__(
        self,
        reader_id: bytes,
        writer_id: bytes,
        first: int,
        last: int,
        count: int,
        final: bool = False,
        liveliness: bool = False,
    ) -> None:
        self.reader_id = reader_id
        self.writer_id = writer_id
        self.first = first
        self.last = last
        self.count = count
        self.final = final
        self.liveliness = liveliness

    def emit(self, little: bool = True) -> bytearray:
        """32 octets."""
        flags = (FLAG_F if self.final else 0) | (FLAG_L if self.liveliness else 0) | (FLAG_E if little else 0)
        return _FIXED.emit(
            little,
            HEARTBEAT,
            flags,
            _FIXED.size,
            self.reader_id,
            self.writer_id,
            self.first >> 32,
            self.first & 0xFFFFFFFF,
            self.last >> 32,
            self.last & 0xFFFFFFFF,
            self.count & 0xFFFFFFFF,
        )


def parse(data: memoryview, at: int, end: int, flags: int) -> Heartbeat:
    """The HEARTBEAT in data[at:end]. Raises ProtocolError: heartbeat-truncated, heartbeat-invalid."""
    if end - at < _FIXED.size:
        raise truncated(HEARTBEAT, end - at, _FIXED.size)
    reader_id, writer_id, first_high, first_low, last_high, last_low, count = _FIXED.parse[flags & 1](
        data, at
    )
    first = (first_high << 32) | first_low
    last = (last_high << 32) | last_low
    if first <= 0 or last < first - 1:
        raise invalid(HEARTBEAT, "from %d to %d" % (first, last))
    return Heartbeat(reader_id, writer_id, first, last, count, flags & FLAG_F != 0, flags & FLAG_L != 0)
