"""The pins of a PHY. IEEE 802.3: MII, 22, 4 bits at 25 MHz for 100 Mbit/s; GMII, 35, 8 bits at 125 MHz for 1 Gbit/s."""

from __future__ import annotations

from typing import Any

from amaranth.lib.wiring import In, Out, Signature

WIDTHS = {"mii": 4, "gmii": 8}
"""Bits of data beside each other, by the name of the interface."""


class PhySignature(Signature):
    """The pins, seen from the MAC, without clocks: `phy_rx...` belong to `phy_rx_clk`; the others to `phy_tx_clk`, or with
    GMII to the clock that the MAC's side gives to the PHY (GTX_CLK). Many PHYs with MII have no `phy_tx_er`: only GMII has
    it here, and nothing depends on it.

    Raises ValueError for an interface that is not in WIDTHS.
    """

    def __init__(self, interface: str) -> None:
        if interface not in WIDTHS:
            raise ValueError(f"a PHY is one of {', '.join(WIDTHS)}, not {interface!r}")
        width = WIDTHS[interface]
        members: dict[str, Any] = {
            "phy_rxd": In(width),
            "phy_rx_dv": In(1),
            "phy_rx_er": In(1),
            "phy_txd": Out(width),
            "phy_tx_en": Out(1),
        }
        if interface == "gmii":
            members["phy_tx_er"] = Out(1)
        super().__init__(members)
