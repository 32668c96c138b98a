"""The node of `many_node` on a TAP device, in the time of the wall clock: many_on_tap.py SECONDS."""

from __future__ import annotations

import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[2]))

from gateware.tops.many_node import Echoes
from roslet.sim.mii import Mii
from roslet.sim.model import Model
from roslet.sim.tap import Tap
from roslet.sim.wire import Wire

HOST = "192.168.1.10/24"
CLOCK, PHY_CLOCK, FACTOR = 50e6, 25e6, 250.0


def main() -> None:
    with Model(Echoes(CLOCK / FACTOR)) as model:
        for name, hertz in (("clk", CLOCK), ("phy_rx_clk", PHY_CLOCK), ("phy_tx_clk", PHY_CLOCK)):
            model.clock(name, hertz)
        model.set("rst_n", 0)
        model.run(1e-6)
        model.set("rst_n", 1)
        wire = Wire(FACTOR, 1.0)
        wire.gateware(model, Mii(model))
        wire.tap(Tap("tap0"))
        for command in (
            ["ip", "address", "add", HOST, "dev", "tap0"],
            ["ip", "link", "set", "tap0", "up"],
            ["ip", "route", "add", "224.0.0.0/4", "dev", "tap0"],
        ):
            subprocess.run(command, check=True)
        print("up", flush=True)
        wire.run(float(sys.argv[1]))
        wire.close()


main()
