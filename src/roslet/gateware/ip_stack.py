"""From IPv4 packets to UDP data and back, whatever carries the packets."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Cat, Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware.arbiter import FrameArbiter
from roslet.gateware.drops import drop_outputs
from roslet.gateware.fifo import FrameRegister, FrameStage
from roslet.gateware.icmp import MAX_DATA, IcmpEcho
from roslet.gateware.ipv4_rx import Ipv4Rx, ProtocolSwitch
from roslet.gateware.ipv4_tx import LONGEST, Ipv4Tx
from roslet.gateware.meta import (
    ADDRESSES,
    ETHERNET_RX,
    ETHERNET_TX,
    IPV4_FRAGMENT,
    IPV4_RX,
    UDP_RX,
    UDP_TX,
)
from roslet.gateware.reassembly import NoReassembly, Reassembly
from roslet.gateware.stream import FrameSignature
from roslet.gateware.udp import UdpRx, UdpTx
from roslet.gateware.wires import expose
from roslet.wire.net import ethernet, icmp, ipv4, udp

REASSEMBLY = ("expiration", "ip_payloadsmem")
"""The ports of `Reassembly` that are the stack's."""
_BLOCKS = {ipv4.ICMP: "icmp", ipv4.UDP: "udp"}
"""Which take a protocol."""


class IpStack(wiring.Component):
    """UDP over IPv4, with ICMP echo and reassembly.

    echo_data   the most data of a ping that is answered; None: none is
    fragments   of a datagram, at most; `pendings` datagrams wait for theirs at once, each fragment with up to
                `fragment_size` octets; with 1 there is no reassembly, nor the ports for it
    mtu         octets of a packet that is sent
    longest     octets of data that `udp_tx` has at most: where all fits into packets, there is no logic to cut
    registers   whether there are some between blocks: without them paths are too long for 100 MHz
    igmp        whether there is a port for what comes of that protocol
    hop         whether each packet at `tx` begins with the hardware address that it goes to

    Ports: `rx` and `tx`, packets from and to a link; `udp_rx`, the data of every UDP datagram for this node, whatever its
    port; `udp_tx`, data to be sent; `igmp`; `addresses`; `expiration` and `ip_payloadsmem` as `Reassembly` has them.
    `drop_<block>_<reason>`, what the blocks drop.
    """

    def __init__(
        self,
        echo_data: int | None = MAX_DATA,
        pendings: int = 1,
        fragments: int = 2,
        fragment_size: int = 1480,
        mtu: int = ethernet.MTU,
        igmp: bool = False,
        longest: int = LONGEST - udp.SIZE,
        registers: bool = True,
        hop: bool = True,
    ) -> None:
        self._registers = registers
        sizes = [udp.SIZE + longest, *([] if echo_data is None else [icmp.SIZE + echo_data])]
        self._packets = Ipv4Tx(mtu=mtu, max_length=min(LONGEST, max(sizes)), hop=hop)
        echo = {} if echo_data is None else {"icmp": IcmpEcho(echo_data)}
        self._protocols = [*([ipv4.ICMP] if echo else []), ipv4.UDP, *([ipv4.IGMP] if igmp else [])]
        self._blocks: dict[str, Any] = {
            "ipv4": Ipv4Rx(),
            "reassembly": (
                Reassembly(pendings, fragments, fragment_size) if fragments > 1 else NoReassembly()
            ),
            "protocol": ProtocolSwitch(self._protocols),
            **echo,
            "udp": UdpRx(),
        }
        self._drops = drop_outputs(self._blocks)
        reassembly = self._blocks["reassembly"].signature.members
        self.memory = {name: reassembly[name] for name in REASSEMBLY if name in reassembly}
        super().__init__(
            {
                "rx": In(FrameSignature(ETHERNET_RX)),
                "tx": Out(FrameSignature(ETHERNET_TX)),
                "udp_rx": Out(FrameSignature(UDP_RX)),
                "udp_tx": In(FrameSignature(UDP_TX)),
                **({"igmp": Out(FrameSignature(IPV4_RX))} if igmp else {}),
                "addresses": In(ADDRESSES),
                **self.memory,
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
        m.d.comb += self._blocks["ipv4"].turn.eq(
            Cat(self._blocks[name].turn for name in _BLOCKS.values() if name in self._blocks).any()
        )
        self._receive(m)
        self._send(m)
        return m

    def _join(self, m: Module, name: str, meta: Any, source: Any, sink: Any, cut: bool = False) -> None:
        """Connect, with registers between if there shall be any; `cut`, where `ready` comes late."""
        if not self._registers:
            connect(m, source, sink)
            return
        m.submodules[f"{name}_register"] = between = FrameRegister(meta) if cut else FrameStage(meta)
        connect(m, source, between.i)
        connect(m, between.o, sink)

    def _receive(self, m: Module) -> None:
        blocks = self._blocks
        received, reassembly = blocks["ipv4"], blocks["reassembly"]
        self._join(m, "packets", ETHERNET_RX, flipped(self.rx), received.i, cut=True)
        datagrams = received.o
        if self.memory:
            m.submodules.datagrams = both = FrameArbiter(2, IPV4_RX)
            self._join(m, "fragments", IPV4_FRAGMENT, received.fragments, reassembly.i)
            self._join(m, "received", IPV4_RX, received.o, both.i0, cut=True)
            connect(m, reassembly.o, both.i1)
            datagrams = both.o
            expose(m, reassembly, self, self.memory)
        else:
            connect(m, received.fragments, reassembly.i)
        self._join(m, "datagrams", IPV4_RX, datagrams, blocks["protocol"].i, cut=True)
        for n, protocol in enumerate(self._protocols):
            taker = flipped(self.igmp) if protocol == ipv4.IGMP else blocks[_BLOCKS[protocol]].i
            connect(m, getattr(blocks["protocol"], f"o{n}"), taker)
        self._join(m, "udp_rx", UDP_RX, blocks["udp"].o, flipped(self.udp_rx), cut=True)

    def _send(self, m: Module) -> None:
        m.submodules.udp_tx = datagrams = UdpTx()
        m.submodules.ipv4_tx = packets = self._packets
        for block in (datagrams, packets):
            m.d.comb += block.addresses.eq(self.addresses)
        connect(m, flipped(self.udp_tx), datagrams.i)
        if "icmp" in self._blocks:
            m.submodules.datagrams_tx = both = FrameArbiter(2)
            self._join(m, "udp_tx", None, datagrams.o, both.i0, cut=True)
            self._join(m, "echoes", None, self._blocks["icmp"].o, both.i1)
            connect(m, both.o, packets.i)
        else:
            self._join(m, "udp_tx", None, datagrams.o, packets.i, cut=True)
        self._join(m, "packets_tx", ETHERNET_TX, packets.o, flipped(self.tx), cut=True)
