"""UDP for user logic, from the pins of a PHY on: the manual's `ros2_ether` without ROS. Table A-1."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from amaranth.hdl import ClockDomain, ClockSignal, DomainRenamer, Module
from amaranth.lib import wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import In, Out, connect

from roslet.gateware.config import Config
from roslet.gateware.drops import DropCounters
from roslet.gateware.fifo import FrameFifo
from roslet.gateware.mac import Mac, PhyReset, phy_clock
from roslet.gateware.raw_udp import RawUdpRx, RawUdpTx
from roslet.gateware.stack import UdpStack
from roslet.wire.net import icmp

PHY_RESET = 10e-6
"""Seconds. PHYs ask for 1 us (DP83848) or less."""


class EthernetUdp(wiring.Component):
    """A node that sends and receives UDP datagrams for the user, is found by ARP and answers pings, of as much data as it
    takes in fragments.

    Ports have the names, directions, widths and meanings of the manual's Table A-1, those that have to do with ROS left
    out; `raw_udp` has the layout of the two UDP memories, `reassembly` that of the third. The manual leaves open what
    happens when `ether_en` falls: here the whole node, and the PHY, is in reset while it is low. With `counters`, two ports
    more: `drop_count` is how often something was dropped for the reason that `drop_reason` is the number of
    (`reasons`), a cycle later.

    clk may have any frequency from 12.5 MHz on with MII, 125 MHz with GMII; it need not be that of `config.ros2clk_hz`,
    by which IGMP's delays and the reset of the PHY are counted.
    """

    def __init__(self, config: Config | None = None, phy: str = "mii", counters: bool = False) -> None:
        self._build(Config() if config is None else config, phy, counters)

    def _build(
        self,
        config: Config,
        phy: str,
        counters: bool,
        groups: int = 0,
        askers: int = 1,
        blocks: Mapping[str, Any] | None = None,
        more: Mapping[str, Any] | None = None,
    ) -> None:
        """`blocks` drop, too; `more` are ports of a larger node."""
        self.config = config
        self._mac = Mac(phy, config.mac_rx_fifo_depth, config.mac_tx_fifo_depth)
        self._stack = UdpStack(
            config.ros2clk_hz,
            groups,
            askers,
            cache_width=config.arp_cache_addr_width,
            echo_data=config.max_ip_fragments * config.ip_max_payload_len - icmp.SIZE,
            pendings=config.max_pendings,
            fragments=config.max_ip_fragments,
            fragment_size=config.ip_max_payload_len,
        )
        self._rx = RawUdpRx(config.udp_rxbuf_awidth)
        self._tx = RawUdpTx(config.udp_txbuf_awidth)
        self._drops = {
            f"{part}_{name.removeprefix('drop_')}".removeprefix("stack_"): getattr(block, name)
            for part, block in (
                ("mac", self._mac),
                ("stack", self._stack),
                ("udp_rxbuf", self._rx),
                ("udp_txbuf", self._tx),
                *(blocks or {}).items(),
            )
            for name in block.signature.members
            if name.startswith("drop_")
        }
        self._counters = DropCounters(self._drops) if counters else None
        memory = self._stack.ip_payloadsmem.signature.members
        members: dict[str, Any] = {
            "clk": In(1),
            "rst_n": In(1),
            "ether_en": In(1),
            "phy_rx_clk": In(1),
            "phy_tx_clk": In(1),
            **self._mac.pins.signature.members,
            "phy_rst_n": Out(1),
            "mac_addr": In(48),
            "ip_addr": In(32),
            "gateway_ip_addr": In(32),
            "subnet_mask": In(32),
            "ros2_fragment_expiration": In(32),
            "arp_req_retry_count": In(6),
            "arp_req_retry_interval": In(36),
            "arp_req_timeout": In(36),
            "ros2_rx_udp_port": In(16),
            **{
                f"udp_rxbuf_{name}": self._rx.signature.members[name]
                for name in ("addr", "ce", "we", "wdata")
            },
            "udp_rxbuf_rel": In(1),
            "udp_rxbuf_grant": Out(1),
            **{f"udp_txbuf_{name}": self._tx.signature.members[name] for name in ("addr", "ce", "rdata")},
            "udp_txbuf_rel": In(1),
            "udp_txbuf_grant": Out(1),
            **{f"ip_payloadsmem_{name}": member for name, member in memory.items()},
            **(more or {}),
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
        # A domain of its own, so that whoever uses this in a larger design may have its `sync`.
        m.domains.node = ClockDomain(local=True)
        m.d.comb += ClockSignal("node").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(~(self.rst_n & self.ether_en), domain="node")
        m.submodules.node = DomainRenamer("node")(self._node())
        return m

    def _node(self) -> Module:
        m = Module()
        phy_clock(m, "phy_rx", self.phy_rx_clk)
        phy_clock(m, "phy_tx", self.phy_tx_clk)
        m.submodules.phy_reset = phy_reset = PhyReset(max(1, round(PHY_RESET * self.config.ros2clk_hz)))
        m.d.comb += self.phy_rst_n.eq(phy_reset.phy_rst_n)
        m.submodules.mac = mac = self._mac
        m.submodules.stack = stack = self._stack
        m.submodules.rx_queue = rx_queue = FrameFifo(self.config.ext_rx_fifo_depth)
        m.submodules.tx_queue = tx_queue = FrameFifo(self.config.ext_tx_fifo_depth)
        connect(m, mac.rx, rx_queue.i)
        connect(m, rx_queue.o, stack.rx)
        connect(m, stack.tx, tx_queue.i)
        connect(m, tx_queue.o, mac.tx)
        m.d.comb += [
            stack.enable.eq(self.phy_rst_n),
            stack.addresses.mac.eq(self.mac_addr),
            stack.addresses.ip.eq(self.ip_addr),
            stack.addresses.gateway.eq(self.gateway_ip_addr),
            stack.addresses.mask.eq(self.subnet_mask),
            stack.retry_count.eq(self.arp_req_retry_count),
            stack.retry_interval.eq(self.arp_req_retry_interval),
            stack.timeout.eq(self.arp_req_timeout),
            stack.expiration.eq(self.ros2_fragment_expiration),
        ]
        self._pins(m, mac.pins, "")
        self._pins(m, stack.ip_payloadsmem, "ip_payloadsmem_")
        self._user(m)
        if self._counters is not None:
            m.submodules.counters = counters = self._counters
            m.d.comb += [counters.drops[name].eq(signal) for name, signal in self._drops.items()]
            m.d.comb += [counters.reason.eq(self.drop_reason), self.drop_count.eq(counters.count)]
        return m

    def _pins(self, m: Module, block: Any, prefix: str) -> None:
        """Connect the ports of an interface with those of ours that have its names behind `prefix`."""
        for name, member in block.signature.members.items():
            inside, outside = getattr(block, name), getattr(self, prefix + name)
            m.d.comb += outside.eq(inside) if member.flow == Out else inside.eq(outside)

    def _user(self, m: Module) -> None:
        stack = self._stack
        connect(m, stack.udp_rx, self._rx.i)
        connect(m, self._tx.o, stack.udp_tx)
        connect(m, self._tx.lookup, stack.lookup0)
        self._memories(m)

    def _memories(self, m: Module) -> None:
        """The user's side of the two UDP memories."""
        m.submodules.rxbuf = rx = self._rx
        m.submodules.txbuf = tx = self._tx
        m.d.comb += rx.port.eq(self.ros2_rx_udp_port)
        for block, prefix, names in (
            (rx, "udp_rxbuf_", ("addr", "ce", "we", "wdata", "rel", "grant")),
            (tx, "udp_txbuf_", ("addr", "ce", "rdata", "rel", "grant")),
        ):
            for name in names:
                inside, outside = getattr(block, name), getattr(self, prefix + name)
                flow = block.signature.members[name].flow
                m.d.comb += outside.eq(inside) if flow == Out else inside.eq(outside)
