"""The Gigabit Media Independent Interface: 8 bits at 125 MHz. IEEE 802.3, 35."""

from __future__ import annotations

from amaranth.lib.wiring import In, Out, Signature

from roslet.gateware.receiver import Receiver
from roslet.gateware.transmitter import Transmitter

WIDTH = 8


class GmiiSignature(Signature):
    """The pins of a PHY, seen from the MAC: `phy_rx...` in the clock `phy_rx_clk`, the others in the one that the MAC's side
    gives to the PHY (GTX_CLK)."""

    def __init__(self) -> None:
        super().__init__(
            {
                "phy_rxd": In(WIDTH),
                "phy_rx_dv": In(1),
                "phy_rx_er": In(1),
                "phy_txd": Out(WIDTH),
                "phy_tx_en": Out(1),
                "phy_tx_er": Out(1),
            }
        )


class GmiiRx(Receiver):
    """`Receiver` for octets, with `sync` the clock `phy_rx_clk`."""

    def __init__(self) -> None:
        super().__init__(WIDTH)


class GmiiTx(Transmitter):
    """`Transmitter` for octets, with `sync` the clock GTX_CLK."""

    def __init__(self) -> None:
        super().__init__(WIDTH)
