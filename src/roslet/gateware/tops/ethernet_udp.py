"""UDP for user logic, from the pins of a PHY on: the manual's `ros2_ether` without ROS. Table A-1."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from amaranth.hdl import Module, Value
from amaranth.lib.wiring import In, connect

from roslet.gateware.config import Config
from roslet.gateware.mac import Mac
from roslet.gateware.raw_udp import TX_HEADER, RawUdpRx, RawUdpTx, data_limit
from roslet.gateware.stack import UdpStack
from roslet.gateware.tops.linked_node import LinkedNode
from roslet.gateware.tops.links import EthernetLink
from roslet.gateware.wires import expose
from roslet.wire.net import icmp

RX_MEMORY = ("addr", "ce", "we", "wdata", "rel", "grant")
TX_MEMORY = ("addr", "ce", "rdata", "rel", "grant")
"""Ports of the two UDP memories."""


class EthernetUdp(LinkedNode):
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
        longest: int = 0,
    ) -> None:
        """`blocks` drop, too; `more` are ports of a larger node; `longest` are the octets that it sends in a datagram."""
        self.config = config
        stack = UdpStack(
            config.ros2clk_hz,
            groups,
            askers,
            cache_width=config.arp_cache_addr_width,
            echo_data=config.max_ip_fragments * config.ip_max_payload_len - icmp.SIZE,
            pendings=config.max_pendings,
            fragments=config.max_ip_fragments,
            fragment_size=config.ip_max_payload_len,
            longest=max(longest, data_limit(TX_HEADER, config.udp_txbuf_awidth, None)),
        )
        self._rx = RawUdpRx(config.udp_rxbuf_awidth)
        self._tx = RawUdpTx(config.udp_txbuf_awidth)
        rx, tx, memory = (block.signature.members for block in (self._rx, self._tx, stack.ip_payloadsmem))
        super().__init__(
            EthernetLink(
                Mac(phy, config.mac_rx_fifo_depth, config.mac_tx_fifo_depth),
                config.ros2clk_hz,
                config.ext_rx_fifo_depth,
                config.ext_tx_fifo_depth,
            ),
            stack,
            {"udp_rxbuf": self._rx, "udp_txbuf": self._tx, **(blocks or {})},
            {
                "ether_en": In(1),
                "mac_addr": In(48),
                "ip_addr": In(32),
                "gateway_ip_addr": In(32),
                "subnet_mask": In(32),
                "ros2_fragment_expiration": In(32),
                "arp_req_retry_count": In(6),
                "arp_req_retry_interval": In(36),
                "arp_req_timeout": In(36),
                "ros2_rx_udp_port": In(16),
                **{f"udp_rxbuf_{name}": rx[name] for name in RX_MEMORY},
                **{f"udp_txbuf_{name}": tx[name] for name in TX_MEMORY},
                **{f"ip_payloadsmem_{name}": member for name, member in memory.items()},
                **(more or {}),
            },
            counters,
        )

    def _reset(self) -> Value:
        reset: Value = ~(self.rst_n & self.ether_en)
        return reset

    def _node(self) -> Module:
        m = super()._node()
        stack = self._stack
        m.d.comb += [
            stack.addresses.mac.eq(self.mac_addr),
            stack.addresses.ip.eq(self.ip_addr),
            stack.addresses.gateway.eq(self.gateway_ip_addr),
            stack.addresses.mask.eq(self.subnet_mask),
            stack.retry_count.eq(self.arp_req_retry_count),
            stack.retry_interval.eq(self.arp_req_retry_interval),
            stack.timeout.eq(self.arp_req_timeout),
            stack.expiration.eq(self.ros2_fragment_expiration),
        ]
        expose(m, stack.ip_payloadsmem, self, prefix="ip_payloadsmem_")
        return m

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
        expose(m, rx, self, RX_MEMORY, "udp_rxbuf_")
        expose(m, tx, self, TX_MEMORY, "udp_txbuf_")
