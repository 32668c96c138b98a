"""ParticipantMessageData: a participant says that it, or its manual writers, are alive. RTPS 2.3, 8.4.13, 9.6.2.1.

encapsulation (4), guidPrefix (12), kind (4, octets), sequence of octets (4 and those)
"""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.primitives import packer, unpacker

KIND_AUTOMATIC_LIVELINESS_UPDATE = b"\x00\x00\x00\x01"
KIND_MANUAL_LIVELINESS_UPDATE = b"\x00\x00\x00\x02"

# The kinds above carry at most one octet; others, which nobody has yet, are not kept beyond this.
MAX_DATA = 1024

_PARSE = (unpacker(">12s4sI"), unpacker("<12s4sI"))
_EMIT = (packer(">12s4sI"), packer("<12s4sI"))


class ParticipantMessage(Record):
    """`guid_prefix` 12 and `kind` 4 octets; `data` is empty for the standard kinds."""

    _fields = ("guid_prefix", "kind", "data")
    __slots__ = _fields

    def __init__(self, guid_prefix: bytes, kind: bytes, data: bytes = b"") -> None:
        self.guid_prefix = guid_prefix
        self.kind = kind
        self.data = data

    def emit(self, little: bool = True) -> bytes:
        """The serialised payload."""
        body = bytearray(20)
        _EMIT[1 if little else 0](body, 0, self.guid_prefix, self.kind, len(self.data))
        return (b"\0\1\0\0" if little else b"\0\0\0\0") + bytes(body) + self.data


def parse(payload: "bytes | bytearray | memoryview") -> ParticipantMessage:
    """The value of a serialised payload.

    Raises ProtocolError: participant-message-truncated, participant-message-invalid.
    """
    if len(payload) < 24:
        raise ProtocolError("participant-message-truncated", "%d bytes" % len(payload))
    if payload[0] != 0 or payload[1] > 1:
        raise ProtocolError("participant-message-invalid", "encapsulation %d.%d" % (payload[0], payload[1]))
    prefix, kind, length = _PARSE[payload[1]](payload, 4)
    if length > MAX_DATA:
        raise ProtocolError("participant-message-invalid", "%d octets of data" % length)
    if length > len(payload) - 24:
        raise ProtocolError(
            "participant-message-truncated", "%d of %d octets of data" % (len(payload) - 24, length)
        )
    return ParticipantMessage(prefix, kind, bytes(payload[24 : 24 + length]))
