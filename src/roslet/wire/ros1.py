"""ROS 1 serialisation: little endian, no alignment, no terminator. Source: the ROS 1 message description."""

from roslet.wire.cursor import Reader, Sizer, Writer

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def write(message: "Any") -> bytearray:
    """The bytes of `message`. Raises InvalidMessage."""
    writer = Writer("<", 1, 0)
    writer.message(message, message._spec, "")
    return writer.data


def size(message: "Any") -> int:
    """The number of bytes of `message`. Raises InvalidMessage."""
    sizer = Sizer("<", 1, 0)
    sizer.message(message, message._spec, "")
    return sizer.position


def read(kind: "Any", buffer: "Any", start: int, end: int) -> "Any":
    """A message of class `kind` that takes all of buffer[start:end]. Raises MalformedMessage."""
    reader = Reader(buffer, start, start, end, "<", 1, 0)
    message = reader.message(kind, "")
    if reader.position != end:
        raise reader.malformed("%d bytes after the end of the message" % (end - reader.position), "")
    return message
