"""ARP for IPv4 over Ethernet. RFC 826."""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.fields import OCTETS, Field, Fixed
from roslet.wire.net.ethernet import IPV4

FIELDS = (
    Field("hardware", 0, 16),
    Field("protocol", 2, 16),
    Field("hardware_size", 4, 8),
    Field("protocol_size", 5, 8),
    Field("operation", 6, 16),
    Field("sender_mac", 8, 48, OCTETS),
    Field("sender_ip", 14, 32, OCTETS),
    Field("target_mac", 18, 48, OCTETS),
    Field("target_ip", 24, 32, OCTETS),
)
SIZE = 28
ETHERNET = 1
REQUEST, REPLY = 1, 2
_SPACE = (ETHERNET, IPV4, 6, 4)
_FIXED = Fixed(FIELDS, False)


class Arp(Record):
    """A question for the owner of `target_ip`, or its answer. Both tell of the sender."""

    _fields = ("operation", "sender_mac", "sender_ip", "target_mac", "target_ip")
    __slots__ = _fields

    def __init__(
        self, operation: int, sender_mac: bytes, sender_ip: bytes, target_mac: bytes, target_ip: bytes
    ) -> None:
        self.operation = operation
        self.sender_mac = sender_mac
        self.sender_ip = sender_ip
        self.target_mac = target_mac
        self.target_ip = target_ip

    def emit(self) -> bytearray:
        """28 octets."""
        return _FIXED.emit(False, *_SPACE, *self._values())  # type: ignore[arg-type]


def parse(data: "bytes | bytearray | memoryview") -> Arp:
    """Padding may follow. Raises ProtocolError: arp-truncated, arp-not-ipv4, arp-operation-unknown."""
    if len(data) < SIZE:
        raise ProtocolError("arp-truncated", "%d octets, needs %d" % (len(data), SIZE))
    values = _FIXED.parse[0](data, 0)
    if values[:4] != _SPACE:
        raise ProtocolError("arp-not-ipv4", "%r, not %r" % (values[:4], _SPACE))
    if values[4] != REQUEST and values[4] != REPLY:
        raise ProtocolError("arp-operation-unknown", "%d" % values[4])
    return Arp(*values[4:])
