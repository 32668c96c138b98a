"""INFO_DST. RTPS 2.3, 8.3.7.7 (meaning), 9.4.5.8 (bytes).

    0
    guidPrefix

What follows is for this participant only; the prefix of zeros means for whoever gets it.
"""

from roslet.record import Record
from roslet.wire.fields import OCTETS, Field, Fixed
from roslet.wire.rtps.submessage import FLAG_E, INFO_DST, truncated

FIELDS = (Field("guidPrefix", 0, 96, OCTETS),)
_FIXED = Fixed(FIELDS)


class InfoDestination(Record):
    """`guid_prefix`: 12 octets."""

    _fields = ("guid_prefix",)
    __slots__ = _fields

    def __init__(self, guid_prefix: bytes) -> None:
        self.guid_prefix = guid_prefix

    def emit(self, little: bool = True) -> bytearray:
        """16 octets."""
        return _FIXED.emit(little, INFO_DST, FLAG_E if little else 0, 12, self.guid_prefix)


def parse(data: memoryview, at: int, end: int, flags: int) -> InfoDestination:
    """The INFO_DST in data[at:end]. Raises ProtocolError info-dst-truncated."""
    if end - at < 12:
        raise truncated(INFO_DST, end - at, 12)
    return InfoDestination(bytes(data[at : at + 12]))
