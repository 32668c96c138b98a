"""From IPv4 packets to UDP data and back, whatever carries the packets."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware.arbiter import FrameArbiter
from roslet.gateware.drops import drop_outputs
from roslet.gateware.fifo import FrameRegister
from roslet.gateware.icmp import MAX_DATA, IcmpEcho
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
)
from roslet.gateware.reassembly import Reassembly
from roslet.gateware.stream import FrameSignature
from roslet.gateware.udp import UdpRx, UdpTx
from roslet.wire.net import ethernet, ipv4


def register(m: Module, name: str, meta: Any, source: Any, sink: Any) -> None:
    """Connect with registers between: paths through several blocks would be too long for 100 MHz."""
    m.submodules[f"{name}_register"] = between = FrameRegister(meta)
    connect(m, source, between.i)
    connect(m, between.o, sink)


class IpStack(wiring.Component):
    """UDP over IPv4, with ICMP echo and reassembly.

    echo_data   the most data of a ping that is answered
    fragments   of a datagram, at most; `pendings` datagrams wait for theirs at once, each fragment with up to
                `fragment_size` octets
    mtu         octets of a packet that is sent
    igmp        whether there is a port for what comes of that protocol

    Ports: `rx` and `tx`, packets from and to a link; `udp_rx`, the data of every UDP datagram for this node, whatever its
    port; `udp_tx`, data to be sent; `igmp`; `addresses`; `expiration` and `ip_payloadsmem` as `Reassembly` has them.
    `drop_<block>_<reason>`, what the blocks drop.
    """

    def __init__(
        self,
        echo_data: int = MAX_DATA,
        pendings: int = 1,
        fragments: int = 2,
        fragment_size: int = 1480,
        mtu: int = ethernet.MTU,
        igmp: bool = False,
    ) -> None:
        self._mtu = mtu
        self._has_igmp = igmp
        self._blocks: dict[str, Any] = {
            "ipv4": Ipv4Rx(),
            "reassembly": Reassembly(pendings, fragments, fragment_size),
            "protocol": ProtocolSwitch((ipv4.ICMP, ipv4.UDP, *((ipv4.IGMP,) if igmp else ()))),
            "icmp": IcmpEcho(echo_data),
            "udp": UdpRx(),
        }
        self._drops = drop_outputs(self._blocks)
        super().__init__(
            {
                "rx": In(FrameSignature(ETHERNET_RX)),
                "tx": Out(FrameSignature(ETHERNET_TX)),
                "udp_rx": Out(FrameSignature(UDP_RX)),
                "udp_tx": In(FrameSignature(UDP_TX)),
                **({"igmp": Out(FrameSignature(IPV4_RX))} if igmp else {}),
                "addresses": In(ADDRESSES),
                "expiration": In(32),
                "ip_payloadsmem": self._blocks["reassembly"].signature.members["ip_payloadsmem"],
                **{name: Out(1) for name in self._drops},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        for name, block in self._blocks.items():
            m.submodules[name] = block
            if "addresses" in block.signature.members:
                m.d.comb += block.addresses.eq(self.addresses)
        for name, (block, output) in self._drops.items():
            m.d.comb += getattr(self, name).eq(getattr(self._blocks[block], output))
        self._receive(m)
        self._send(m)
        return m

    def _receive(self, m: Module) -> None:
        blocks = self._blocks
        received, reassembly = blocks["ipv4"], blocks["reassembly"]
        m.submodules.datagrams = datagrams = FrameArbiter(2, IPV4_RX)
        register(m, "packets", ETHERNET_RX, flipped(self.rx), received.i)
        register(m, "fragments", IPV4_FRAGMENT, received.fragments, reassembly.i)
        register(m, "received", IPV4_RX, received.o, datagrams.i0)
        connect(m, reassembly.o, datagrams.i1)
        register(m, "datagrams", IPV4_RX, datagrams.o, blocks["protocol"].i)
        connect(m, blocks["protocol"].o0, blocks["icmp"].i)
        connect(m, blocks["protocol"].o1, blocks["udp"].i)
        if self._has_igmp:
            connect(m, blocks["protocol"].o2, flipped(self.igmp))
        register(m, "udp_rx", UDP_RX, blocks["udp"].o, flipped(self.udp_rx))
        connect(m, reassembly.ip_payloadsmem, flipped(self.ip_payloadsmem))
        m.d.comb += reassembly.expiration.eq(self.expiration)

    def _send(self, m: Module) -> None:
        m.submodules.udp_tx = udp = UdpTx()
        m.submodules.datagrams_tx = datagrams = FrameArbiter(2, IPV4_TX)
        m.submodules.ipv4_tx = packets = Ipv4Tx(mtu=self._mtu)
        for block in (udp, packets):
            m.d.comb += block.addresses.eq(self.addresses)
        connect(m, flipped(self.udp_tx), udp.i)
        register(m, "udp_tx", IPV4_TX, udp.o, datagrams.i0)
        register(m, "echoes", IPV4_TX, self._blocks["icmp"].o, datagrams.i1)
        connect(m, datagrams.o, packets.i)
        register(m, "packets_tx", ETHERNET_TX, packets.o, flipped(self.tx))
