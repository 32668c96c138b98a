"""From Ethernet frames to UDP data and back: all that stands between a MAC and what uses UDP."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware import multicast
from roslet.gateware.arbiter import FrameArbiter, LookupArbiter
from roslet.gateware.arp import Arp
from roslet.gateware.drops import drop_outputs
from roslet.gateware.ethernet import EthernetRx, EthernetTx
from roslet.gateware.icmp import MAX_DATA
from roslet.gateware.igmp import Igmp
from roslet.gateware.ip_stack import IpStack
from roslet.gateware.ipv4_tx import LONGEST
from roslet.gateware.meta import ADDRESSES, ETHERNET_TX, LookupSignature
from roslet.gateware.stream import FrameSignature
from roslet.gateware.wires import expose
from roslet.wire.net import udp

ARP_SETTINGS = ("retry_count", "retry_interval", "timeout")


class UdpStack(wiring.Component):
    """UDP over IPv4 over Ethernet, with ARP, ICMP echo, IGMP and reassembly.

    clock_hz     cycles a second, for IGMP's delays
    groups       how many multicast groups may be joined
    askers       how many ask for hardware addresses
    cache_width  ARP remembers 2**cache_width addresses
    echo_data    the most data of a ping that is answered
    fragments    of a datagram, at most; `pendings` datagrams wait for theirs at once, each fragment with up to
                 `fragment_size` octets; with 1 there is no reassembly, nor the ports for it
    longest      octets of data that `udp_tx` has at most

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
        longest: int = LONGEST - udp.SIZE,
    ) -> None:
        self._askers = askers
        self._ip = ip = IpStack(
            echo_data, pendings, fragments, fragment_size, igmp=groups > 0, longest=longest
        )
        self._blocks: dict[str, Any] = {
            "ethernet": EthernetRx(groups),
            "arp": Arp(cache_width),
            **({"igmp": Igmp(clock_hz, groups)} if groups else {}),
        }
        self._drops = drop_outputs(self._blocks)
        self._ip_drops = [name for name in ip.signature.members if name.startswith("drop_")]
        members = ip.signature.members
        super().__init__(
            {
                "rx": In(FrameSignature()),
                "tx": Out(FrameSignature()),
                "udp_rx": members["udp_rx"],
                "udp_tx": members["udp_tx"],
                **{f"lookup{n}": In(LookupSignature()) for n in range(askers)},
                "addresses": In(ADDRESSES),
                "groups": In(multicast.groups(groups)),
                "enable": In(1),
                **{name: self._blocks["arp"].signature.members[name] for name in ARP_SETTINGS},
                **ip.memory,
                **{name: Out(1) for name in (*self._drops, *self._ip_drops)},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.ip = ip = self._ip
        m.submodules.ethernet_tx = ethernet = EthernetTx()
        for name, block in self._blocks.items():
            m.submodules[name] = block
        for block in (ip, ethernet, *self._blocks.values()):
            m.d.comb += block.addresses.eq(self.addresses)
        for name, (block, output) in self._drops.items():
            m.d.comb += getattr(self, name).eq(getattr(self._blocks[block], output))
        m.d.comb += [getattr(self, name).eq(getattr(ip, name)) for name in self._ip_drops]
        connect(m, flipped(self.udp_tx), ip.udp_tx)
        connect(m, ip.udp_rx, flipped(self.udp_rx))
        expose(m, ip, self, ip.memory)
        self._link(m, ethernet)
        self._ask(m)
        return m

    def _link(self, m: Module, sender: EthernetTx) -> None:
        blocks, ip = self._blocks, self._ip
        receiver = blocks["ethernet"]
        connect(m, flipped(self.rx), receiver.i)
        connect(m, receiver.arp, blocks["arp"].i)
        connect(m, receiver.ipv4, ip.rx)
        m.d.comb += receiver.groups.eq(self.groups)
        m.submodules.frames_tx = frames = FrameArbiter(3 if "igmp" in blocks else 2, ETHERNET_TX)
        connect(m, ip.tx, frames.i0)
        connect(m, blocks["arp"].o, frames.i1)
        if "igmp" in blocks:
            igmp = blocks["igmp"]
            connect(m, ip.igmp, igmp.i)
            connect(m, igmp.o, frames.i2)
            m.d.comb += [igmp.groups.eq(self.groups), igmp.enable.eq(self.enable)]
        connect(m, frames.o, sender.i)
        connect(m, sender.o, flipped(self.tx))

    def _ask(self, m: Module) -> None:
        arp = self._blocks["arp"]
        m.submodules.lookups = lookups = LookupArbiter(self._askers)
        for n in range(self._askers):
            connect(m, flipped(getattr(self, f"lookup{n}")), getattr(lookups, f"asker{n}"))
        connect(m, lookups.resolver, arp.lookup)
        m.d.comb += arp.enable.eq(self.enable)
        m.d.comb += [getattr(arp, name).eq(getattr(self, name)) for name in ARP_SETTINGS]
