"""IGMPv2. RFC 2236, 2. `max_response` is in tenths of a second, in queries."""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.fields import OCTETS, Field, Fixed
from roslet.wire.net.checksum import checksum, total

FIELDS = (
    Field("type", 0, 8),
    Field("max_response", 1, 8),
    Field("checksum", 2, 16),
    Field("group", 4, 32, OCTETS),
)
SIZE = 8
QUERY, REPORT, LEAVE = 0x11, 0x16, 0x17
REPORT_V1 = 0x12  # 2.1: others may still say it so
ALL_HOSTS = b"\xe0\0\0\1"
ALL_ROUTERS = b"\xe0\0\0\2"
ROUTER_ALERT = b"\x94\4\0\0"
"""The IPv4 option that goes with every message. RFC 2113, 2.1."""
_FIXED = Fixed(FIELDS, False)


class Igmp(Record):
    """A message. The group of a general query is 0.0.0.0."""

    _fields = ("kind", "max_response", "group")
    __slots__ = _fields

    def __init__(self, kind: int, max_response: int, group: bytes) -> None:
        self.kind = kind
        self.max_response = max_response
        self.group = group

    def emit(self) -> bytearray:
        """8 octets."""
        found = _FIXED.emit(False, self.kind, self.max_response, 0, self.group)
        value = checksum(found)
        found[2], found[3] = value >> 8, value & 0xFF
        return found


def parse(data: "bytes | bytearray | memoryview") -> Igmp:
    """Of a longer message, such as a query of IGMPv3, the first 8 octets (2.5). Types of other versions are given as they
    are. Raises ProtocolError: igmp-truncated, igmp-checksum."""
    if len(data) < SIZE:
        raise ProtocolError("igmp-truncated", "%d octets, needs %d" % (len(data), SIZE))
    if total(data) != 0xFFFF:
        raise ProtocolError("igmp-checksum")
    kind, max_response, _, group = _FIXED.parse[0](data, 0)
    return Igmp(kind, max_response, group)
