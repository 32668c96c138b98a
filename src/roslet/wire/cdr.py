"""CDR: version 1 in both byte orders to read and write, and plain version 2 to read.

Sources: OMG CORBA 3.0 15.3 (CDR), DDSI-RTPS 2.5 section 10 (encapsulation), DDS-XTypes 1.3 section 7.4
(version 2).

    encapsulation = two bytes of representation identifier, two bytes of options, then the body
    the two low bits of the options count the padding bytes after the body

What follows the body is not looked at, as in every DDS: writers pad to a multiple of 4 with or without saying
so, and rclpy's `serialize_message` leaves as many bytes behind the body as it overestimated its size.
"""

from roslet.errors import MalformedMessage
from roslet.record import Names
from roslet.wire.cursor import Reader, Sizer, Writer

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

HEADER_SIZE = 4
"""Bytes of the encapsulation header; alignment counts from behind it."""

CDR_BE = 0x0000
CDR_LE = 0x0001
PL_CDR_BE = 0x0002
PL_CDR_LE = 0x0003
CDR2_BE = 0x0006
CDR2_LE = 0x0007
D_CDR2_BE = 0x0008
D_CDR2_LE = 0x0009
PL_CDR2_BE = 0x000A
PL_CDR2_LE = 0x000B

REPRESENTATIONS = Names(
    "representation",
    {
        CDR_BE: "CDR_BE",
        CDR_LE: "CDR_LE",
        PL_CDR_BE: "PL_CDR_BE",
        PL_CDR_LE: "PL_CDR_LE",
        CDR2_BE: "CDR2_BE",
        CDR2_LE: "CDR2_LE",
        D_CDR2_BE: "D_CDR2_BE",
        D_CDR2_LE: "D_CDR2_LE",
        PL_CDR2_BE: "PL_CDR2_BE",
        PL_CDR2_LE: "PL_CDR2_LE",
    },
)

# representation -> byte order, largest alignment
_PLAIN = {CDR_BE: (">", 8), CDR_LE: ("<", 8), CDR2_BE: (">", 4), CDR2_LE: ("<", 4)}


def write(message: "Any", representation: int = CDR_LE) -> bytearray:
    """The encapsulation header and body of `message`, in one of the four plain representations. Raises
    InvalidMessage."""
    order, largest = _PLAIN[representation]
    writer = Writer(order, largest, 1)
    writer.message(message, message._spec, "")
    return bytearray((representation >> 8, representation & 255, 0, 0)) + writer.data


def size(message: "Any") -> int:
    """The number of bytes of `message` in CDR version 1, with the encapsulation header. Raises
    InvalidMessage."""
    sizer = Sizer("<", 8, 1)
    sizer.message(message, message._spec, "")
    return sizer.position + HEADER_SIZE


def read(kind: "Any", buffer: "Any", start: int, end: int) -> "Any":
    """A message of class `kind` from buffer[start:end], which begins with the encapsulation header.

    Bytes after the body are ignored. Raises MalformedMessage.
    """
    if end - start < HEADER_SIZE:
        raise MalformedMessage("%d bytes are too few for an encapsulation header" % (end - start))
    representation = buffer[start] << 8 | buffer[start + 1]
    if representation not in _PLAIN:
        raise MalformedMessage("cannot read encapsulation " + REPRESENTATIONS[representation])
    order, largest = _PLAIN[representation]
    reader = Reader(buffer, start, start + HEADER_SIZE, end, order, largest, 1)
    return reader.message(kind, "")
