"""The Ethernet II header. IEEE 802.3, 3.1.1.

    0            6       12
    destination  source  type

A frame here has no preamble and no frame check sequence; `MIN_SIZE` counts header and padding.
"""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.fields import OCTETS, Field, Fixed

FIELDS = (
    Field("destination", 0, 48, OCTETS),
    Field("source", 6, 48, OCTETS),
    Field("type", 12, 16),
)
SIZE = 14
MIN_SIZE = 60
MTU = 1500
IPV4, ARP = 0x0800, 0x0806
MIN_TYPE = 0x0600  # 3.2.6: what is less is a length
BROADCAST = b"\xff\xff\xff\xff\xff\xff"
_FIXED = Fixed(FIELDS, False)


class Frame(Record):
    """One frame. `payload` may be a view, and has whatever padding came with it."""

    _fields = ("destination", "source", "kind", "payload")
    __slots__ = _fields

    def __init__(
        self, destination: bytes, source: bytes, kind: int, payload: "bytes | bytearray | memoryview"
    ) -> None:
        self.destination = destination
        self.source = source
        self.kind = kind
        self.payload = payload

    def emit(self) -> bytes:
        """Header and payload, padded to MIN_SIZE."""
        front = _FIXED.emit(False, self.destination, self.source, self.kind)
        front.extend(self.payload)
        if len(front) < MIN_SIZE:
            front.extend(bytes(MIN_SIZE - len(front)))
        return bytes(front)


def parse(data: "bytes | bytearray | memoryview") -> Frame:
    """Raises ProtocolError: ethernet-truncated, ethernet-without-type (an IEEE 802.3 length)."""
    if len(data) < SIZE:
        raise ProtocolError("ethernet-truncated", "%d octets, needs %d" % (len(data), SIZE))
    destination, source, kind = _FIXED.parse[0](data, 0)
    if kind < MIN_TYPE:
        raise ProtocolError("ethernet-without-type", "0x%04x" % kind)
    return Frame(destination, source, kind, data[SIZE:])


def is_group(mac: bytes) -> bool:
    """Multicast or broadcast. 3.2.3: the first bit on the wire."""
    return mac[0] & 1 == 1


def octets_of(text: str) -> bytes:
    """Of an address such as "02:00:00:00:00:01". Raises ValueError."""
    parts = text.split(":")
    if len(parts) != 6:
        raise ValueError("no Ethernet address: %r" % text)
    try:
        return bytes([int(part, 16) for part in parts])
    except ValueError:
        raise ValueError("no Ethernet address: %r" % text) from None


def text_of(mac: bytes) -> str:
    """As it is written."""
    return ":".join(["%02x" % octet for octet in mac])
