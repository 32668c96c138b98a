"""Sends a text by UDP now and then, and shows by LEDs how long a datagram it received: the manual's example udp-tx-rx.

`UdpTxRx` is the user's part, with the two UDP memories: its ports are those that the node has for them, seen from the other
side. `Design` is the whole: a node, that part, and the memory where fragments wait.

    roslet gateware sim udp-tx-rx
    roslet gateware build udp-tx-rx --target ecp5
"""

from __future__ import annotations

from amaranth.hdl import ClockDomain, ClockSignal, Module, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import In, Out

from roslet.gateware.config import Config, check_rx_udp_port
from roslet.gateware.tops.ethernet_udp import EthernetUdp
from roslet.gateware.wires import expose

TEXT = b"UDP Send Test\n"
LENGTHS = (1, 5, 10, 15)
"""Each LED shines for a datagram of at least so many octets. On the Arty A7 they are LD4 to LD7."""


def datagram(address: str, source_port: int, destination_port: int, text: bytes) -> list[int]:
    """The words of a memory from which it is sent."""
    octets = bytes(map(int, address.split(".")))
    octets += b"".join(n.to_bytes(2, "little") for n in (destination_port, source_port, len(text), 0)) + text
    return [int.from_bytes(octets[n : n + 4], "little") for n in range(0, len(octets), 4)]


class UdpTxRx(wiring.Component):
    """Sends TEXT to port 1234 of 192.168.1.10, from port 1234, every `period` cycles; `led` as LENGTHS says.

    What is due while an earlier one is on its way is sent once, when that has gone.
    """

    def __init__(self, period: int, address_width: int = 6) -> None:
        self._period = period
        self._words = 1 << address_width
        super().__init__(
            {
                "udp_txbuf_addr": In(address_width),
                "udp_txbuf_ce": In(1),
                "udp_txbuf_rdata": Out(32),
                "udp_txbuf_rel": Out(1),
                "udp_txbuf_grant": In(1),
                "udp_rxbuf_addr": In(address_width),
                "udp_rxbuf_ce": In(1),
                "udp_rxbuf_we": In(1),
                "udp_rxbuf_wdata": In(32),
                "udp_rxbuf_rel": Out(1),
                "udp_rxbuf_grant": In(1),
                "led": Out(len(LENGTHS)),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        self._send(m)
        self._receive(m)
        return m

    def _send(self, m: Module) -> None:
        words = datagram("192.168.1.10", 1234, 1234, TEXT)
        m.submodules.txbuf = txbuf = memory.Memory(shape=32, depth=self._words, init=words)
        read = txbuf.read_port()
        m.d.comb += [
            read.addr.eq(self.udp_txbuf_addr),
            read.en.eq(self.udp_txbuf_ce),
            self.udp_txbuf_rdata.eq(read.data),
        ]
        cycles = Signal(range(self._period))
        due = Signal()
        m.d.comb += self.udp_txbuf_rel.eq(due & self.udp_txbuf_grant)
        with m.If(self.udp_txbuf_rel):
            m.d.sync += due.eq(0)
        m.d.sync += cycles.eq(cycles + 1)
        with m.If(cycles == self._period - 1):
            m.d.sync += [cycles.eq(0), due.eq(1)]

    def _receive(self, m: Module) -> None:
        m.submodules.rxbuf = rxbuf = memory.Memory(shape=32, depth=self._words, init=[])
        write, read = rxbuf.write_port(), rxbuf.read_port()
        length = Signal(16)  # block RAM is slow: what it gives is not compared in the same cycle
        m.d.comb += [
            write.addr.eq(self.udp_rxbuf_addr),
            write.data.eq(self.udp_rxbuf_wdata),
            write.en.eq(self.udp_rxbuf_ce & self.udp_rxbuf_we),
            read.addr.eq(1),  # of the length
            read.en.eq(self.udp_rxbuf_grant),
        ]
        with m.FSM():
            with m.State("WAIT"), m.If(self.udp_rxbuf_grant):
                m.next = "READ"
            with m.State("READ"):
                m.d.sync += length.eq(read.data[16:])
                m.next = "SHOW"
            with m.State("SHOW"):
                m.d.comb += self.udp_rxbuf_rel.eq(1)
                m.d.sync += [self.led[n].eq(length >= least) for n, least in enumerate(LENGTHS)]
                m.next = "WAIT"


MAC, ADDRESS, GATEWAY, MASK = "02:00:00:00:00:00", "192.168.1.100", "192.168.1.1", "255.255.255.0"
PORT = 1234


def number(text: str) -> int:
    """An address as ports have it, the first octet in the lowest bits."""
    octets = bytes.fromhex(text.replace(":", "")) if ":" in text else bytes(map(int, text.split(".")))
    return int.from_bytes(octets, "little")


class Design(wiring.Component):
    """The node ADDRESS with this user logic, at the pins of an FPGA: `clk` with `clk_hz`, the PHY's, and `led`.

    It sends `rate` times a second. With `counters` the ports `drop_reason` and `drop_count` of the node are there. Raises
    ValueError where PORT is one of those of RTPS.
    """

    def __init__(
        self, clk_hz: int = 100_000_000, rate: float = 1.0, phy: str = "mii", counters: bool = False
    ) -> None:
        self._clk_hz = clk_hz
        config = Config(ros2clk_hz=clk_hz)
        check_rx_udp_port(PORT, domain=0, participant=config.target_participant_id)
        self._node = EthernetUdp(config, phy, counters)
        self._user = UdpTxRx(round(clk_hz / rate), self._node.config.udp_txbuf_awidth)
        self.reasons = self._node.reasons
        pins = self._node.signature.members
        self._pins = [name for name in pins if name in ("clk", "rst_n") or name.startswith(("phy_", "drop_"))]
        super().__init__({**{name: pins[name] for name in self._pins}, "led": Out(len(LENGTHS))})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain()
        m.d.comb += ClockSignal("sync").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(~self.rst_n, domain="sync")
        m.submodules.node = node = self._node
        m.submodules.user = user = self._user
        expose(m, node, self, self._pins)
        for name, member in user.signature.members.items():
            if name != "led":
                ours, its = getattr(node, name), getattr(user, name)
                m.d.comb += ours.eq(its) if member.flow == Out else its.eq(ours)
        m.submodules.payloads = payloads = memory.Memory(
            shape=8, depth=node.config.payloadsmem_depth, init=[]
        )
        read, write = payloads.read_port(), payloads.write_port()
        m.d.comb += [
            self.led.eq(user.led),
            read.addr.eq(node.ip_payloadsmem_addr),
            read.en.eq(node.ip_payloadsmem_ce & ~node.ip_payloadsmem_we),
            node.ip_payloadsmem_rdata.eq(read.data),
            write.addr.eq(node.ip_payloadsmem_addr),
            write.en.eq(node.ip_payloadsmem_ce & node.ip_payloadsmem_we),
            write.data.eq(node.ip_payloadsmem_wdata),
            node.ether_en.eq(1),
            node.mac_addr.eq(number(MAC)),
            node.ip_addr.eq(number(ADDRESS)),
            node.gateway_ip_addr.eq(number(GATEWAY)),
            node.subnet_mask.eq(number(MASK)),
            node.ros2_rx_udp_port.eq(PORT),
            node.arp_req_retry_count.eq(4),
            node.arp_req_retry_interval.eq(self._clk_hz // 2),
            node.arp_req_timeout.eq(self._clk_hz * 30),
            node.ros2_fragment_expiration.eq(self._clk_hz),
        ]
        return m
