"""ICMP echo. RFC 792. The rest of the message is data, which a reply repeats."""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.fields import Field, Fixed
from roslet.wire.net.checksum import checksum, total

FIELDS = (
    Field("type", 0, 8),
    Field("code", 1, 8),
    Field("checksum", 2, 16),
    Field("identifier", 4, 16),
    Field("sequence", 6, 16),
)
SIZE = 8
ECHO_REPLY, ECHO_REQUEST = 0, 8
_FIXED = Fixed(FIELDS, False)


class Echo(Record):
    """A request (ECHO_REQUEST) or its reply."""

    _fields = ("kind", "identifier", "sequence", "data")
    __slots__ = _fields

    def __init__(
        self, kind: int, identifier: int, sequence: int, data: "bytes | bytearray | memoryview" = b""
    ) -> None:
        self.kind = kind
        self.identifier = identifier
        self.sequence = sequence
        self.data = data

    def emit(self) -> bytearray:
        """8 octets and the data."""
        found = _FIXED.emit(False, self.kind, 0, 0, self.identifier, self.sequence)
        found.extend(self.data)
        value = checksum(found)
        found[2], found[3] = value >> 8, value & 0xFF
        return found


def parse(data: "bytes | bytearray | memoryview") -> Echo:
    """Raises ProtocolError: icmp-truncated, icmp-checksum, icmp-not-echo."""
    if len(data) < SIZE:
        raise ProtocolError("icmp-truncated", "%d octets, needs %d" % (len(data), SIZE))
    kind, code, _, identifier, sequence = _FIXED.parse[0](data, 0)
    if total(data) != 0xFFFF:
        raise ProtocolError("icmp-checksum")
    if code != 0 or (kind != ECHO_REQUEST and kind != ECHO_REPLY):
        raise ProtocolError("icmp-not-echo", "type %d, code %d" % (kind, code))
    return Echo(kind, identifier, sequence, data[SIZE:])
