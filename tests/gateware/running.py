"""A simulated design on its way: its clocks, its reset, its wire, and the kernel at the other side of a TAP device."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING, Any

from roslet.sim.mii import Mii
from roslet.sim.tap import Tap

if TYPE_CHECKING:
    from roslet.sim.model import Model
    from roslet.sim.wire import GatewareStation, Wire

PHY_CLOCK = 25e6
HOST = "192.168.1.10/24"


def started(model: Model, wire: Wire, clock: float, link: Any = None) -> GatewareStation:
    """The design with a `clk` of so many Hz and a PHY of 100 Mbit/s, out of its reset, on the wire."""
    for name, hertz in (("clk", clock), ("phy_rx_clk", PHY_CLOCK), ("phy_tx_clk", PHY_CLOCK)):
        model.clock(name, hertz)
    model.set("rst_n", 0)
    model.run(1e-6)
    model.set("rst_n", 1)
    return wire.gateware(model, Mii(model), link)


def plug_tap(wire: Wire) -> None:
    """Have the kernel on the wire as HOST, by a device tap0, where groups are too."""
    wire.tap(Tap("tap0"))
    for command in (
        ["ip", "address", "add", HOST, "dev", "tap0"],
        ["ip", "link", "set", "tap0", "up"],
        ["ip", "route", "add", "224.0.0.0/4", "dev", "tap0"],
    ):
        subprocess.run(command, check=True)
