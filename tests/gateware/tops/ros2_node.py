"""A `Ros2Ether` with the memories that its user provides, on a simulated wire; its ports are set and read from outside."""

from __future__ import annotations

import functools
import pathlib
from typing import Any

from amaranth.hdl import ClockDomain, ClockSignal, Module
from amaranth.lib import memory, wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import In, Out

from gateware.collisions import SpoiledCollisions
from roslet.cli.gateware_sim import dropped
from roslet.gateware.config import Config
from roslet.gateware.tops.ros2_ether import Ros2Ether
from roslet.gateware.wires import expose
from roslet.sim.compile import build
from roslet.sim.mii import Mii
from roslet.sim.model import Model
from roslet.sim.wire import Wire

ADDRESS, OUR_MAC = "192.168.1.100", "02:00:00:00:00:01"
TYPE = "std_msgs::msg::dds_::String_"
NODE, PUBLISHED, SUBSCRIBED = "gates", "rt/bbb", "rt/aaa"
PREFIX = bytes.fromhex("0110f37adde0900001000042")
CLOCK, PHY_CLOCK, FACTOR = 50e6, 25e6, 250.0
CLOCK_HZ = round(CLOCK / FACTOR)
UDP_PORT = 1234


def number(octets: bytes) -> int:
    """Octets as a port has them: the first in bits 7..0."""
    return int.from_bytes(octets, "little")


class Bench(wiring.Component):
    """The node and its memories, of which the host's side is: `sub_addr`, `sub_data`; `rxbuf_addr`, `rxbuf_data`; and
    `txbuf_addr`, `txbuf_data`, `txbuf_en`, which writes."""

    def __init__(self) -> None:
        self.config = config = Config(ros2clk_hz=CLOCK_HZ)
        self._node = Ros2Ether(config, counters=True)
        self.reasons = self._node.reasons
        memories = ("ip_payloadsmem_", "udp_rxbuf_", "udp_txbuf_", "ros2_sub_app_data_")
        ends = ("addr", "ce", "we", "wdata", "rdata")
        inside = {prefix + end for prefix in memories for end in ends}
        members = self._node.signature.members
        self._pins = [name for name in members if name not in inside]
        super().__init__(
            {
                **{name: members[name] for name in self._pins},
                "sub_addr": In(6),
                "sub_data": Out(8),
                "rxbuf_addr": In(6),
                "rxbuf_data": Out(32),
                "txbuf_addr": In(6),
                "txbuf_data": In(32),
                "txbuf_en": In(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain()
        m.d.comb += ClockSignal("sync").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(~self.rst_n, domain="sync")
        m.submodules.node = node = self._node
        expose(m, node, self, self._pins)

        def ram(name: str, width: int, depth: int) -> Any:
            m.submodules[name] = made = memory.Memory(shape=width, depth=depth, init=[])
            return made

        payloads = ram("payloads", 8, self.config.payloadsmem_depth)
        read, write = payloads.read_port(), payloads.write_port()
        m.d.comb += [
            read.addr.eq(node.ip_payloadsmem_addr),
            read.en.eq(node.ip_payloadsmem_ce & ~node.ip_payloadsmem_we),
            node.ip_payloadsmem_rdata.eq(read.data),
            write.addr.eq(node.ip_payloadsmem_addr),
            write.en.eq(node.ip_payloadsmem_ce & node.ip_payloadsmem_we),
            write.data.eq(node.ip_payloadsmem_wdata),
        ]
        for name, prefix, width in (("sub", "ros2_sub_app_data", 8), ("rxbuf", "udp_rxbuf", 32)):
            made = ram(name, width, 64)
            read, write = made.read_port(domain="comb"), made.write_port()
            m.d.comb += [
                write.addr.eq(getattr(node, f"{prefix}_addr")),
                write.en.eq(getattr(node, f"{prefix}_ce") & getattr(node, f"{prefix}_we")),
                write.data.eq(getattr(node, f"{prefix}_wdata")),
                read.addr.eq(getattr(self, f"{name}_addr")),
                getattr(self, f"{name}_data").eq(read.data),
            ]
        txbuf = ram("txbuf", 32, 64)
        read, write = txbuf.read_port(), txbuf.write_port()
        m.d.comb += [
            write.addr.eq(self.txbuf_addr),
            write.en.eq(self.txbuf_en),
            write.data.eq(self.txbuf_data),
            read.addr.eq(node.udp_txbuf_addr),
            read.en.eq(node.udp_txbuf_ce),
            node.udp_txbuf_rdata.eq(read.data),
        ]
        return m


@functools.cache
def compiled() -> tuple[pathlib.Path, dict[str, int]]:
    design = Bench()
    return build(design, SpoiledCollisions()), design.reasons


class Ros2Node:
    """The node, on `wire`, in whose seconds it counts; its ports have been set, and nothing is enabled yet."""

    def __init__(self, clock: float = CLOCK, wire: Wire | None = None, **ports: int) -> None:
        library, self.reasons = compiled()
        self.model = model = Model(library)
        for name, hertz in (("clk", clock), ("phy_rx_clk", PHY_CLOCK), ("phy_tx_clk", PHY_CLOCK)):
            model.clock(name, hertz)
        steps = CLOCK_HZ // 64
        settings = {
            "prescaler_div": 64,
            "tx_interval_count": steps // 100,
            "tx_period_spdp_wr_count": 3 * steps,
            "tx_period_sedp_pub_hb_count": steps // 10,
            "tx_period_sedp_sub_hb_count": 3 * steps,
            "tx_period_app_wr_count": 1000 * steps,
            "mac_addr": number(bytes.fromhex(OUR_MAC.replace(":", ""))),
            "ip_addr": number(bytes(map(int, ADDRESS.split(".")))),
            "gateway_ip_addr": number(bytes((192, 168, 1, 1))),
            "subnet_mask": number(bytes((255, 255, 255, 0))),
            "ros2_fragment_expiration": CLOCK_HZ,
            "arp_req_retry_count": 4,
            "arp_req_retry_interval": CLOCK_HZ // 2,
            "arp_req_timeout": 30 * CLOCK_HZ,
            "ros2_rx_udp_port": UDP_PORT,
            "ros2_node_udp_port": 52000,
            "ros2_port_num_seed": 7400,
            "ros2_guid_prefix": number(PREFIX),
        }
        for name, text in (
            ("ros2_node_name", NODE),
            ("ros2_pub_topic_name", PUBLISHED),
            ("ros2_pub_topic_type_name", TYPE),
            ("ros2_sub_topic_name", SUBSCRIBED),
            ("ros2_sub_topic_type_name", TYPE),
        ):
            settings[name] = number(text.encode())
            settings[f"{name}_len"] = len(text) + 1
        for name, value in {**settings, **ports}.items():
            model.set(name, value)
        model.set("rst_n", 0)
        model.run(1e-6)
        model.set("rst_n", 1)
        model.set("ether_en", 1)
        self.wire = wire or Wire(FACTOR * clock / CLOCK)
        self.mii = Mii(model)
        self.gates = self.wire.gateware(model, self.mii)

    def __enter__(self) -> Ros2Node:
        return self

    def __exit__(self, *error: object) -> None:
        self.wire.close()
        self.model.close()

    def enable(self, publisher: bool = True, subscriber: bool = True) -> None:
        self.model.set("ros2pub_en", publisher)
        self.model.set("ros2sub_en", subscriber)

    def pulse(self, name: str) -> None:
        """High for a cycle."""
        self.model.set(name, 1)
        self.model.run_cycles("clk", 1)
        self.model.set(name, 0)

    def acquire(self, which: str) -> None:
        """The right to change, or read, what `pub` or `sub` says."""
        self.model.set(f"ros2_{which}_app_data_req", 1)
        for _ in range(10_000):
            self.model.run_cycles("clk", 1)
            if self.model.get(f"ros2_{which}_app_data_grant"):
                break
        else:
            raise TimeoutError(f"no right to touch the data of {which}")
        self.model.set(f"ros2_{which}_app_data_req", 0)

    def publish(self, data: bytes) -> None:
        """Change the message, as the manual says, 4.2."""
        self.acquire("pub")
        self.model.set("ros2_pub_app_data", number(data))
        self.model.set("ros2_pub_app_data_len", len(data))
        self.pulse("ros2_pub_app_data_rel")

    def take(self) -> bytes:
        """Read the message in memory, as the manual says, 4.3."""
        self.acquire("sub")
        data = self.memory()
        self.pulse("ros2_sub_app_data_rel")
        return data

    def memory(self) -> bytes:
        found = bytearray()
        for at in range(self.model.get("ros2_sub_app_data_len")):
            self.model.set("sub_addr", at)
            self.model.run_cycles("clk", 1)
            found.append(self.model.get("sub_data"))
        return bytes(found)

    def drops(self) -> dict[str, int]:
        return dropped(self.model, self.reasons)
