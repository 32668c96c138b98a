"""Publishes a text on /bbb and shows by LEDs how long a message on /aaa is: the manual's example topic-pub-sub.

The user's part is in Verilog, topic_pub_sub.v, as the manual describes it. `Design` is the whole: a node, that part, and the
memory where fragments wait.

    roslet gateware sim topic-pub-sub
    roslet gateware build topic-pub-sub --target ecp5 --output out
"""

from __future__ import annotations

import pathlib

from amaranth.hdl import ClockDomain, ClockSignal, Instance, Module, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import Out

from roslet.gateware.config import Config
from roslet.gateware.tops.ros2_ether import Ros2Ether
from roslet.gateware.wires import expose

USER = pathlib.Path(__file__).with_suffix(".v")
NODE, PUBLISHED, SUBSCRIBED = "topic_pub_sub", "rt/bbb", "rt/aaa"
TYPE = "std_msgs::msg::dds_::String_"
MAC, ADDRESS, GATEWAY, MASK = "02:00:00:00:00:00", "192.168.1.100", "192.168.1.1", "255.255.255.0"
PREFIX = bytes.fromhex("010f37adde09000001000000")
DOMAIN, SOURCE_PORT, UDP_PORT = 0, 52000, 1234
LEDS = 4


def number(octets: bytes) -> int:
    """Octets as ports have them, the first in the lowest bits."""
    return int.from_bytes(octets, "little")


class Design(wiring.Component):
    """The node ADDRESS with this user logic, at the pins of an FPGA: `clk` with `clk_hz`, the PHY's, and `led`.

    It publishes `rate` times a second. With `counters` the ports `drop_reason` and `drop_count` of the node are there.
    """

    verilog = (USER,)

    def __init__(
        self, clk_hz: int = 100_000_000, rate: float = 1.0, phy: str = "mii", counters: bool = False
    ) -> None:
        self._clk_hz, self._period = clk_hz, round(clk_hz / rate)
        # It is the user's part that decides when to publish; and peers are reminded soon of what they may have missed.
        config = Config(
            ros2clk_hz=clk_hz, tx_period_app_wr_ms=600_000, tx_period_sedp_pub_hb_ms=100, tx_interval_ms=1
        )
        self._node = Ros2Ether(config, phy, counters)
        self.reasons = self._node.reasons
        pins = self._node.signature.members
        self._pins = [name for name in pins if name in ("clk", "rst_n") or name.startswith(("phy_", "drop_"))]
        super().__init__({**{name: pins[name] for name in self._pins}, "led": Out(LEDS)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain()
        m.d.comb += ClockSignal("sync").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(~self.rst_n, domain="sync")
        m.submodules.node = node = self._node
        members = node.signature.members
        expose(m, node, self, self._pins)

        ready = Signal()  # the user's part, and what it enables, begin when the reset is over
        m.d.sync += ready.eq(1)
        ports = {
            name: getattr(node, name)
            for name in members
            if name.startswith(("ros2_pub_app_data", "ros2_sub_app_data"))
            and name != "ros2_sub_app_data_rep_id"
        }
        m.submodules.user = Instance(
            "topic_pub_sub_user",
            p_PERIOD=self._period,
            p_MAX=node.config.ros2_max_app_data_len,
            i_clk=self.clk,
            i_rst_n=ready,
            o_led=self.led,
            **{f"{'i' if members[name].flow == Out else 'o'}_{name}": port for name, port in ports.items()},
        )

        m.submodules.payloads = payloads = memory.Memory(
            shape=8, depth=node.config.payloadsmem_depth, init=[]
        )
        read, write = payloads.read_port(), payloads.write_port()
        m.d.comb += [
            read.addr.eq(node.ip_payloadsmem_addr),
            read.en.eq(node.ip_payloadsmem_ce & ~node.ip_payloadsmem_we),
            node.ip_payloadsmem_rdata.eq(read.data),
            write.addr.eq(node.ip_payloadsmem_addr),
            write.en.eq(node.ip_payloadsmem_ce & node.ip_payloadsmem_we),
            write.data.eq(node.ip_payloadsmem_wdata),
            node.ether_en.eq(1),
            node.ros2pub_en.eq(ready),
            node.ros2sub_en.eq(ready),
            node.mac_addr.eq(number(bytes.fromhex(MAC.replace(":", "")))),
            node.ip_addr.eq(number(bytes(map(int, ADDRESS.split("."))))),
            node.gateway_ip_addr.eq(number(bytes(map(int, GATEWAY.split("."))))),
            node.subnet_mask.eq(number(bytes(map(int, MASK.split("."))))),
            node.ros2_rx_udp_port.eq(UDP_PORT),
            node.ros2_node_udp_port.eq(SOURCE_PORT),
            node.ros2_port_num_seed.eq(7400 + 250 * DOMAIN),
            node.ros2_guid_prefix.eq(number(PREFIX)),
            node.arp_req_retry_count.eq(4),
            node.arp_req_retry_interval.eq(self._clk_hz // 2),
            node.arp_req_timeout.eq(self._clk_hz * 30),
            node.ros2_fragment_expiration.eq(self._clk_hz),
        ]
        for name, text in (
            ("node_name", NODE),
            ("pub_topic_name", PUBLISHED),
            ("pub_topic_type_name", TYPE),
            ("sub_topic_name", SUBSCRIBED),
            ("sub_topic_type_name", TYPE),
        ):
            m.d.comb += getattr(node, f"ros2_{name}").eq(number(text.encode()))
            m.d.comb += getattr(node, f"ros2_{name}_len").eq(len(text) + 1)
        return m
