"""IPv4 multicast over Ethernet: the groups of a node, and their hardware addresses. RFC 1112."""

from __future__ import annotations

from amaranth.hdl import Cat, Const, Value
from amaranth.lib import data

GROUP = data.StructLayout({"valid": 1, "ip": 32})
"""A group that is joined while `valid`."""

ALL_HOSTS = bytes((224, 0, 0, 1))
"""RFC 1112, 4: every host is a member, always, and never reports it."""

PREFIX = bytes((0x01, 0x00, 0x5E))
"""RFC 1112, 6.4: the first three octets, of which one more bit is 0; the low 23 bits of the group follow."""

BROADCAST = bytes(6 * (0xFF,))


def groups(count: int) -> data.ArrayLayout:
    """The shape of a port of `count` groups. Raises ValueError where `count` is negative."""
    if count < 0:
        raise ValueError(f"there cannot be {count} groups")
    return data.ArrayLayout(GROUP, count)


def number(octets: bytes) -> int:
    """Octets as a constant in the order of the wire, the first in the lowest bits."""
    return int.from_bytes(octets, "little")


def is_multicast(ip: Value) -> Value:
    """Whether an address is one of a group: 224.0.0.0/4. RFC 1112, 4."""
    return ip[4:8] == 0xE


def hardware_address(ip: Value) -> Value:
    """The Ethernet address of a group."""
    return Cat(Const(number(PREFIX), 24), ip[8:15], Const(0, 1), ip[16:32])
