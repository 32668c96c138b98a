"""A node with several topics each way, which sends back what comes."""

from __future__ import annotations

import pathlib

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import connect

import roslet
from roslet.gateware.tops.ros_node import Publish, RosNode, Subscribe
from roslet.gateware.wires import expose

COORDINATE, TWIST = "mros_comm_measure/msg/Coordinate", "geometry_msgs/msg/Twist"
STRING, OCTET = "std_msgs/msg/String", "std_msgs/msg/UInt8"
NODE = "echoes"

Pair = tuple[str, int | None, bool, int]
"""The type, the bound of its texts, whether it is reliable, and how many messages the node keeps."""
PAIRS: list[Pair] = [
    (STRING, 40, True, 1),
    (COORDINATE, None, True, 4),
    (OCTET, None, True, 1),
    (STRING, 200, True, 2),
    (TWIST, None, True, 1),
    (COORDINATE, None, False, 1),
]


def load() -> None:
    """Have the types known that are not bundled."""
    roslet.load(pathlib.Path(__file__).parents[3] / "examples/msgs/mros_comm_measure")


class Echoes(wiring.Component):
    """What comes on `in<n>` goes out on `out<n>`; `clk_hz` as the periods of the protocol have it."""

    def __init__(self, clk_hz: float) -> None:
        load()
        topics: list[Publish | Subscribe] = []
        for n, (type_, bound, reliable, depth) in enumerate(PAIRS):
            topics.append(Subscribe(f"in{n}", type_, bound, reliable=reliable))
            topics.append(Publish(f"out{n}", type_, bound, reliable=reliable, depth=depth))
        self._node = RosNode(NODE, topics=topics, clk_hz=clk_hz, endpoints=32)
        members = self._node.signature.members
        self._pins = [name for name in members if not name.startswith(("in", "out"))]
        super().__init__({name: members[name] for name in self._pins})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.node = node = self._node
        expose(m, node, self, self._pins)
        for n in range(len(PAIRS)):
            connect(m, getattr(node, f"in{n}"), getattr(node, f"out{n}"))
        return m
