"""The UDP header. RFC 768. A checksum of 0 says that there is none."""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.fields import Field, Fixed
from roslet.wire.net.checksum import checksum, total
from roslet.wire.net.ipv4 import UDP

FIELDS = (
    Field("source_port", 0, 16),
    Field("destination_port", 2, 16),
    Field("length", 4, 16),
    Field("checksum", 6, 16),
)
SIZE = 8
_FIXED = Fixed(FIELDS, False)


def _pseudo_header(source: bytes, destination: bytes, length: int) -> int:
    """The sum over the addresses, the protocol and the length."""
    return total(source + destination) + UDP + length


class Datagram(Record):
    """What goes from port to port."""

    _fields = ("source_port", "destination_port", "payload")
    __slots__ = _fields

    def __init__(
        self, source_port: int, destination_port: int, payload: "bytes | bytearray | memoryview"
    ) -> None:
        self.source_port = source_port
        self.destination_port = destination_port
        self.payload = payload

    def emit(self, source: bytes, destination: bytes) -> bytearray:
        """Between these addresses, with a checksum."""
        length = SIZE + len(self.payload)
        found = _FIXED.emit(False, self.source_port, self.destination_port, length, 0)
        found.extend(self.payload)
        value = checksum(found, _pseudo_header(source, destination, length)) or 0xFFFF
        found[6], found[7] = value >> 8, value & 0xFF
        return found


def parse(data: "bytes | bytearray | memoryview", source: bytes, destination: bytes) -> Datagram:
    """What came between these addresses; octets behind its length are left out. Raises ProtocolError: udp-truncated,
    udp-length, udp-checksum."""
    if len(data) < SIZE:
        raise ProtocolError("udp-truncated", "%d octets, needs %d" % (len(data), SIZE))
    source_port, destination_port, length, value = _FIXED.parse[0](data, 0)
    if length < SIZE or length > len(data):
        raise ProtocolError("udp-length", "%d of %d octets" % (length, len(data)))
    if value and total(data[:length], _pseudo_header(source, destination, length)) != 0xFFFF:
        raise ProtocolError("udp-checksum")
    return Datagram(source_port, destination_port, data[SIZE:length])
