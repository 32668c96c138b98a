"""What a node is linked by: Ethernet at the pins of a PHY, or a serial line; each with the stack that it takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from roslet.gateware.fifo import FrameFifo
from roslet.gateware.mac import Mac, PhyReset, phy_clock
from roslet.gateware.slip import SlipLink
from roslet.gateware.slip_stack import SlipStack
from roslet.gateware.stack import UdpStack
from roslet.gateware.stream import FrameSignature
from roslet.gateware.wires import expose
from roslet.wire.net import ethernet, icmp, ipv4, udp

PHY_RESET = 10e-6
"""Seconds. PHYs ask for 1 us (DP83848) or less."""
ARP_TRIES, ARP_INTERVAL, ARP_TIMEOUT = 4, 0.5, 30.0
"""How often, and how many seconds apart, a hardware address is asked for; and seconds for which it is remembered."""
BAUD_ERROR = 0.01
"""How far from what was asked for the bits of a serial line may be: the other half of what a receiver forgives is for the
other end's clock."""
RX_QUEUE = 4096
"""Octets that may come by Ethernet while the node is busy with those before: two frames of the greatest size."""
LINE_QUEUE = 256
"""Octets that a serial line may bring while the node is busy with those before, or 65,000 cycles at 25 a bit."""
UNREGISTERED = 30e6
"""Hertz: up to here the stack of a serial line does without registers between its blocks, as no path is too long."""
PING = 56
"""Octets of data that `ping` sends, unless told otherwise."""


def piece(mtu: int, fragments: int) -> int:
    """Octets of a datagram that one of so many fragments has at most. RFC 791, 3.2: of several, a multiple of 8."""
    room = mtu - ipv4.SIZE
    return room & ~7 if fragments > 1 else room


class EthernetLink(wiring.Component):
    """A MAC with the clocks and the reset of its PHY, and queues of `rx_depth` and `tx_depth` items between it and a stack,
    beside its own, unless they are None.

    `clk_hz`, by which the reset is counted. Ports: `pins` has the names of those of the PHY; `rx` gives and `tx` takes
    frames; `up` is high from the end of the PHY's reset on. `drop_<reason>`, the MAC's.
    """

    kind = "mac"
    """What the names of its drops begin with."""

    def __init__(
        self, mac: Mac, clk_hz: float, rx_depth: int | None = None, tx_depth: int | None = None
    ) -> None:
        self._mac = mac
        self._cycles = max(1, round(PHY_RESET * clk_hz))
        self._depths = {"rx_queue": rx_depth, "tx_queue": tx_depth}
        self._drops = [name for name in mac.signature.members if name.startswith("drop_")]
        pins = {
            "phy_rx_clk": In(1),
            "phy_tx_clk": In(1),
            **mac.pins.signature.members,
            "phy_rst_n": Out(1),
        }
        self.pins = list(pins)
        super().__init__(
            {
                **pins,
                "rx": Out(FrameSignature()),
                "tx": In(FrameSignature()),
                "up": Out(1),
                **{name: Out(1) for name in self._drops},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        phy_clock(m, "phy_rx", self.phy_rx_clk)
        phy_clock(m, "phy_tx", self.phy_tx_clk)
        m.submodules.phy_reset = phy_reset = PhyReset(self._cycles)
        m.submodules.mac = mac = self._mac
        for name, source, sink in (
            ("rx_queue", mac.rx, flipped(self.rx)),
            ("tx_queue", flipped(self.tx), mac.tx),
        ):
            depth = self._depths[name]
            if depth is None:
                connect(m, source, sink)
            else:
                m.submodules[name] = queue = FrameFifo(depth)
                connect(m, source, queue.i)
                connect(m, queue.o, sink)
        m.d.comb += [self.phy_rst_n.eq(phy_reset.phy_rst_n), self.up.eq(phy_reset.phy_rst_n)]
        expose(m, mac.pins, self)
        expose(m, mac, self, self._drops)
        return m


class SerialLink(wiring.Component):
    """IP packets by SLIP over a UART, a bit taking `divisor` cycles: of up to `mtu` octets those that come, of up to `sent`
    those that go; and a queue of `rx_depth` items for what comes while the stack is busy.

    Ports: `uart_rx`, `uart_tx`, whose names `pins` has; `rx` gives and `tx` takes packets; `up`, always high.
    `drop_<reason>`, as `SlipLink` has them; what finds no room in the queue is `drop_uart_overrun`.
    """

    kind = "line"
    pins = ("uart_rx", "uart_tx")

    def __init__(
        self, divisor: int, mtu: int = ethernet.MTU, sent: int = ethernet.MTU, rx_depth: int = LINE_QUEUE
    ) -> None:
        self._slip = slip = SlipLink(divisor, mtu, 1 << sent.bit_length())
        self._queue = FrameFifo(rx_depth)
        members = slip.signature.members
        self._exposed = [name for name in members if name not in ("rx", "tx")]
        super().__init__(
            {
                "rx": Out(FrameSignature()),
                "tx": In(FrameSignature()),
                "up": Out(1),
                **{name: members[name] for name in self._exposed},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.slip = slip = self._slip
        m.submodules.queue = queue = self._queue
        connect(m, slip.rx, queue.i)
        connect(m, queue.o, flipped(self.rx))
        connect(m, flipped(self.tx), slip.tx)
        m.d.comb += self.up.eq(1)
        expose(m, slip, self, self._exposed)
        return m


@dataclass(frozen=True)
class Ethernet:
    """Ethernet: a PHY with `phy`, "mii" or "gmii"; ARP remembers 2**`cache_width` addresses."""

    phy: str = "mii"
    cache_width: int = 4
    mtu: ClassVar[int] = ethernet.MTU

    def build(self, clk_hz: float, fragments: int, longest: int) -> tuple[EthernetLink, UdpStack]:
        """The link, and the stack for a node in one multicast group that sends datagrams of up to `longest` octets."""
        size = piece(self.mtu, fragments)
        stack = UdpStack(
            round(clk_hz),
            groups=1,
            cache_width=self.cache_width,
            echo_data=fragments * size - icmp.SIZE,
            fragments=fragments,
            fragment_size=size,
            longest=longest,
        )
        return EthernetLink(Mac(self.phy, RX_QUEUE), clk_hz, tx_depth=2), stack

    def settings(self, clk_hz: float) -> dict[str, int]:
        """Constant inputs of the stack that other links do not have."""
        return {
            "retry_count": ARP_TRIES,
            "retry_interval": round(clk_hz * ARP_INTERVAL),
            "timeout": round(clk_hz * ARP_TIMEOUT),
        }


@dataclass(frozen=True)
class Serial:
    """A serial line of `baud` bits a second, with packets of up to `mtu` octets; pings of up to `echo_data` are
    answered, or none.

    What a host sends in longer packets is dropped, unless it is told the same MTU: the software of roslet has 1,500.
    """

    baud: float = 1_000_000
    mtu: int = ethernet.MTU
    echo_data: int | None = PING

    def divisor(self, clk_hz: float) -> int:
        """Cycles of a bit. Raises ValueError where no whole number of them comes near enough."""
        cycles = max(1, round(clk_hz / self.baud))
        if abs(clk_hz / cycles / self.baud - 1) > BAUD_ERROR:
            raise ValueError(
                f"with a clock of {clk_hz:g} Hz a line has {clk_hz / cycles:.0f} baud, not {self.baud:g}"
            )
        return cycles

    def build(self, clk_hz: float, fragments: int, longest: int) -> tuple[SerialLink, SlipStack]:
        """The link, and the stack for a node in one multicast group that sends datagrams of up to `longest` octets."""
        stack = SlipStack(
            groups=1,
            echo_data=self.echo_data,
            fragments=fragments,
            fragment_size=piece(self.mtu, fragments),
            mtu=self.mtu,
            longest=longest,
            registers=clk_hz > UNREGISTERED,
        )
        data = max(udp.SIZE + longest, icmp.SIZE + (self.echo_data or 0))
        return SerialLink(self.divisor(clk_hz), self.mtu, min(self.mtu, ipv4.SIZE + data)), stack

    def settings(self, clk_hz: float) -> dict[str, int]:
        """Constant inputs of the stack that other links do not have."""
        return {}
