"""DATA. RTPS 2.3, 8.3.7.2 (meaning), 9.4.5.3 (bytes).

    0           2                4         8         12        20
    extraFlags  octetsToInlineQos readerId writerId  writerSN  [inline QoS] [payload]

octetsToInlineQos counts from behind itself; what it skips beyond 16 is from the future and is not looked at.
"""

import struct

from roslet.record import Record
from roslet.wire.fields import INT, OCTETS, Field, Fixed
from roslet.wire.primitives import bytes_packer
from roslet.wire.rtps import parameter_list
from roslet.wire.rtps.submessage import DATA, FLAG_E, INFO_TS, invalid, truncated
from roslet.wire.rtps.times import fraction_of

FLAG_Q = 0x02  # inline QoS is there
FLAG_D = 0x04  # the payload is data
FLAG_K = 0x08  # the payload is a key
FLAG_N = 0x10  # the payload is not in a standard representation

FIELDS = (
    Field("extraFlags", 0, 16),
    Field("octetsToInlineQos", 2, 16),
    Field("readerId", 4, 32, OCTETS),
    Field("writerId", 8, 32, OCTETS),
    Field("writerSN.high", 12, 32, INT),
    Field("writerSN.low", 16, 32),
)
_FIXED = Fixed(FIELDS)
_PARSE = _FIXED.parse
_TO_INLINE_QOS = 16
SIZE = 4 + _FIXED.size
"""Octets of a DATA in front of its payload, without inline QoS."""


class Data(Record):
    """`flags` as above (without FLAG_E and FLAG_Q); entity ids; the sequence number; `inline_qos` is the parameter list with
    its sentinel, empty where there is none; `payload` with its encapsulation header. `little` is the byte order of
    the fixed part and of inline QoS. What `parse` gives has views on the datagram."""

    _fields = ("reader_id", "writer_id", "sequence", "payload", "inline_qos", "flags", "little")
    __slots__ = _fields

    def __init__(
        self,
        reader_id: bytes,
        writer_id: bytes,
        sequence: int,
        payload: "bytes | memoryview" = b"",
        inline_qos: "bytes | memoryview" = b"",
        flags: int = FLAG_D,
        little: bool = True,
    ) -> None:
        self.reader_id = reader_id
        self.writer_id = writer_id
        self.sequence = sequence
        self.payload = payload
        self.inline_qos = inline_qos
        self.flags = flags
        self.little = little

    def emit(self) -> bytes:
        """The submessage, padded to a multiple of 4 so that another may follow."""
        size = len(self.inline_qos) + len(self.payload)
        pad = -size & 3
        front = _FIXED.emit(
            self.little,
            DATA,
            self.flags | (FLAG_Q if self.inline_qos else 0) | (FLAG_E if self.little else 0),
            _FIXED.size + size + pad,
            0,
            _TO_INLINE_QOS,
            self.reader_id,
            self.writer_id,
            self.sequence >> 32,
            self.sequence & 0xFFFFFFFF,
        )
        return b"".join((front, self.inline_qos, self.payload, bytes(pad)))


def parse(data: memoryview, at: int, end: int, flags: int) -> Data:
    """The DATA in data[at:end]; inline QoS and payload are views on it, nothing is copied.

    Raises ProtocolError: data-truncated, data-invalid, and what a parameter list may be wrong in.
    """
    if end - at < 20:
        raise truncated(DATA, end - at, 20)
    _, to_qos, reader_id, writer_id, high, low = _PARSE[flags & 1](data, at)
    sequence = (high << 32) | low
    if sequence <= 0:
        raise invalid(DATA, "sequence number %d" % sequence)
    if flags & 0x0C == 0x0C:
        raise invalid(DATA, "both data and key")
    if to_qos == _TO_INLINE_QOS:
        start = at + 20
    else:
        if to_qos < _TO_INLINE_QOS:
            raise invalid(DATA, "octetsToInlineQos %d" % to_qos)
        start = at + 4 + to_qos
        if start > end:
            raise truncated(DATA, end - at, 4 + to_qos)
    inline_qos: bytes | memoryview = b""
    if flags & FLAG_Q:
        body = parameter_list.skip(data, start, end, flags)
        inline_qos = data[start:body]
        start = body
    # Neither flag means no payload, whatever bytes follow.
    payload: bytes | memoryview = data[start:end] if flags & 0x0C else b""
    return Data(reader_id, writer_id, sequence, payload, inline_qos, flags & 0x1C, flags & 1 == 1)


class Preface:
    """What stands before the payload in a writer's datagrams: header, INFO_DST if directed, INFO_TS and DATA.

    Prepared once, then one `struct` call a sample. Little endian.
    """

    _filled: "bytearray | None" = None

    def __init__(
        self, header: bytes, writer_id: bytes, reader_id: bytes = b"\0\0\0\0", info_dst: bytes = b""
    ) -> None:
        front = bytes(header) + info_dst + bytes((INFO_TS, FLAG_E, 8, 0))
        form = "<%dsIIBBH12siI" % len(front)
        self._pack = bytes_packer(form)
        self._front = front
        self._middle = struct.pack("<HH", 0, _TO_INLINE_QOS) + reader_id + writer_id
        self.size = struct.calcsize(form)

    def emit(
        self, sequence: int, payload_size: int, seconds: int, fraction: int, flags: int = FLAG_D | FLAG_E
    ) -> bytes:
        """The octets in front of a payload of `payload_size` octets (inline QoS counts as part of it; say FLAG_Q then).

        A payload that is too long for the 16-bit length gets length 0, "to the end of the message".
        """
        length = 20 + payload_size
        return self._pack(
            self._front,
            seconds,
            fraction,
            DATA,
            flags,
            length if length < 65536 else 0,
            self._middle,
            sequence >> 32,
            sequence & 0xFFFFFFFF,
        )

    def fill(self, sequence: int, payload_size: int, time: int) -> bytearray:
        """As `emit` of data without inline QoS, at `time` in nanoseconds, where heap is short: in a buffer that the next
        call writes over."""
        data = self._filled
        if data is None:
            data = self._filled = bytearray(self.emit(1, 0, 0, 0))
        at = len(self._front)
        length = 20 + payload_size
        seconds = time // 1000000000 & 0xFFFFFFFF
        struct.pack_into("<IIBBH", data, at, seconds, fraction_of(time), DATA, FLAG_D | FLAG_E, length)
        struct.pack_into("<iI", data, at + 24, sequence >> 32, sequence & 0xFFFFFFFF)
        return data
