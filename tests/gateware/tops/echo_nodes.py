"""Nodes that send back what comes: one with several topics each way, and one with the longest messages. `clk_hz` as the
periods of the protocol have it."""

from __future__ import annotations

import pathlib

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import connect

import roslet
from roslet.gateware.rtps.tables import Local
from roslet.gateware.tops.ros_core import Identity, RosCore
from roslet.gateware.tops.ros_node import MAX_MESSAGE, Publish, RosNode, Subscribe
from roslet.gateware.wires import expose
from roslet.names.ros2 import dds_type

COORDINATE, TWIST = "mros_comm_measure/msg/Coordinate", "geometry_msgs/msg/Twist"
STRING, OCTET = "std_msgs/msg/String", "std_msgs/msg/UInt8"
NODE = "echoes"
TEXT = dds_type(STRING)

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


class Many(wiring.Component):
    """What comes on `in<n>` goes out on `out<n>`."""

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


class Longest(wiring.Component):
    """What comes on `in` goes out on `out`, a word at a time: texts that make messages of MAX_MESSAGE octets at most."""

    def __init__(self, clk_hz: float) -> None:
        self._core = RosCore(
            Identity("longest", address="192.168.1.100/24"),
            [Local("rt/out", TEXT, reliable=True, words=MAX_MESSAGE // 4)],
            [Local("rt/in", TEXT, reliable=True)],
            clk_hz,
            counters=True,
        )
        self.reasons = self._core.reasons
        members = self._core.signature.members
        self._pins = [name for name in members if not name.startswith(("publish", "receive", "room"))]
        super().__init__({name: members[name] for name in self._pins})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.core = core = self._core
        expose(m, core, self, self._pins)
        o, i = core.publish0.stream, core.receive0.stream
        m.d.comb += [o.payload.eq(i.payload), o.valid.eq(i.valid), i.ready.eq(o.ready), core.room.eq(1)]
        return m
