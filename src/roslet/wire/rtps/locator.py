"""Locators: where datagrams go. RTPS 2.3, 9.3.2 (Locator_t), 9.4.2.10 (lists), 9.6.1 (ports)."""

from roslet.errors import ProtocolError
from roslet.record import Names, Record
from roslet.wire.primitives import packer, unpacker

LOCATOR_KIND_INVALID = -1
LOCATOR_KIND_RESERVED = 0
LOCATOR_KIND_UDPv4 = 1
LOCATOR_KIND_UDPv6 = 2
NAMES = Names(
    "locator",
    {
        LOCATOR_KIND_INVALID: "LOCATOR_KIND_INVALID",
        LOCATOR_KIND_RESERVED: "LOCATOR_KIND_RESERVED",
        LOCATOR_KIND_UDPv4: "LOCATOR_KIND_UDPv4",
        LOCATOR_KIND_UDPv6: "LOCATOR_KIND_UDPv6",
        16: "SHM of Fast DDS",
    },
)
SIZE = 24

# 9.6.1.1: PB, DG, PG and the offsets d0 to d3.
_PORT_BASE, _DOMAIN_GAIN, _PARTICIPANT_GAIN = 7400, 250, 2
SPDP_MULTICAST_ADDRESS = b"\xef\xff\x00\x01"
"""239.255.0.1"""
MAX_DOMAIN_ID = 232
"""The last whose ports fit 16 bits."""

# More than any host has interfaces; a peer that lists more would make us send to each.
MAX_LOCATORS = 64

_PARSE = (unpacker(">iI16s"), unpacker("<iI16s"))
_EMIT = (packer(">iI16s"), packer("<iI16s"))
_PARSE_COUNT = (unpacker(">I"), unpacker("<I"))
_EMIT_COUNT = (packer(">I"), packer("<I"))


class Locator(Record):
    """`kind`, `port`, and an `address` of 16 octets, whose last four are an IPv4 address."""

    _fields = ("kind", "port", "address")
    __slots__ = _fields

    def __init__(self, kind: int, port: int, address: bytes) -> None:
        self.kind = kind
        self.port = port
        self.address = address

    def emit(self, little: bool = True) -> bytearray:
        """24 octets."""
        data = bytearray(SIZE)
        _EMIT[1 if little else 0](data, 0, self.kind, self.port, self.address)
        return data

    @property
    def host(self) -> str:
        """The IPv4 address in dotted form."""
        return "%d.%d.%d.%d" % tuple(self.address[12:])

    @property
    def usable(self) -> bool:
        """Whether a datagram can go there: UDPv4, a port and an address."""
        return self.kind == LOCATOR_KIND_UDPv4 and 0 < self.port < 65536 and self.address[12:] != b"\0\0\0\0"

    @property
    def multicast(self) -> bool:
        """Whether this is an IPv4 group."""
        return self.kind == LOCATOR_KIND_UDPv4 and 224 <= self.address[12] < 240

    def __str__(self) -> str:
        if self.kind == LOCATOR_KIND_UDPv4:
            return "%s:%d" % (self.host, self.port)
        return "%s:%d" % (NAMES[self.kind], self.port)


def udp4(host: "str | bytes", port: int) -> Locator:
    """A UDPv4 locator of a dotted address, or of its four octets. Raises ValueError for other text."""
    octets = bytes([int(part) for part in host.split(".")]) if isinstance(host, str) else host
    if len(octets) != 4:
        raise ValueError("%r is no IPv4 address" % host)
    return Locator(LOCATOR_KIND_UDPv4, port, bytes(12) + octets)


def parse(data: "bytes | bytearray | memoryview", at: int, flags: int) -> Locator:
    """The locator at `at`, of any kind; the caller has seen that 24 octets are there."""
    kind, port, address = _PARSE[flags & 1](data, at)
    return Locator(kind, port, address)


def parse_list(
    data: "bytes | bytearray | memoryview", at: int, end: int, flags: int
) -> "tuple[tuple[Locator, ...], int]":
    """A counted list and the offset behind it. Raises ProtocolError: locator-list-truncated, too-many-locators."""
    if end - at < 4:
        raise ProtocolError("locator-list-truncated", "no count")
    count = _PARSE_COUNT[flags & 1](data, at)[0]
    at += 4
    if count > MAX_LOCATORS:
        raise ProtocolError("too-many-locators", "%d, at most %d are taken" % (count, MAX_LOCATORS))
    if end - at < SIZE * count:
        raise ProtocolError("locator-list-truncated", "%d bytes for %d locators" % (end - at, count))
    return tuple([parse(data, at + SIZE * index, flags) for index in range(count)]), at + SIZE * count


def emit_list(locators: "tuple[Locator, ...]", little: bool = True) -> bytes:
    """The count and the locators."""
    count = bytearray(4)
    _EMIT_COUNT[1 if little else 0](count, 0, len(locators))
    return b"".join([count] + [locator.emit(little) for locator in locators])


def metatraffic_multicast_port(domain_id: int) -> int:
    """Where participants announce themselves."""
    return _PORT_BASE + _DOMAIN_GAIN * domain_id


def user_multicast_port(domain_id: int) -> int:
    """Default multicast port of user data."""
    return _PORT_BASE + _DOMAIN_GAIN * domain_id + 1


def metatraffic_unicast_port(domain_id: int, participant_id: int) -> int:
    """Discovery to one participant of a host."""
    return _PORT_BASE + _DOMAIN_GAIN * domain_id + 10 + _PARTICIPANT_GAIN * participant_id


def user_unicast_port(domain_id: int, participant_id: int) -> int:
    """User data to one participant of a host."""
    return _PORT_BASE + _DOMAIN_GAIN * domain_id + 11 + _PARTICIPANT_GAIN * participant_id
