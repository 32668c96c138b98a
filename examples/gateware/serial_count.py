"""A counter in gates, on a serial line in place of Ethernet: std_msgs/UInt32 on `count`, and on `preset` the number from
which it goes on.

The smallest example: it fits an iCE40 HX8K. Of the network it has IP over SLIP (RFC 1055), and room for one peer, which is
the host at the other end of the line:

    roslet gateware sim serial-count
    roslet gateware sim serial-count --pty --seconds 600
    roslet gateware build serial-count --target ice40 --output out
"""

from __future__ import annotations

from amaranth.hdl import ClockDomain, ClockSignal, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import ResetSynchronizer
from amaranth.lib.wiring import Out

from roslet.gateware.tops.links import PING, Serial
from roslet.gateware.tops.ros_node import Publish, RosNode, Subscribe
from roslet.gateware.wires import expose

TYPE = "std_msgs/msg/UInt32"
ADDRESS = "192.168.1.100/24"
LEDS = 4


class Design(wiring.Component):
    """The node at the pins of an FPGA: `clk` with `clk_hz`, a serial line of `baud`, and `led`, the lowest bits of the
    number.

    It counts and publishes `rate` times a second; what is due while an earlier message waits is not sent. With `ping` it
    answers pings, which takes the last of an HX8K's block RAMs.
    """

    def __init__(
        self,
        clk_hz: int = 100_000_000,
        rate: float = 2.0,
        baud: float = 1_000_000,
        counters: bool = False,
        ping: bool = False,
    ) -> None:
        self._period = round(clk_hz / rate)
        self._node = RosNode(
            "serial_count",
            address=ADDRESS,
            topics=[Publish("count", TYPE), Subscribe("preset", TYPE)],
            clk_hz=clk_hz,
            link=Serial(baud, echo_data=PING if ping else None),
            fragments=1,
            participants=1,
            endpoints=4,
            counters=counters,
        )
        self.reasons = self._node.reasons
        pins = self._node.signature.members
        self._pins = [
            name for name in pins if name in ("clk", "rst_n") or name.startswith(("uart_", "drop_"))
        ]
        super().__init__({**{name: pins[name] for name in self._pins}, "led": Out(LEDS)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain()
        m.d.comb += ClockSignal("sync").eq(self.clk)
        m.submodules.reset = ResetSynchronizer(~self.rst_n, domain="sync")
        m.submodules.node = node = self._node
        expose(m, node, self, self._pins)
        number = Signal(32)
        left = Signal(range(self._period), init=self._period - 1)
        m.d.comb += [
            self.led.eq(number),
            node.count.payload.data.eq(number),
            node.preset.ready.eq(~node.count.valid),  # what waits must stay as it is
        ]
        with m.If(node.count.valid & node.count.ready):
            m.d.sync += [node.count.valid.eq(0), number.eq(number + 1)]
        with m.If(node.preset.valid & node.preset.ready):
            m.d.sync += number.eq(node.preset.payload.data)
        m.d.sync += left.eq(left - 1)
        with m.If(left == 0):
            m.d.sync += [left.eq(self._period - 1), node.count.valid.eq(1)]
        return m
