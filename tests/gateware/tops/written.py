"""A module of Verilog at the pins of a PHY, to be simulated."""

from __future__ import annotations

import pathlib
from collections.abc import Iterable, Mapping
from typing import Any

from amaranth.hdl import Instance, Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

MII: dict[str, Any] = {
    **dict.fromkeys(("clk", "rst_n", "phy_rx_clk", "phy_tx_clk", "phy_rx_dv", "phy_rx_er"), In(1)),
    **dict.fromkeys(("phy_tx_en", "phy_rst_n"), Out(1)),
    "phy_rxd": In(4),
    "phy_txd": Out(4),
}


class Written(wiring.Component):
    """The module `name` of the files `verilog`, whose ports are those of MII and `more`."""

    def __init__(
        self, name: str, verilog: Iterable[pathlib.Path], more: Mapping[str, Any] | None = None
    ) -> None:
        self._name, self.verilog = name, tuple(verilog)
        super().__init__({**MII, **(more or {})})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        ports = {
            f"{'i' if member.flow == In else 'o'}_{name}": getattr(self, name)
            for name, member in self.signature.members.items()
        }
        m.submodules.written = Instance(self._name, **ports)
        return m
