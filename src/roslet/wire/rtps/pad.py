"""PAD. RTPS 2.3, 8.3.7.12, 9.4.5.12: any length, no meaning."""

from roslet.record import Record
from roslet.wire.fields import SUBMESSAGE_HEADER, Fixed
from roslet.wire.rtps.submessage import FLAG_E, PAD

FIELDS = ()
_HEADER = Fixed(SUBMESSAGE_HEADER, submessage=False)


class Pad(Record):
    """`size` octets that nobody reads."""

    _fields = ("size",)
    __slots__ = _fields

    def __init__(self, size: int = 0) -> None:
        self.size = size

    def emit(self, little: bool = True) -> bytearray:
        """4 octets and the padding, of zeros."""
        data = _HEADER.emit(little, PAD, FLAG_E if little else 0, self.size)
        data.extend(bytes(self.size))
        return data


def parse(data: memoryview, at: int, end: int, flags: int) -> Pad:
    """The PAD in data[at:end]; nothing can be wrong with it."""
    return Pad(end - at)
