"""The echo-back node of the mROS paper, in gates: what comes on `ping` goes out on `pong`. Its type is one of the user's
own.

roslet gateware build typed-echo --target ecp5 --output out
"""

from __future__ import annotations

import pathlib

from amaranth.hdl import ClockDomain, ClockSignal, Module
from amaranth.lib import wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import Out, connect

import roslet
from roslet.gateware.tops.ros_node import Publish, RosNode, Subscribe
from roslet.gateware.wires import expose

TYPES = pathlib.Path(__file__).parents[1] / "msgs" / "mros_comm_measure"
TYPE = "mros_comm_measure/msg/Coordinate"
ADDRESS = "192.168.1.100/24"


class Design(wiring.Component):
    """The node at the pins of an FPGA: `clk` with `clk_hz`, the PHY's, and `led`, which counts what was echoed."""

    def __init__(self, clk_hz: int = 100_000_000, phy: str = "mii", counters: bool = False) -> None:
        roslet.load(TYPES)
        self._node = RosNode(
            "typed_echo",
            address=ADDRESS,
            topics=[Subscribe("ping", TYPE), Publish("pong", TYPE)],
            clk_hz=clk_hz,
            phy=phy,
            counters=counters,
        )
        self.reasons = self._node.reasons
        members = self._node.signature.members
        self._pins = [name for name in members if name not in ("ping", "pong")]
        super().__init__({**{name: members[name] for name in self._pins}, "led": Out(4)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain()
        m.d.comb += ClockSignal("sync").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(~self.rst_n, domain="sync")
        m.submodules.node = node = self._node
        expose(m, node, self, self._pins)
        connect(m, node.ping, node.pong)
        with m.If(node.ping.valid & node.ping.ready):
            m.d.sync += self.led.eq(self.led + 1)
        return m
