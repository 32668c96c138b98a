"""The IPv4 header. RFC 791, 3.1. Options may follow its 20 octets.

`version_ihl` is 4 bits of version and 4 of header length in words; `flags_fragment` is 3 bits of flags and 13 of fragment
offset in units of 8 octets.
"""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.fields import OCTETS, Field, Fixed
from roslet.wire.net.checksum import checksum, total

FIELDS = (
    Field("version_ihl", 0, 8),
    Field("dscp_ecn", 1, 8),
    Field("total_length", 2, 16),
    Field("identification", 4, 16),
    Field("flags_fragment", 6, 16),
    Field("ttl", 8, 8),
    Field("protocol", 9, 8),
    Field("checksum", 10, 16),
    Field("source", 12, 32, OCTETS),
    Field("destination", 16, 32, OCTETS),
)
SIZE = 20
DONT_FRAGMENT, MORE_FRAGMENTS = 0x4000, 0x2000
ICMP, IGMP, UDP = 1, 2, 17
MAX_OPTIONS = 40
MAX_TOTAL_LENGTH = 0xFFFF
DEFAULT_TTL = 64  # RFC 1340
_OFFSET = 0x1FFF
_FIXED = Fixed(FIELDS, False)


class Packet(Record):
    """A datagram or, with `offset` (in octets) or `more`, a fragment of one. `options` have a multiple of 4 octets."""

    _fields = (
        "source",
        "destination",
        "protocol",
        "payload",
        "identification",
        "ttl",
        "offset",
        "more",
        "dont_fragment",
        "options",
    )
    __slots__ = _fields

    def __init__(
        self,
        source: bytes,
        destination: bytes,
        protocol: int,
        payload: "bytes | bytearray | memoryview",
        identification: int = 0,
        ttl: int = DEFAULT_TTL,
        offset: int = 0,
        more: bool = False,
        dont_fragment: bool = False,
        options: "bytes | bytearray | memoryview" = b"",
    ) -> None:
        self.source = source
        self.destination = destination
        self.protocol = protocol
        self.payload = payload
        self.identification = identification
        self.ttl = ttl
        self.offset = offset
        self.more = more
        self.dont_fragment = dont_fragment
        self.options = options

    @property
    def is_fragment(self) -> bool:
        return self.more or self.offset != 0

    def size(self) -> int:
        """Octets with the header."""
        return SIZE + len(self.options) + len(self.payload)

    def emit(self) -> bytearray:
        """Header and payload. Raises ValueError for what no header can say."""
        size = self.size()
        if size > MAX_TOTAL_LENGTH:
            raise ValueError("an IPv4 datagram has at most %d octets, not %d" % (MAX_TOTAL_LENGTH, size))
        if len(self.options) > MAX_OPTIONS or len(self.options) & 3:
            raise ValueError("options of %d octets" % len(self.options))
        if self.offset & 7 or self.offset >> 3 > _OFFSET:
            raise ValueError("no fragment begins at octet %d" % self.offset)
        flags = (DONT_FRAGMENT if self.dont_fragment else 0) | (MORE_FRAGMENTS if self.more else 0)
        found = _FIXED.emit(
            False,
            0x40 | (SIZE + len(self.options)) >> 2,
            0,
            size,
            self.identification,
            flags | self.offset >> 3,
            self.ttl,
            self.protocol,
            0,
            self.source,
            self.destination,
        )
        found.extend(self.options)
        value = checksum(found)
        found[10], found[11] = value >> 8, value & 0xFF
        found.extend(self.payload)
        return found


def parse(data: "bytes | bytearray | memoryview") -> Packet:
    """Octets behind the total length are left out. Raises ProtocolError: ipv4-truncated, ipv4-version,
    ipv4-header-length, ipv4-total-length, ipv4-checksum, ipv4-fragment-length (not the last, and no multiple of 8),
    ipv4-fragment-beyond-end."""
    if len(data) < SIZE:
        raise ProtocolError("ipv4-truncated", "%d octets, needs %d" % (len(data), SIZE))
    (
        version_ihl,
        _,
        length,
        identification,
        flags,
        ttl,
        protocol,
        _,
        source,
        destination,
    ) = _FIXED.parse[0](data, 0)
    header = (version_ihl & 15) << 2
    if version_ihl >> 4 != 4:
        raise ProtocolError("ipv4-version", "%d" % (version_ihl >> 4))
    if header < SIZE:
        raise ProtocolError("ipv4-header-length", "%d octets" % header)
    if length < header or length > len(data):
        raise ProtocolError("ipv4-total-length", "%d of %d octets" % (length, len(data)))
    if total(data[:header]) != 0xFFFF:
        raise ProtocolError("ipv4-checksum")
    offset = (flags & _OFFSET) << 3
    more = flags & MORE_FRAGMENTS != 0
    if more and ((length - header) & 7 or length == header):
        raise ProtocolError("ipv4-fragment-length", "%d octets, and more to come" % (length - header))
    if offset + length > MAX_TOTAL_LENGTH:
        raise ProtocolError("ipv4-fragment-beyond-end", "%d octets at %d" % (length - header, offset))
    return Packet(
        source,
        destination,
        protocol,
        data[header:length],
        identification,
        ttl,
        offset,
        more,
        flags & DONT_FRAGMENT != 0,
        data[SIZE:header],
    )


def fragments(packet: Packet, mtu: int) -> "list[Packet]":
    """A packet in parts of at most `mtu` octets, headers counted; itself where it fits. RFC 791, 3.2.

    Raises ValueError where it may not be divided, or has options.
    """
    if packet.size() <= mtu:
        return [packet]
    if packet.dont_fragment or len(packet.options):
        raise ValueError("%d octets that may not be divided, over %d" % (packet.size(), mtu))
    step = (mtu - SIZE) & ~7
    if step <= 0:
        raise ValueError("nothing fits %d octets" % mtu)
    payload = memoryview(packet.payload)
    found = []
    for at in range(0, len(payload), step):
        last = at + step >= len(payload)
        part = payload[at : at + step]
        found.append(packet.replace(payload=part, offset=packet.offset + at, more=packet.more or not last))
    return found


def multicast_mac(group: bytes) -> bytes:
    """The Ethernet address of a group: 01:00:5e and its low 23 bits. RFC 1112, 6.4."""
    return b"\x01\x00\x5e" + bytes([group[1] & 0x7F]) + group[2:4]


def is_multicast(address: bytes) -> bool:
    """224.0.0.0 to 239.255.255.255. RFC 1112, 4."""
    return address[0] >> 4 == 14


def octets_of(text: str) -> bytes:
    """Of an address such as "192.168.1.2". Raises ValueError."""
    parts = text.split(".")
    try:
        octets = [int(part) for part in parts]
        if len(octets) != 4 or min(octets) < 0 or max(octets) > 255:
            raise ValueError
    except ValueError:
        raise ValueError("no IPv4 address: %r" % text) from None
    return bytes(octets)


def text_of(address: bytes) -> str:
    """As it is written."""
    return "%d.%d.%d.%d" % (address[0], address[1], address[2], address[3])
