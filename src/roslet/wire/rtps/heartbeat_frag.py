"""HEARTBEAT_FRAG. RTPS 2.3, 8.3.7.6 (meaning), 9.4.5.7 (bytes).

0         4         8         16               20
readerId  writerId  writerSN  lastFragmentNum  count
"""

from roslet.record import Record
from roslet.wire.fields import INT, OCTETS, Field, Fixed
from roslet.wire.rtps.submessage import FLAG_E, HEARTBEAT_FRAG, invalid, truncated

FIELDS = (
    Field("readerId", 0, 32, OCTETS),
    Field("writerId", 4, 32, OCTETS),
    Field("writerSN.high", 8, 32, INT),
    Field("writerSN.low", 12, 32),
    Field("lastFragmentNum", 16, 32),
    Field("count", 20, 32),
)
_FIXED = Fixed(FIELDS)
SIZE = 4 + _FIXED.size


class HeartbeatFrag(Record):
    """A writer has fragments 1 to `last_fragment` of sample `sequence`."""

    _fields = ("reader_id", "writer_id", "sequence", "last_fragment", "count")
    __slots__ = _fields

    def __init__(
        self, reader_id: bytes, writer_id: bytes, sequence: int, last_fragment: int, count: int
    ) -> None:
        self.reader_id = reader_id
        self.writer_id = writer_id
        self.sequence = sequence
        self.last_fragment = last_fragment
        self.count = count

    def emit(self, little: bool = True) -> bytearray:
        """28 octets."""
        return _FIXED.emit(
            little,
            HEARTBEAT_FRAG,
            FLAG_E if little else 0,
            _FIXED.size,
            self.reader_id,
            self.writer_id,
            self.sequence >> 32,
            self.sequence & 0xFFFFFFFF,
            self.last_fragment,
            self.count & 0xFFFFFFFF,
        )


def parse(data: memoryview, at: int, end: int, flags: int) -> HeartbeatFrag:
    """The HEARTBEAT_FRAG in data[at:end]. Raises ProtocolError: heartbeat-frag-truncated, heartbeat-frag-invalid."""
    if end - at < _FIXED.size:
        raise truncated(HEARTBEAT_FRAG, end - at, _FIXED.size)
    reader_id, writer_id, high, low, last, count = _FIXED.parse[flags & 1](data, at)
    sequence = (high << 32) | low
    if sequence <= 0 or last == 0:
        raise invalid(HEARTBEAT_FRAG, "sequence number %d, fragment %d" % (sequence, last))
    return HeartbeatFrag(reader_id, writer_id, sequence, last, count)
