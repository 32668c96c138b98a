"""From Ethernet frames to UDP data and back: all that stands between a MAC and what uses UDP."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware import multicast
from roslet.gateware.arbiter import FrameArbiter, LookupArbiter
from roslet.gateware.arp import Arp
from roslet.gateware.ethernet import EthernetRx, EthernetTx
from roslet.gateware.fifo import FrameRegister
from roslet.gateware.icmp import MAX_DATA, IcmpEcho
from roslet.gateware.igmp import Igmp
from roslet.gateware.ipv4_rx import Ipv4Rx, ProtocolSwitch
from roslet.gateware.ipv4_tx import Ipv4Tx
from roslet.gateware.meta import (
    ADDRESSES,
    ETHERNET_RX,
    ETHERNET_TX,
    IPV4_FRAGMENT,
    IPV4_RX,
    IPV4_TX,
    UDP_RX,
    UDP_TX,
    LookupSignature,
)
from roslet.gateware.reassembly import Reassembly
from roslet.gateware.stream import FrameSignature
from roslet.gateware.udp import UdpRx, UdpTx
from roslet.wire.net import ipv4

ARP_SETTINGS = ("retry_count", "retry_interval", "timeout")


class UdpStack(wiring.Component):
    """UDP over IPv4 over Ethernet, with ARP, ICMP echo, IGMP and reassembly.

    clock_hz     cycles a second, for IGMP's delays
    groups       how many multicast groups may be joined
    askers       how many ask for hardware addresses
    cache_width  ARP remembers 2**cache_width addresses
    echo_data    the most data of a ping that is answered
    fragments    of a datagram, at most; `pendings` datagrams wait for theirs at once, each fragment with up to
                 `fragment_size` octets

    Ports: `rx` and `tx`, frames from and to a MAC; `udp_rx`, the data of every UDP datagram for this node, whatever its
    port; `udp_tx`, data to be sent, whose hardware addresses are asked for by `lookup0 ..`; `addresses`, and `groups`, those
    that it has joined, steady while `enable` is high; `retry_count`, `retry_interval`, `timeout` as `Arp` has them;
    `expiration` and `ip_payloadsmem` as `Reassembly` has them. `drop_<block>_<reason>`, what the blocks drop.

    When `enable` rises the node tells of itself, by an announcement of its address and reports of its groups. What else is
    sent needs no `enable`: hold the stack in reset while the node is not to be there.
    """

    def __init__(
        self,
        clock_hz: int,
        groups: int = 0,
        askers: int = 1,
        cache_width: int = 4,
        echo_data: int = MAX_DATA,
        pendings: int = 1,
        fragments: int = 2,
        fragment_size: int = 1480,
    ) -> None:
        self._askers = askers
        self._blocks: dict[str, Any] = {
            "ethernet": EthernetRx(groups),
            "arp": Arp(cache_width),
            "ipv4": Ipv4Rx(),
            "reassembly": Reassembly(pendings, fragments, fragment_size),
            "protocol": ProtocolSwitch((ipv4.ICMP, ipv4.UDP, *((ipv4.IGMP,) if groups else ()))),
            "icmp": IcmpEcho(echo_data),
            "udp": UdpRx(),
            **({"igmp": Igmp(clock_hz, groups)} if groups else {}),
        }
        self.drops = [
            (block, name)
            for block, component in self._blocks.items()
            for name in component.signature.members
            if name.startswith("drop_")
        ]
        super().__init__(
            {
                "rx": In(FrameSignature()),
                "tx": Out(FrameSignature()),
                "udp_rx": Out(FrameSignature(UDP_RX)),
                "udp_tx": In(FrameSignature(UDP_TX)),
                **{f"lookup{n}": In(LookupSignature()) for n in range(askers)},
                "addresses": In(ADDRESSES),
                "groups": In(multicast.groups(groups)),
                "enable": In(1),
                **{name: self._blocks["arp"].signature.members[name] for name in ARP_SETTINGS},
                "expiration": In(32),
                "ip_payloadsmem": self._blocks["reassembly"].signature.members["ip_payloadsmem"],
                **{self.drop_name(block, name): Out(1) for block, name in self.drops},
            }
        )

    @staticmethod
    def drop_name(block: str, name: str) -> str:
        """The port of this component for the output `drop_<reason>` of a block."""
        return f"drop_{block}_{name.removeprefix('drop_')}"

    def elaborate(self, platform: object) -> Module:
        m = Module()
        for name, block in self._blocks.items():
            m.submodules[name] = block
            if "addresses" in block.signature.members:
                m.d.comb += block.addresses.eq(self.addresses)
        for block, name in self.drops:
            m.d.comb += getattr(self, self.drop_name(block, name)).eq(getattr(self._blocks[block], name))
        self._receive(m)
        self._send(m)
        self._ask(m)
        return m

    @staticmethod
    def _register(m: Module, name: str, meta: Any, source: Any, sink: Any) -> None:
        """Connect with registers between: paths through several blocks would be too long for 100 MHz."""
        m.submodules[f"{name}_register"] = register = FrameRegister(meta)
        connect(m, source, register.i)
        connect(m, register.o, sink)

    def _receive(self, m: Module) -> None:
        blocks = self._blocks
        ethernet, received = blocks["ethernet"], blocks["ipv4"]
        m.submodules.datagrams = datagrams = FrameArbiter(2, IPV4_RX)
        connect(m, flipped(self.rx), ethernet.i)
        connect(m, ethernet.arp, blocks["arp"].i)
        self._register(m, "packets", ETHERNET_RX, ethernet.ipv4, received.i)
        self._register(m, "fragments", IPV4_FRAGMENT, received.fragments, blocks["reassembly"].i)
        self._register(m, "received", IPV4_RX, received.o, datagrams.i0)
        connect(m, blocks["reassembly"].o, datagrams.i1)
        self._register(m, "datagrams", IPV4_RX, datagrams.o, blocks["protocol"].i)
        connect(m, blocks["protocol"].o0, blocks["icmp"].i)
        connect(m, blocks["protocol"].o1, blocks["udp"].i)
        if "igmp" in blocks:
            connect(m, blocks["protocol"].o2, blocks["igmp"].i)
        connect(m, blocks["udp"].o, flipped(self.udp_rx))
        connect(m, blocks["reassembly"].ip_payloadsmem, flipped(self.ip_payloadsmem))
        m.d.comb += [
            ethernet.groups.eq(self.groups),
            blocks["reassembly"].expiration.eq(self.expiration),
        ]

    def _send(self, m: Module) -> None:
        blocks = self._blocks
        m.submodules.udp_tx = udp = UdpTx()
        m.submodules.datagrams_tx = datagrams = FrameArbiter(2, IPV4_TX)
        m.submodules.ipv4_tx = packets = Ipv4Tx()
        m.submodules.frames_tx = frames = FrameArbiter(3 if "igmp" in blocks else 2, ETHERNET_TX)
        m.submodules.ethernet_tx = ethernet = EthernetTx()
        for block in (udp, packets, ethernet):
            m.d.comb += block.addresses.eq(self.addresses)
        connect(m, flipped(self.udp_tx), udp.i)
        connect(m, udp.o, datagrams.i0)
        self._register(m, "echoes", IPV4_TX, blocks["icmp"].o, datagrams.i1)
        connect(m, datagrams.o, packets.i)
        self._register(m, "packets_tx", ETHERNET_TX, packets.o, frames.i0)
        connect(m, blocks["arp"].o, frames.i1)
        if "igmp" in blocks:
            connect(m, blocks["igmp"].o, frames.i2)
            m.d.comb += [
                blocks["igmp"].groups.eq(self.groups),
                blocks["igmp"].enable.eq(self.enable),
            ]
        connect(m, frames.o, ethernet.i)
        connect(m, ethernet.o, flipped(self.tx))

    def _ask(self, m: Module) -> None:
        arp = self._blocks["arp"]
        m.submodules.lookups = lookups = LookupArbiter(self._askers)
        for n in range(self._askers):
            connect(m, flipped(getattr(self, f"lookup{n}")), getattr(lookups, f"asker{n}"))
        connect(m, lookups.resolver, arp.lookup)
        m.d.comb += arp.enable.eq(self.enable)
        m.d.comb += [getattr(arp, name).eq(getattr(self, name)) for name in ARP_SETTINGS]
