"""The UDP header. RFC 768. A checksum of 0 says that there is none."""

from roslet.wire.fields import Field

FIELDS = (
    Field("source_port", 0, 16),
    Field("destination_port", 2, 16),
    Field("length", 4, 16),
    Field("checksum", 6, 16),
)
SIZE = 8
