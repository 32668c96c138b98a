"""An inertial measurement unit in gates: sensor_msgs/Imu on `imu`, 1,000 times a second, and geometry_msgs/Twist from
`cmd_vel`.

The sensor is made up: its rates and accelerations count up, so that whoever receives them sees whether any is missing.

    roslet gateware build imu-node --target ecp5 --output out
"""

from __future__ import annotations

import struct

from amaranth.hdl import ClockDomain, ClockSignal, Module, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import Out

from roslet.gateware.tops.ros_node import Publish, RosNode, Subscribe
from roslet.gateware.wires import expose
from roslet.gen.gateware import Bounds

ADDRESS = "192.168.1.100/24"
FRAME = b"imu"


def bits(value: float) -> int:
    """A float64 as gates have it."""
    found: int = struct.unpack("<Q", struct.pack("<d", value))[0]
    return found


class Design(wiring.Component):
    """The node at the pins of an FPGA: `clk` with `clk_hz`, the PHY's, and `led`, high while the robot is told to move.

    It measures `rate` times a second; what is due while an earlier message is on its way is not sent.
    """

    def __init__(
        self, clk_hz: int = 100_000_000, phy: str = "mii", counters: bool = False, rate: float = 1000.0
    ) -> None:
        self._clk_hz = clk_hz
        self._period = round(clk_hz / rate)
        self._node = RosNode(
            "imu_node",
            address=ADDRESS,
            topics=[
                Publish("imu", "sensor_msgs/msg/Imu", bounds=Bounds(at={"header.frame_id": 16})),
                Subscribe("cmd_vel", "geometry_msgs/msg/Twist"),
            ],
            clk_hz=clk_hz,
            phy=phy,
            counters=counters,
        )
        self.reasons = self._node.reasons
        pins = {
            name: member
            for name, member in self._node.signature.members.items()
            if name not in ("imu", "cmd_vel")
        }
        self._pins = list(pins)
        super().__init__({**pins, "led": Out(4)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain()
        m.d.comb += ClockSignal("sync").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(~self.rst_n, domain="sync")
        m.submodules.node = node = self._node
        expose(m, node, self, self._pins)
        self._measure(m)
        velocity = node.cmd_vel
        m.d.comb += velocity.ready.eq(1)
        with m.If(velocity.valid):
            moves = Value.cast(velocity.payload.linear.x)[:63] != 0  # neither zero
            m.d.sync += self.led.eq(moves.replicate(4))
        return m

    def _measure(self, m: Module) -> None:
        imu = self._node.imu
        message = imu.payload
        left = Signal(range(self._period), init=self._period - 1)
        seconds, cycles = Signal(32), Signal(range(self._clk_hz))
        number = Signal(20)
        m.d.sync += cycles.eq(cycles + 1)
        with m.If(cycles == self._clk_hz - 1):
            m.d.sync += [cycles.eq(0), seconds.eq(seconds + 1)]
        m.d.sync += left.eq(left - 1)
        with m.If(left == 0):
            m.d.sync += left.eq(self._period - 1)
            with m.If(~imu.valid):
                m.d.sync += [
                    imu.valid.eq(1),
                    number.eq(number + 1),
                    message.header.stamp.sec.eq(seconds),
                    message.angular_velocity.z.eq(bits(1.0) | number << 32),
                    message.linear_acceleration.z.eq(bits(8.0) | number << 32),
                ]
        with m.If(imu.valid & imu.ready):
            m.d.sync += imu.valid.eq(0)
        m.d.comb += [
            message.header.frame_id.length.eq(len(FRAME)),
            *(message.header.frame_id.data[n].eq(octet) for n, octet in enumerate(FRAME)),
            message.orientation.w.eq(bits(1.0)),
            # -1: the orientation is not known (sensor_msgs/Imu)
            message.orientation_covariance[0].eq(bits(-1.0)),
        ]
