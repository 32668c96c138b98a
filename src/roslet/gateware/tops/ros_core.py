"""A ROS 2 node from the pins of a PHY on, whose user gives and takes serialised messages, as streams of words."""

from __future__ import annotations

import ipaddress
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from amaranth.hdl import C, ClockDomain, ClockSignal, DomainRenamer, Module
from amaranth.lib import memory, wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware.drops import DropCounters
from roslet.gateware.fifo import FrameFifo
from roslet.gateware.mac import Mac, PhyReset, phy_clock
from roslet.gateware.rtps.participant import Participant
from roslet.gateware.rtps.rom import entity_id
from roslet.gateware.rtps.tables import Local
from roslet.gateware.rtps.timers import Timers
from roslet.gateware.stack import UdpStack
from roslet.gateware.udp import PortSwitch
from roslet.wire import discovery_info
from roslet.wire.net import icmp
from roslet.wire.rtps import guid, locator

PHY_RESET = 10e-6
"""Seconds. PHYs ask for 1 us (DP83848) or less."""


@dataclass(frozen=True)
class Identity:
    """Who a node is: its name, and where it is on the network.

    `mac` as in 02:00:00:00:00:01, `address` with its prefix length. `guid_prefix`, 12 octets, must differ between nodes, and
    had better differ between the lives of a node: what is empty is made of the vendor, `mac` and `session`.
    """

    name: str
    namespace: str = "/"
    domain: int = 0
    participant: int = 1
    mac: str = "02:00:00:00:00:01"
    address: str = "192.168.1.100/24"
    gateway: str = "0.0.0.0"
    session: int = 0
    guid_prefix: bytes = b""
    interface: Any = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "interface", ipaddress.IPv4Interface(self.address))
        if not self.guid_prefix:
            made = (
                guid.VENDORID_ROSLET
                + bytes.fromhex(self.mac.replace(":", ""))
                + self.session.to_bytes(4, "big")
            )
            object.__setattr__(self, "guid_prefix", made)
        if len(self.guid_prefix) != 12:
            raise ValueError(f"a GUID prefix has 12 octets, not {len(self.guid_prefix)}")

    @property
    def ports(self) -> tuple[int, int, int]:
        """Of the discovery of all, of our own, and of the user's messages."""
        return (
            locator.metatraffic_multicast_port(self.domain),
            locator.metatraffic_unicast_port(self.domain, self.participant),
            locator.user_unicast_port(self.domain, self.participant),
        )

    def graph(self, writers: int, readers: int) -> bytes:
        """What the graph says of us: ParticipantEntitiesInfo, without its encapsulation header."""
        ours = [
            tuple(self.guid_prefix + entity_id(n, writer) for n in range(count))
            for count, writer in ((readers, False), (writers, True))
        ]
        node = discovery_info.NodeEntities(self.namespace, self.name, *ours)
        whole = discovery_info.ParticipantEntities(self.guid_prefix + guid.ENTITYID_PARTICIPANT, (node,))
        return whole.emit()[4:]


class RosCore(wiring.Component):
    """A node with these topics.

    `writers` and `readers` have the names of DDS. Ports: `clk`, `rst_n`, those of the PHY; `publish0` .., `receive0` ..,
    `room`, as `Participant` has them. With `counters`, `drop_reason` and `drop_count` as `EthernetUdp` has them. What user
    logic does is in the domain `node`, which is that of `clk`.
    """

    def __init__(
        self,
        identity: Identity,
        writers: Sequence[Local] = (),
        readers: Sequence[Local] = (),
        clk_hz: float = 100e6,
        phy: str = "mii",
        participants: int = 8,
        endpoints: int = 16,
        fragments: int = 2,
        counters: bool = False,
        cache_width: int = 4,
    ) -> None:
        self.identity = identity
        self._clk_hz = clk_hz
        info = identity.graph(len(writers), len(readers))
        graph = Local(
            discovery_info.TOPIC,
            discovery_info.TYPE,
            reliable=True,
            transient_local=True,
            words=(len(info) + 3) // 4,
            type_hash=discovery_info.TYPE_HASH,
        )
        self._mac = Mac(phy)
        self._stack = UdpStack(
            round(clk_hz),
            groups=1,
            cache_width=cache_width,
            echo_data=fragments * 1480 - icmp.SIZE,
            fragments=fragments,
        )
        self._participant = Participant(
            writers,
            readers,
            identity.guid_prefix,
            identity.interface.ip.packed,
            identity.ports,
            identity.domain,
            ((graph, info),),
            participants,
            endpoints,
            longest=fragments * 1480 - 8,
        )
        self._switch = PortSwitch((0, 0, 0))
        self._timers = Timers(clk_hz)
        self._payloads = fragments * 1480
        blocks = (
            ("mac", self._mac),
            ("stack", self._stack),
            ("udp", self._switch),
            ("rtps", self._participant),
        )
        self._drops = {
            f"{part}_{name.removeprefix('drop_')}".removeprefix("stack_"): getattr(block, name)
            for part, block in blocks
            for name in block.signature.members
            if name.startswith("drop_")
        }
        self._counters = DropCounters(self._drops) if counters else None
        user = {
            name: member
            for name, member in self._participant.signature.members.items()
            if name.startswith(("publish", "receive")) or name in ("room", "alive", "matched")
        }
        self._user = user
        members: dict[str, Any] = {
            "clk": In(1),
            "rst_n": In(1),
            "phy_rx_clk": In(1),
            "phy_tx_clk": In(1),
            **self._mac.pins.signature.members,
            "phy_rst_n": Out(1),
            **user,
        }
        if self._counters is not None:
            members["drop_reason"] = self._counters.signature.members["reason"]
            members["drop_count"] = self._counters.signature.members["count"]
        super().__init__(members)

    @property
    def reasons(self) -> dict[str, int]:
        """The numbers of what is dropped; empty without counters."""
        return {} if self._counters is None else self._counters.numbers

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.node = ClockDomain(local=True)
        m.d.comb += ClockSignal("node").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(~self.rst_n, domain="node")
        m.submodules.node = DomainRenamer("node")(self._node())
        return m

    def _node(self) -> Module:
        m = Module()
        phy_clock(m, "phy_rx", self.phy_rx_clk)
        phy_clock(m, "phy_tx", self.phy_tx_clk)
        m.submodules.phy_reset = phy_reset = PhyReset(max(1, round(PHY_RESET * self._clk_hz)))
        m.submodules.mac, m.submodules.stack = mac, stack = self._mac, self._stack
        m.submodules.switch, m.submodules.rtps = switch, rtps = self._switch, self._participant
        m.submodules.timers = timers = self._timers
        m.submodules.rx_queue = rx_queue = FrameFifo(2048)
        m.submodules.tx_queue = tx_queue = FrameFifo(2)
        for source, sink in (
            (mac.rx, rx_queue.i),
            (rx_queue.o, stack.rx),
            (stack.tx, tx_queue.i),
            (tx_queue.o, mac.tx),
            (stack.udp_rx, switch.i),
            (switch.o0, rtps.udp_rx),
            (rtps.udp_tx, stack.udp_tx),
            (rtps.lookup, stack.lookup0),
        ):
            connect(m, source, sink)
        identity = self.identity
        interface = identity.interface
        for addresses in (stack.addresses, rtps.addresses):
            m.d.comb += [
                addresses.mac.eq(int.from_bytes(bytes.fromhex(identity.mac.replace(":", "")), "little")),
                addresses.ip.eq(int.from_bytes(interface.ip.packed, "little")),
                addresses.mask.eq(int.from_bytes(interface.netmask.packed, "little")),
                addresses.gateway.eq(
                    int.from_bytes(ipaddress.IPv4Address(identity.gateway).packed, "little")
                ),
            ]
        m.d.comb += [
            self.phy_rst_n.eq(phy_reset.phy_rst_n),
            stack.enable.eq(phy_reset.phy_rst_n),
            timers.enable.eq(phy_reset.phy_rst_n),
            stack.groups[0].valid.eq(1),
            stack.groups[0].ip.eq(C(int.from_bytes(locator.SPDP_MULTICAST_ADDRESS, "little"), 32)),
            stack.retry_count.eq(4),
            stack.retry_interval.eq(round(self._clk_hz / 2)),
            stack.timeout.eq(round(self._clk_hz * 30)),
            stack.expiration.eq(round(self._clk_hz)),
            rtps.tick.eq(timers.tick),
            rtps.announce.eq(timers.announce),
            rtps.sweep.eq(timers.sweep),
            *(getattr(switch, f"port{n}").eq(port) for n, port in enumerate(identity.ports)),
        ]
        for name, member in mac.pins.signature.members.items():
            inside, outside = getattr(mac.pins, name), getattr(self, name)
            m.d.comb += outside.eq(inside) if member.flow == Out else inside.eq(outside)
        for name, member in self._user.items():
            inside, outside = getattr(rtps, name), getattr(self, name)
            if member.is_signature:
                if member.flow == Out:
                    connect(m, inside, flipped(outside))
                else:
                    connect(m, flipped(outside), inside)
            else:
                m.d.comb += outside.eq(inside) if member.flow == Out else inside.eq(outside)
        self._memory(m)
        if self._counters is not None:
            m.submodules.counters = counters = self._counters
            m.d.comb += [counters.drops[name].eq(signal) for name, signal in self._drops.items()]
            m.d.comb += [counters.reason.eq(self.drop_reason), self.drop_count.eq(counters.count)]
        return m

    def _memory(self, m: Module) -> None:
        """Where fragments wait."""
        port = self._stack.ip_payloadsmem
        m.submodules.payloads = payloads = memory.Memory(shape=8, depth=self._payloads, init=[])
        read, write = payloads.read_port(), payloads.write_port()
        m.d.comb += [
            read.addr.eq(port.addr),
            read.en.eq(port.ce & ~port.we),
            port.rdata.eq(read.data),
            write.addr.eq(port.addr),
            write.en.eq(port.ce & port.we),
            write.data.eq(port.wdata),
        ]
