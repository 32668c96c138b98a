"""The network interfaces of this host, and word of their changes. IPv4 only.

On Linux the kernel is asked over rtnetlink. Elsewhere only the address that the default route leaves by is found, and
changes show when it is asked again.
"""

from __future__ import annotations

import socket
import struct

from roslet.errors import Unreachable
from roslet.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence

LOOPBACK = "127.0.0.1"
# Addresses that are used at once: Linux lets one socket join 20 groups, and each costs a datagram at every announcement.
MAX_ADDRESSES = 16
# Reads of 64 KiB from the kernel until it must have said everything: some 50,000 addresses.
MAX_READS = 64

# linux/netlink.h and linux/rtnetlink.h
_REQUEST_DUMP = 0x301
_ERROR, _DONE = 2, 3
_NEWADDR, _GETADDR = 20, 22
_ADDRESS, _LOCAL = 1, 2
_GROUPS = 0x1 | 0x10  # links, IPv4 addresses
_HEADER = struct.Struct("=IHHII")  # length, type, flags, sequence, port
_IFADDR = struct.Struct("=BBBBI")  # family, prefix, flags, scope, interface index
_ATTRIBUTE = struct.Struct("=HH")  # length, type
# linux/if.h, linux/sockios.h
_SIOCGIFFLAGS = 0x8913
_UP, _LOOPBACK, _RUNNING, _MULTICAST = 0x1, 0x8, 0x40, 0x1000


class Interface(Record):
    """One IPv4 address of an interface. `number`: the kernel's index, 0 where it is not known; `bits`: the prefix length."""

    _fields = ("name", "number", "address", "bits", "multicast")
    __slots__ = _fields

    def __init__(self, name: str, number: int, address: str, bits: int, multicast: bool) -> None:
        self.name = name
        self.number = number
        self.address = address
        self.bits = bits
        self.multicast = multicast

    @property
    def loopback(self) -> bool:
        return self.address.startswith("127.")


def interfaces() -> list[Interface]:
    """Every IPv4 address of the interfaces that are up and connected; loopback last."""
    try:
        found = _from_netlink()
    except (OSError, AttributeError, ImportError):
        found = _from_default_route()
    found.sort(key=lambda one: one.loopback)
    return found


def choose(found: Sequence[Interface], wanted: Sequence[str]) -> list[Interface]:
    """Those of the names or addresses in `wanted`; where it is empty all but loopback, or loopback if there is no other."""
    if wanted:
        chosen = [one for one in found if one.name in wanted or one.address in wanted]
    else:
        chosen = [one for one in found if not one.loopback] or [one for one in found if one.loopback]
    return chosen[:MAX_ADDRESSES]


def require(found: Sequence[Interface], wanted: Sequence[str]) -> None:
    """Raises Unreachable where one of `wanted` is not there."""
    for one in wanted:
        if not choose(found, [one]):
            there = ", ".join(f"{each.name} ({each.address})" for each in found) or "none"
            raise Unreachable(f"no interface {one} with an IPv4 address is up; there are: {there}")


def _from_netlink() -> list[Interface]:
    import fcntl

    found: list[Interface] = []
    with (
        socket.socket(socket.AF_NETLINK, socket.SOCK_RAW, socket.NETLINK_ROUTE) as netlink,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe,
    ):
        netlink.settimeout(1.0)
        size = _HEADER.size + _IFADDR.size
        netlink.send(
            _HEADER.pack(size, _GETADDR, _REQUEST_DUMP, 1, 0) + _IFADDR.pack(socket.AF_INET, 0, 0, 0, 0)
        )
        for _ in range(MAX_READS):
            rows, done = parse_addresses(netlink.recv(65536))
            for index, address, bits in rows:
                try:
                    name = socket.if_indextoname(index)
                    request = struct.pack("16sH14x", name.encode(), 0)
                    flags = struct.unpack_from("H", fcntl.ioctl(probe.fileno(), _SIOCGIFFLAGS, request), 16)[
                        0
                    ]
                except OSError:
                    continue  # it went meanwhile
                if flags & _UP and flags & _RUNNING:
                    joins = bool(flags & (_MULTICAST | _LOOPBACK))
                    found.append(Interface(name, index, address, bits, joins))
            if done:
                return found
    return found


def parse_addresses(data: bytes) -> tuple[list[tuple[int, str, int]], bool]:
    """(interface index, address, prefix length) of each IPv4 address in netlink messages; whether they are the last.

    Never raises: what is cut short or makes no sense ends the list.
    """
    found: list[tuple[int, str, int]] = []
    at = 0
    while at + _HEADER.size <= len(data):
        size, kind = _HEADER.unpack_from(data, at)[:2]
        end = at + size
        if size < _HEADER.size or end > len(data) or kind in (_ERROR, _DONE):
            return found, True
        if kind == _NEWADDR and size >= _HEADER.size + _IFADDR.size:
            family, bits, _, _, index = _IFADDR.unpack_from(data, at + _HEADER.size)
            address = _address_of(data, at + _HEADER.size + _IFADDR.size, end)
            if family == socket.AF_INET and address and bits <= 32:
                found.append((index, address, bits))
        at += (size + 3) & ~3
    return found, False


def _address_of(data: bytes, at: int, end: int) -> str:
    """The local address among attributes; of a point-to-point link the other one is the far end's."""
    found = b""
    while at + _ATTRIBUTE.size <= end:
        size, kind = _ATTRIBUTE.unpack_from(data, at)
        if size < _ATTRIBUTE.size or at + size > end:
            break
        value = data[at + _ATTRIBUTE.size : at + size]
        if len(value) == 4 and (kind == _LOCAL or (kind == _ADDRESS and not found)):
            found = value
        at += (size + 3) & ~3
    return socket.inet_ntoa(found) if found else ""


def _from_default_route() -> list[Interface]:
    found = [Interface("", 0, LOOPBACK, 8, True)]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("239.255.0.1", 7400))  # sends nothing
            address = probe.getsockname()[0]
        except OSError:
            return found
    if not address.startswith("127."):
        # The prefix is not known; 24 is the usual one, and it only tells which of a peer's addresses to prefer.
        found.append(Interface("", 0, address, 24, True))
    return found


class Watch:
    """A socket that is readable when links or addresses have changed. What has is asked of `interfaces()`."""

    def __init__(self) -> None:
        """Raises OSError or AttributeError where there is no rtnetlink."""
        self._socket = socket.socket(
            socket.AF_NETLINK, socket.SOCK_RAW | socket.SOCK_NONBLOCK, socket.NETLINK_ROUTE
        )
        try:
            self._socket.bind((0, _GROUPS))
        except OSError:
            self._socket.close()
            raise

    def fileno(self) -> int:
        return self._socket.fileno()

    def drain(self) -> None:
        """Read what is there, without a look at it."""
        for _ in range(MAX_READS):
            try:
                self._socket.recv(65536)
            except BlockingIOError:
                return
            except OSError:
                continue  # ENOBUFS: changes were missed, which changes nothing

    def close(self) -> None:
        self._socket.close()
