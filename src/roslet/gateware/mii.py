"""The Media Independent Interface: 4 bits at 25 MHz for 100 Mbit/s, at 2.5 MHz for 10. IEEE 802.3, 22."""

from __future__ import annotations

from amaranth.lib.wiring import In, Out, Signature

from roslet.gateware.receiver import Receiver
from roslet.gateware.transmitter import Transmitter

WIDTH = 4


class MiiSignature(Signature):
    """The pins of a PHY, seen from the MAC: `phy_rx...` in the clock `phy_rx_clk`, the others in `phy_tx_clk`."""

    def __init__(self) -> None:
        super().__init__(
            {
                "phy_rxd": In(WIDTH),
                "phy_rx_dv": In(1),
                "phy_rx_er": In(1),
                "phy_txd": Out(WIDTH),
                "phy_tx_en": Out(1),
            }
        )


class MiiRx(Receiver):
    """`Receiver` for nibbles, with `sync` the clock `phy_rx_clk`."""

    def __init__(self) -> None:
        super().__init__(WIDTH)


class MiiTx(Transmitter):
    """`Transmitter` for nibbles, with `sync` the clock `phy_tx_clk`. Many PHYs have no `tx_er`: nothing depends on it."""

    def __init__(self) -> None:
        super().__init__(WIDTH)
