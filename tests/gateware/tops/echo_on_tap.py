"""A node of `echo_nodes` on a TAP device, in the time of the wall clock: echo_on_tap.py many|longest SECONDS."""

from __future__ import annotations

import pathlib
import sys
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).parents[2]))

from gateware.running import plug_tap, started
from gateware.tops.echo_nodes import Longest, Many
from roslet.sim.model import Model
from roslet.sim.wire import Wire

DESIGNS: dict[str, Any] = {"many": Many, "longest": Longest}
CLOCK, FACTOR = 50e6, 250.0


def main() -> None:
    name, seconds = sys.argv[1:]
    with Model(DESIGNS[name](CLOCK / FACTOR)) as model:
        wire = Wire(FACTOR, 1.0)
        started(model, wire, CLOCK)
        plug_tap(wire)
        print("up", flush=True)
        wire.run(float(seconds))
        wire.close()


main()
