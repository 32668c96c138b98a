"""The IPv4 header. RFC 791, 3.1. Options may follow its 20 octets.

`version_ihl` is 4 bits of version and 4 of header length in words; `flags_fragment` is 3 bits of flags and 13 of fragment
offset in units of 8 octets.
"""

from roslet.wire.fields import OCTETS, Field

FIELDS = (
    Field("version_ihl", 0, 8),
    Field("dscp_ecn", 1, 8),
    Field("total_length", 2, 16),
    Field("identification", 4, 16),
    Field("flags_fragment", 6, 16),
    Field("ttl", 8, 8),
    Field("protocol", 9, 8),
    Field("checksum", 10, 16),
    Field("source", 12, 32, OCTETS),
    Field("destination", 16, 32, OCTETS),
)
SIZE = 20
DONT_FRAGMENT, MORE_FRAGMENTS = 0x4000, 0x2000
ICMP, IGMP, UDP = 1, 2, 17
