"""DATA_FRAG. RTPS 2.3, 8.3.7.3 (meaning), 9.4.5.4 (bytes).

0           2                 4         8         12        20                   24
extraFlags  octetsToInlineQos readerId  writerId  writerSN  fragmentStartingNum  fragmentsInSubmessage
26            28          32
fragmentSize  sampleSize  [inline QoS] [fragments]
"""

from roslet.record import Record
from roslet.wire.fields import INT, OCTETS, Field, Fixed
from roslet.wire.rtps import parameter_list
from roslet.wire.rtps.submessage import DATA_FRAG, FLAG_E, invalid, truncated

FLAG_Q = 0x02
FLAG_K = 0x04  # not the bit it is in DATA
FLAG_N = 0x08

FIELDS = (
    Field("extraFlags", 0, 16),
    Field("octetsToInlineQos", 2, 16),
    Field("readerId", 4, 32, OCTETS),
    Field("writerId", 8, 32, OCTETS),
    Field("writerSN.high", 12, 32, INT),
    Field("writerSN.low", 16, 32),
    Field("fragmentStartingNum", 20, 32),
    Field("fragmentsInSubmessage", 24, 16),
    Field("fragmentSize", 26, 16),
    Field("sampleSize", 28, 32),
)
_FIXED = Fixed(FIELDS)
_TO_INLINE_QOS = 28
SIZE = 4 + _FIXED.size


class DataFrag(Record):
    """Fragments `first` (from 1) to `first + count - 1` of a sample of `sample_size` octets, each of `fragment_size` but the
    sample's last. `payload` holds all of them; `flags` are FLAG_K and FLAG_N. `parse` gives views."""

    _fields = (
        "reader_id",
        "writer_id",
        "sequence",
        "first",
        "count",
        "fragment_size",
        "sample_size",
        "payload",
        "inline_qos",
        "flags",
        "little",
    )
    __slots__ = _fields

    def __init__(
        self,
        reader_id: bytes,
        writer_id: bytes,
        sequence: int,
        first: int,
        count: int,
        fragment_size: int,
        sample_size: int,
        payload: "bytes | memoryview",
        inline_qos: "bytes | memoryview" = b"",
        flags: int = 0,
        little: bool = True,
    ) -> None:
        self.reader_id = reader_id
        self.writer_id = writer_id
        self.sequence = sequence
        self.first = first
        self.count = count
        self.fragment_size = fragment_size
        self.sample_size = sample_size
        self.payload = payload
        self.inline_qos = inline_qos
        self.flags = flags
        self.little = little

    def emit_front(self) -> bytes:
        """The submessage up to the fragments: for a sender that does not copy them. They must be the datagram's end, or
        a multiple of 4 long."""
        front = _FIXED.emit(
            self.little,
            DATA_FRAG,
            self.flags | (FLAG_Q if self.inline_qos else 0) | (FLAG_E if self.little else 0),
            _FIXED.size + len(self.inline_qos) + len(self.payload),
            0,
            _TO_INLINE_QOS,
            self.reader_id,
            self.writer_id,
            self.sequence >> 32,
            self.sequence & 0xFFFFFFFF,
            self.first,
            self.count,
            self.fragment_size,
            self.sample_size,
        )
        return bytes(front) + self.inline_qos

    def emit(self) -> bytes:
        """The whole submessage, unpadded: padding would count as a part of the fragment."""
        return b"".join((self.emit_front(), self.payload))


def parse(data: memoryview, at: int, end: int, flags: int) -> DataFrag:
    """The DATA_FRAG in data[at:end]. Raises ProtocolError: data-frag-truncated, data-frag-invalid, parameter lists'."""
    if end - at < _FIXED.size:
        raise truncated(DATA_FRAG, end - at, _FIXED.size)
    _, to_qos, reader_id, writer_id, high, low, first, count, size, total = _FIXED.parse[flags & 1](data, at)
    sequence = (high << 32) | low
    if sequence <= 0:
        raise invalid(DATA_FRAG, "sequence number %d" % sequence)
    if to_qos < _TO_INLINE_QOS:
        raise invalid(DATA_FRAG, "octetsToInlineQos %d" % to_qos)
    if size == 0 or total == 0 or count == 0 or first == 0:
        raise invalid(
            DATA_FRAG, "fragment %d, %d of %d octets, of a sample of %d" % (first, count, size, total)
        )
    if first + count - 1 > (total + size - 1) // size:
        raise invalid(
            DATA_FRAG, "fragments %d to %d of %d" % (first, first + count - 1, (total + size - 1) // size)
        )
    start = at + 4 + to_qos
    if start > end:
        raise truncated(DATA_FRAG, end - at, 4 + to_qos)
    inline_qos: bytes | memoryview = b""
    if flags & FLAG_Q:
        body = parameter_list.skip(data, start, end, flags)
        inline_qos = data[start:body]
        start = body
    need = min(count * size, total - (first - 1) * size)
    if end - start < need:
        raise truncated(DATA_FRAG, end - start, need)
    return DataFrag(
        reader_id,
        writer_id,
        sequence,
        first,
        count,
        size,
        total,
        data[start : start + need],
        inline_qos,
        flags & 0x0C,
        flags & 1 == 1,
    )
