"""The example udp-tx-rx at the pins of a PHY, compiled, on a wire with a software host."""

from __future__ import annotations

import functools
import pathlib
import runpy
from typing import Any

from gateware.collisions import SpoiledCollisions
from roslet.cli.gateware_sim import dropped
from roslet.engine.net.events import EchoReplied
from roslet.engine.net.host import Host
from roslet.sim.compile import build
from roslet.sim.mii import Mii
from roslet.sim.model import Model
from roslet.sim.wire import Wire

EXAMPLE = pathlib.Path(__file__).parents[3] / "examples" / "gateware" / "udp_tx_rx.py"
OURS, THEIRS, PORT = "192.168.1.100", "192.168.1.10", 1234
OUR_MAC, THEIR_MAC = "02:00:00:00:00:00", "02:00:00:00:00:10"
RATE = 1000
"""Datagrams a second of the design's own time."""
CLOCKS = {"mii": 50e6, "gmii": 125e6}
PHY_CLOCKS = {"mii": 25e6, "gmii": 125e6}


@functools.cache
def compiled(phy: str) -> tuple[pathlib.Path, dict[str, int]]:
    """The library of a design, and the numbers of what it drops."""
    design = runpy.run_path(str(EXAMPLE))["Design"](int(CLOCKS[phy]), RATE, phy, counters=True)
    return build(design, SpoiledCollisions()), design.reasons


class UdpNode:
    """A running design; `wire` has its station, `gates`, and a host, unless there is none."""

    def __init__(
        self, phy: str = "mii", clk_hz: float | None = None, wire: Wire | None = None, host: bool = True
    ) -> None:
        library, self.reasons = compiled(phy)
        self.model = Model(library)
        self.model.clock("clk", clk_hz or CLOCKS[phy], phase=0.1)
        self.model.clock("phy_rx_clk", PHY_CLOCKS[phy] * 1.0001, phase=0.3)
        self.model.clock("phy_tx_clk", PHY_CLOCKS[phy] * 0.9999, phase=0.7)
        self.model.set("rst_n", 0)
        self.model.run(1e-6)
        self.model.set("rst_n", 1)
        self.mii = Mii(self.model)
        self.wire = wire or Wire()
        self.gates = self.wire.gateware(self.model, self.mii)
        if host:
            self.host = Host(THEIR_MAC, f"{THEIRS}/24")
            self.wire.host(self.host)

    def __enter__(self) -> UdpNode:
        return self

    def __exit__(self, *error: object) -> None:
        self.wire.close()
        self.model.close()

    def ping(self, data: bytes = bytes(56), seconds: float = 0.02) -> bytes | None:
        """What the reply repeats, or None."""
        while self.host.next_event() is not None:
            pass
        self.host.ping(OURS, self.wire.now, data)
        got: list[bytes] = []

        def replied() -> bool:
            event = self.host.next_event()
            if isinstance(event, EchoReplied):
                got.append(event.data)
            return bool(got)

        self.wire.run(seconds, replied)
        return got[0] if got else None

    def drops(self) -> dict[str, int]:
        """What was dropped since the reset, by reason."""
        return dropped(self.model, self.reasons)


def take(frames: list[Any]) -> list[bytes]:
    """The frames of what a design sent, none of which may have a fault."""
    assert [sent.faults for sent in frames if sent.faults] == []
    return [sent.frame for sent in frames]
