"""ICMP echo. RFC 792. The rest of the message is data, which a reply repeats."""

from roslet.wire.fields import Field

FIELDS = (
    Field("type", 0, 8),
    Field("code", 1, 8),
    Field("checksum", 2, 16),
    Field("identifier", 4, 16),
    Field("sequence", 6, 16),
)
SIZE = 8
ECHO_REPLY, ECHO_REQUEST = 0, 8
