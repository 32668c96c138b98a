"""The example serial-count at the end of a serial line, in whose seconds it counts."""

from __future__ import annotations

import functools
import pathlib
import runpy
from types import TracebackType

from gateware.collisions import SpoiledCollisions
from peers import ROOT
from roslet.cli.gateware_sim import dropped
from roslet.sim.compile import build
from roslet.sim.link import Link
from roslet.sim.model import Model
from roslet.sim.uart import Uart
from roslet.sim.wire import Wire

CLOCK, FACTOR, DIVISOR = 50e6, 250.0, 8
CLOCK_HZ = round(CLOCK / FACTOR)
BAUD = CLOCK_HZ / DIVISOR
ADDRESS, HOST = "192.168.1.100", "192.168.1.10"


@functools.cache
def compiled() -> tuple[pathlib.Path, dict[str, int]]:
    """The library, and the numbers of what is dropped."""
    design = runpy.run_path(str(ROOT / "examples" / "gateware" / "serial_count.py"))["Design"]
    top = design(CLOCK_HZ, baud=BAUD, counters=True, ping=True)
    return build(top, SpoiledCollisions()), top.reasons


class SerialNode:
    """The node, on a line that `link` is the other end of; without one it is a port of `wire.hub`."""

    def __init__(self, wire: Wire, link: Link | None = None) -> None:
        library, self.reasons = compiled()
        self.model = Model(library)
        self.model.clock("clk", CLOCK)
        self.uart = Uart(self.model, CLOCK / DIVISOR)
        self.reset()
        self.wire = wire
        self.station = wire.serial(self.model, self.uart, link)

    def __enter__(self) -> SerialNode:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: object, trace: TracebackType | None) -> None:
        self.wire.close()
        self.model.close()

    def reset(self) -> None:
        """As when the power comes on, but that it has known another time."""
        self.model.set("rst_n", 0)
        self.model.run(1e-6)
        self.model.set("rst_n", 1)

    def drops(self) -> dict[str, int]:
        """What it has dropped since its reset, by reason."""
        return dropped(self.model, self.reasons)
