"""The message header. RTPS 2.3, 8.3.3.1 (meaning), 9.4.4 (bytes).

0      4        6         8           20
RTPS   version  vendorId  guidPrefix
"""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.fields import OCTETS, Field, Fixed
from roslet.wire.rtps.guid import PROTOCOLVERSION, PROTOCOLVERSION_MAJOR, VENDORID_ROSLET

FIELDS = (
    Field("protocol", 0, 32, OCTETS),
    Field("version", 4, 16, OCTETS),
    Field("vendorId", 6, 16, OCTETS),
    Field("guidPrefix", 8, 96, OCTETS),
)
_FIXED = Fixed(FIELDS, submessage=False)
SIZE = 20
PROTOCOL_RTPS = b"RTPS"


class Header(Record):
    """Who sent a message: protocol version and vendor id (2 octets each), GUID prefix (12 octets)."""

    _fields = ("version", "vendor_id", "guid_prefix")
    __slots__ = _fields

    def __init__(self, version: bytes, vendor_id: bytes, guid_prefix: bytes) -> None:
        self.version = version
        self.vendor_id = vendor_id
        self.guid_prefix = guid_prefix

    def emit(self) -> bytearray:
        """20 octets."""
        return _FIXED.emit(True, PROTOCOL_RTPS, self.version, self.vendor_id, self.guid_prefix)


def own(guid_prefix: bytes) -> bytes:
    """The header of our own messages."""
    return bytes(Header(PROTOCOLVERSION, VENDORID_ROSLET, guid_prefix).emit())


def parse(data: "bytes | bytearray | memoryview") -> Header:
    """The header at the start of a datagram. A later minor version is accepted (8.6.1).

    Raises ProtocolError: message-truncated, not-rtps, version-unsupported.
    """
    if len(data) < SIZE:
        raise ProtocolError("message-truncated", "%d bytes, a header has %d" % (len(data), SIZE))
    protocol, version, vendor_id, prefix = _FIXED.parse[1](data, 0)
    if protocol != PROTOCOL_RTPS:
        raise ProtocolError("not-rtps")
    if version[0] != PROTOCOLVERSION_MAJOR:
        raise ProtocolError("version-unsupported", "%d.%d" % (version[0], version[1]))
    return Header(version, vendor_id, prefix)
