"""A design with MII or GMII pins that sends back what it receives, symbol by symbol, through three clock domains."""

from __future__ import annotations

from typing import Any

from amaranth.hdl import Cat, ClockDomain, ClockSignal, Module, ResetSignal, Signal
from amaranth.lib import fifo, wiring
from amaranth.lib.wiring import In, Out

from roslet.sim.mii import Mii
from roslet.sim.model import Model

DEPTH = 64
START = 24
"""Symbols that are waited for before sending begins, so that clocks that differ a little do no harm."""


class Echo(wiring.Component):
    """What comes in by the rx pins goes out by the tx pins, with rx_er as tx_er; `invert` turns each data bit, `frames`
    counts, `wide_copy` is `wide`. Gaps come out no longer than 24 symbols, and for the rest as they were."""

    def __init__(self, width: int = 4) -> None:
        self._width = width
        super().__init__(
            {
                "clk": In(1),
                "rst_n": In(1),
                "phy_rx_clk": In(1),
                "phy_rxd": In(width),
                "phy_rx_dv": In(1),
                "phy_rx_er": In(1),
                "phy_tx_clk": In(1),
                "phy_txd": Out(width),
                "phy_tx_en": Out(1),
                "phy_tx_er": Out(1),
                "invert": In(1),
                "wide": In(77),
                "wide_copy": Out(77),
                "frames": Out(16),
                "busy": Out(1),
            }
        )

    def elaborate(self, platform: object) -> Module:
        m = Module()
        for name, clock in (("sync", self.clk), ("phy_rx", self.phy_rx_clk), ("phy_tx", self.phy_tx_clk)):
            setattr(m.domains, name, ClockDomain(name))
            m.d.comb += [ClockSignal(name).eq(clock), ResetSignal(name).eq(~self.rst_n)]
        bits = self._width + 2  # data, error, end
        m.submodules.rx = rx = fifo.AsyncFIFOBuffered(
            width=bits, depth=DEPTH, r_domain="sync", w_domain="phy_rx"
        )
        m.submodules.tx = tx = fifo.AsyncFIFOBuffered(
            width=bits, depth=DEPTH, r_domain="phy_tx", w_domain="sync"
        )
        was = Signal()
        m.d.phy_rx += was.eq(self.phy_rx_dv)
        m.d.comb += [
            rx.w_en.eq(self.phy_rx_dv | was),
            rx.w_data.eq(Cat(self.phy_rxd, self.phy_rx_er, ~self.phy_rx_dv)),
            self.busy.eq(rx.r_rdy | self.phy_tx_en),
        ]
        data: Any = rx.r_data
        turned = data[: self._width] ^ self.invert.replicate(self._width)
        m.d.comb += [
            tx.w_data.eq(Cat(turned, data[self._width :])),
            tx.w_en.eq(rx.r_rdy),
            rx.r_en.eq(tx.w_rdy),
        ]
        m.d.sync += self.wide_copy.eq(self.wide)
        with m.If(rx.r_rdy & tx.w_rdy & data[-1]):
            m.d.sync += self.frames.eq(self.frames + 1)
        sending = Signal()
        end: Any = tx.r_data[-1]
        with m.If(sending):
            m.d.comb += tx.r_en.eq(1)
            m.d.phy_tx += [
                self.phy_txd.eq(tx.r_data),
                self.phy_tx_er.eq(tx.r_data[self._width]),
                self.phy_tx_en.eq(~end),
            ]
            with m.If(end):
                m.d.phy_tx += [sending.eq(0), self.phy_tx_er.eq(0)]
        with m.Elif(tx.r_level >= START):
            m.d.phy_tx += sending.eq(1)
        return m


def plugged(
    width: int = 4, rx_phase: float = 0.1, tx_phase: float = 0.6, core: float = 50e6
) -> tuple[Model, Mii]:
    """A running echo and the PHY at its pins."""
    model = Model(Echo(width))
    hz = 25e6 if width == 4 else 125e6
    model.clock("clk", core)
    model.clock("phy_rx_clk", hz, rx_phase)
    model.clock("phy_tx_clk", hz, tx_phase)
    model.set("rst_n", 0)
    model.run(2e-7)
    model.set("rst_n", 1)
    return model, Mii(model)
