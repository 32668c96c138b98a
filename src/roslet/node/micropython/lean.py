"""What generated code falls back on in a bundle without the exact codec: `roslet.wire.message.rescue_read` and
`rescue_write` in a few lines. They say less of what is wrong, and read little-endian CDR only."""

from roslet.errors import InvalidMessage, MalformedMessage
from roslet.node.micropython import bounds
from roslet.wire.message import BufferTooSmall

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


def rescue_write(message: "Any", buffer: "Any", offset: int, parts: "Any", error: Exception) -> int:
    """Raises BufferTooSmall, with a size to try next, or InvalidMessage."""
    if isinstance(error, InvalidMessage):
        raise error
    size = message._fixed_size or 2 * len(buffer)
    if isinstance(error, (ValueError, IndexError)) and offset + size > len(buffer) < bounds.MAX_MESSAGE:
        raise BufferTooSmall(size)
    raise InvalidMessage("%s: %s" % (message._type, error))


def rescue_read(kind: "Any", buffer: "Any", start: int, end: int) -> "Any":
    """Raises MalformedMessage."""
    raise MalformedMessage("no %s" % kind._type, end - start)
