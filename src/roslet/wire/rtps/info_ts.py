"""INFO_TS. RTPS 2.3, 8.3.7.10 (meaning), 9.4.5.11 (bytes).

0        4
seconds  fraction       with FLAG_I there is no time, and the submessage is empty
"""

from roslet.record import Record
from roslet.wire.fields import SUBMESSAGE_HEADER, Field, Fixed
from roslet.wire.rtps import times
from roslet.wire.rtps.submessage import FLAG_E, INFO_TS, truncated

FLAG_I = 0x02  # invalidate

FIELDS = (Field("seconds", 0, 32), Field("fraction", 4, 32))
_FIXED = Fixed(FIELDS)
_EMPTY = Fixed(SUBMESSAGE_HEADER, submessage=False)


class InfoTimestamp(Record):
    """`time`: source time of what follows, in nanoseconds of the Unix epoch, or None: no time."""

    _fields = ("time",)
    __slots__ = _fields

    def __init__(self, time: "int | None") -> None:
        self.time = time

    def emit(self, little: bool = True) -> bytearray:
        """12 octets, or 4."""
        order = FLAG_E if little else 0
        if self.time is None:
            return _EMPTY.emit(little, INFO_TS, FLAG_I | order, 0)
        seconds, fraction = times.split(self.time)
        return _FIXED.emit(little, INFO_TS, order, 8, seconds, fraction)


def parse(data: memoryview, at: int, end: int, flags: int) -> InfoTimestamp:
    """The INFO_TS in data[at:end]. Raises ProtocolError info-ts-truncated."""
    if flags & FLAG_I:
        return InfoTimestamp(None)
    if end - at < 8:
        raise truncated(INFO_TS, end - at, 8)
    seconds, fraction = _FIXED.parse[flags & 1](data, at)
    return InfoTimestamp(times.join(seconds, fraction))
