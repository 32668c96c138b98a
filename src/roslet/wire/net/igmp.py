"""IGMPv2. RFC 2236, 2. `max_response` is in tenths of a second, in queries."""

from roslet.wire.fields import OCTETS, Field

FIELDS = (
    Field("type", 0, 8),
    Field("max_response", 1, 8),
    Field("checksum", 2, 16),
    Field("group", 4, 32, OCTETS),
)
SIZE = 8
QUERY, REPORT, LEAVE = 0x11, 0x16, 0x17
