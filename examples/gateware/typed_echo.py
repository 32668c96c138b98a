"""The echo-back node of the mROS paper, in gates: what comes on `ping` goes out on `pong`. Its type is one of the user's
own.

roslet gateware build typed-echo --target ecp5 --output out
"""

from __future__ import annotations

import pathlib

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import connect

import roslet
from roslet.gateware.tops.ros_node import Publish, RosNode, Subscribe
from roslet.gateware.wires import expose

TYPES = pathlib.Path(__file__).parents[1] / "msgs" / "mros_comm_measure"
TYPE = "mros_comm_measure/msg/Coordinate"
ADDRESS = "192.168.1.100/24"


class Design(wiring.Component):
    """The node at the pins of an FPGA: `clk` with `clk_hz`, and the PHY's."""

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
        super().__init__({name: member for name, member in members.items() if name not in ("ping", "pong")})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.node = node = self._node
        expose(m, node, self, self.signature.members)
        connect(m, node.ping, node.pong)
        return m
