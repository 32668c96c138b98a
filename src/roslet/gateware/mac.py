"""An Ethernet MAC, full duplex, and what a PHY needs besides: its clocks and its reset."""

from __future__ import annotations

from amaranth.hdl import ClockDomain, ClockSignal, DomainRenamer, Module, ResetSignal, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.cdc import PulseSynchronizer, ResetSynchronizer
from amaranth.lib.wiring import In, Out

from roslet.gateware.fifo import AsyncFrameFifo, LossyFrameFifo
from roslet.gateware.phy import WIDTHS, PhySignature
from roslet.gateware.receiver import REASONS, Receiver
from roslet.gateware.stream import FrameSignature
from roslet.gateware.transmitter import Transmitter


def phy_clock(m: Module, domain: str, clock: Value) -> None:
    """Make the clock domain `domain` of a pin, for `m` and what is in it, in reset while `sync` is and a little longer."""
    m.domains += ClockDomain(domain, local=True)
    m.d.comb += ClockSignal(domain).eq(clock)
    m.submodules[f"{domain}_reset"] = ResetSynchronizer(ResetSignal("sync"), domain=domain)


class PhyReset(wiring.Component):
    """Holds the reset of a PHY, `phy_rst_n`, low for `cycles` cycles after the reset of `sync`."""

    def __init__(self, cycles: int) -> None:
        if cycles < 1:
            raise ValueError(f"a reset takes at least one cycle, not {cycles}")
        self._cycles = cycles
        super().__init__({"phy_rst_n": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        left = Signal(range(self._cycles), init=self._cycles - 1)
        with m.If(left == 0):
            m.d.sync += self.phy_rst_n.eq(1)
        with m.Else():
            m.d.sync += left.eq(left - 1)
        return m


class Mac(wiring.Component):
    """Frames between `sync` and a PHY: `phy` is "mii" or "gmii".

    Ports: `pins`, the PHY's, of which those of reception belong to the clock domain `phy_rx`, the others to `phy_tx`: both
    must be there (`phy_clock`). `rx` gives and `tx` takes frames from the destination on, without preamble and FCS; those
    that are received have their padding, those to be sent get it.

    Received frames go through a queue of `rx_depth` items, sent ones through one of `tx_depth`, both powers of two, neither
    of which holds a frame back until it is whole. So a received frame that turns out wrong has a bad end. One cycle in
    `sync`, when that end is taken, is high of `drop_fcs drop_rx_er drop_runt drop_giant drop_odd drop_sfd` (see `Receiver`);
    or, some time after it came, `drop_overflow`: `rx` was not ready for so long that a part of a frame found no room (see
    `LossyFrameFifo`).

    A frame to be sent must come as fast as the line takes it, from its first octet on: be `t` the time of an octet on the
    line, 80 ns or 8 ns, the octet n must be taken not later than (n + 7) t after the first. Else, or where it has more than
    1514 octets or a bad end, what is already on the line is spoilt so that no receiver takes it (see `Transmitter`), and the
    rest forgotten: `drop_underrun` and `drop_tx_giant` are high for one cycle; of a bad end whoever made it knows.

    For the full rate of the line `sync` needs 12.5 MHz with MII and 125 MHz with GMII; the gap between frames makes up for
    clocks that differ by 100 ppm.
    Latency: from the edge with which the first octet at `tx` is taken to the preamble's first bits, at most 6 cycles of
    `phy_tx`; from the first edge without `phy_rx_dv` to the end at `rx`, at most 2 cycles of `phy_rx` and 4 of `sync`.
    """

    def __init__(self, phy: str = "mii", rx_depth: int = 2048, tx_depth: int = 512) -> None:
        pins = PhySignature(phy)
        self._width = WIDTHS[phy]
        self._rx_queue = LossyFrameFifo(rx_depth, "phy_rx", "sync")
        self._tx_queue = AsyncFrameFifo(tx_depth, "sync", "phy_tx")
        drops = (*REASONS, "overflow", "underrun", "tx_giant")
        super().__init__(
            {
                "pins": Out(pins),
                "rx": Out(FrameSignature()),
                "tx": In(FrameSignature()),
                **{f"drop_{reason}": Out(1) for reason in drops},
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        receiver, transmitter = Receiver(self._width), Transmitter(self._width)
        m.submodules.receiver = DomainRenamer("phy_rx")(receiver)
        m.submodules.rx_queue = rx_queue = self._rx_queue
        m.submodules.tx_queue = tx_queue = self._tx_queue
        m.submodules.transmitter = DomainRenamer("phy_tx")(transmitter)
        pins = self.pins
        m.d.comb += [
            receiver.rxd.eq(pins.phy_rxd),
            receiver.rx_dv.eq(pins.phy_rx_dv),
            receiver.rx_er.eq(pins.phy_rx_er),
            pins.phy_txd.eq(transmitter.txd),
            pins.phy_tx_en.eq(transmitter.tx_en),
        ]
        if "phy_tx_er" in pins.signature.members:
            m.d.comb += pins.phy_tx_er.eq(transmitter.tx_er)
        wiring.connect(m, receiver.o, rx_queue.i)
        wiring.connect(m, rx_queue.o, wiring.flipped(self.rx))
        wiring.connect(m, wiring.flipped(self.tx), tx_queue.i)
        wiring.connect(m, tx_queue.o, transmitter.i)

        rx = self.rx.stream
        for n, reason in enumerate(REASONS):
            dropped = rx.valid & rx.ready & rx.payload.bad & rx.payload.data[1 + n]
            m.d.comb += getattr(self, f"drop_{reason}").eq(dropped)
        m.d.comb += self.drop_overflow.eq(rx_queue.drop_overflow)
        for name, event in (("underrun", transmitter.drop_underrun), ("tx_giant", transmitter.drop_giant)):
            m.submodules[name] = crossing = PulseSynchronizer("phy_tx", "sync")
            m.d.comb += [crossing.i.eq(event), getattr(self, f"drop_{name}").eq(crossing.o)]
        return m
