"""INFO_SRC. RTPS 2.3, 8.3.7.9 (meaning), 9.4.5.10 (bytes).

    0       4        6         8
    unused  version  vendorId  guidPrefix

What follows comes from this participant, not from the one that the message header names.
"""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.fields import OCTETS, Field, Fixed
from roslet.wire.rtps.guid import PROTOCOLVERSION_MAJOR
from roslet.wire.rtps.submessage import FLAG_E, INFO_SRC, truncated

FIELDS = (
    Field("unused", 0, 32),
    Field("version", 4, 16, OCTETS),
    Field("vendorId", 6, 16, OCTETS),
    Field("guidPrefix", 8, 96, OCTETS),
)
_FIXED = Fixed(FIELDS)


class InfoSource(Record):
    """The fields of a message header."""

    _fields = ("version", "vendor_id", "guid_prefix")
    __slots__ = _fields

    def __init__(self, version: bytes, vendor_id: bytes, guid_prefix: bytes) -> None:
        self.version = version
        self.vendor_id = vendor_id
        self.guid_prefix = guid_prefix

    def emit(self, little: bool = True) -> bytearray:
        """24 octets."""
        flags = FLAG_E if little else 0
        return _FIXED.emit(little, INFO_SRC, flags, 20, 0, self.version, self.vendor_id, self.guid_prefix)


def parse(data: memoryview, at: int, end: int, flags: int) -> InfoSource:
    """The INFO_SRC in data[at:end]. Raises ProtocolError: info-src-truncated, version-unsupported."""
    if end - at < 20:
        raise truncated(INFO_SRC, end - at, 20)
    _, version, vendor_id, prefix = _FIXED.parse[flags & 1](data, at)
    if version[0] != PROTOCOLVERSION_MAJOR:
        raise ProtocolError("version-unsupported", "%d.%d" % (version[0], version[1]))
    return InfoSource(version, vendor_id, prefix)
