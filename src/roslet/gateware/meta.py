"""What is known of a frame as it passes between layers: the `meta` of the streams, and the node's own addresses.

Addresses are in the order of the wire, the first octet in the lowest bits; lengths count octets; ports and types are
numbers.
"""

from __future__ import annotations

from amaranth.hdl import C, Value
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from roslet.gateware.octets import octets

ADDRESSES = data.StructLayout({"mac": 48, "ip": 32, "gateway": 32, "mask": 32})
"""The node's own, steady while it is enabled."""

ETHERNET_RX = data.StructLayout({"source": 48, "group": 1})
"""Behind an Ethernet header: who sent it, and whether it came by a multicast or broadcast address."""

HOP = 6
"""So many octets, the hardware address that it goes to, begin each frame on its way to Ethernet: octets pass where 48 bits
beside them would need multiplexers."""

ETHERNET_TX = data.StructLayout({"type": 16})
"""Before an Ethernet header, behind the destination."""

IPV4_RX = data.StructLayout(
    {"mac": 48, "source": 32, "destination": 32, "protocol": 8, "length": 16, "group": 1}
)
"""Behind an IPv4 header, or several of fragments: `mac` and `source` sent it; `length` of what follows, which a frame that
ends badly may have less of, and none more; `group` as above. Who takes the frame may have `source` and `destination` go
round by an octet a cycle, and has them as they were when its end is taken (`Ipv4Rx.turn`)."""

IPV4_FRAGMENT = data.StructLayout(
    {**{name: field.shape for name, field in IPV4_RX}, "identification": 16, "offset": 13, "more": 1}
)
"""Behind the header of a fragment: as IPV4_RX, `length` being its own; `offset` in units of 8 octets."""

LEAD = HOP + 8
"""So many octets begin each payload on its way to IPv4, for the same reason (see `lead`)."""


def lead(mac: Value, destination: Value, protocol: int, length: Value) -> list[Value]:
    """These octets: the hardware address that the payload goes to, and the end of UDP's pseudo-header (RFC 768): the
    destination, zero, the protocol, and the length of what follows, a number of 16 bits."""
    return [*octets(mac), *octets(destination), C(0, 8), C(protocol, 8), length[8:16], length[:8]]


UDP_RX = data.StructLayout(
    {
        "mac": 48,
        "source": 32,
        "destination": 32,
        "source_port": 16,
        "destination_port": 16,
        "length": 16,
        "group": 1,
    }
)
"""Behind a UDP header: `length` of the data."""

UDP_TX = data.StructLayout(
    {"mac": 48, "destination": 32, "source_port": 16, "destination_port": 16, "length": 16, "sum": 16}
)
"""Before a UDP header: `length` of the data, and `sum`, the ones' complement sum of its 16-bit words."""


class LookupSignature(wiring.Signature):
    """A question for a hardware address, seen from who asks.

    The asker holds `valid` and a steady `ip`. Within a bounded number of cycles `done` is high for one cycle, in which the
    answer stands beside it: `found` with `mac`; or `failed`, nobody answers there; or neither, it is being asked for: ask
    again. After `done` the asker may put another question at once.
    """

    def __init__(self) -> None:
        super().__init__(
            {
                "valid": Out(1),
                "ip": Out(32),
                "done": In(1),
                "found": In(1),
                "failed": In(1),
                "mac": In(48),
            }
        )
