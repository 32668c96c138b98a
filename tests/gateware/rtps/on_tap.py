"""The counting node on a TAP device, in the time of the wall clock: on_tap.py SECONDS [pcap FILE].

Prints one JSON line each time something changed: the participants and endpoints it knows, how many messages it received and
the last of them, what it dropped. Silent, in reset, after SIGUSR1, until SIGUSR2.
"""

from __future__ import annotations

import json
import pathlib
import signal
import sys
from typing import Any

sys.path.insert(0, str(pathlib.Path(__file__).parents[2]))

from gateware.rtps.counter_node import FACTOR, Running
from gateware.running import plug_tap
from roslet.sim.wire import Wire

LOOK = 0.1


def main() -> None:
    seconds = float(sys.argv[1])
    wire = Wire(FACTOR, 1.0)
    with Running(reliable=True, wire=wire) as node:
        plug_tap(wire)
        capture = wire.capture(pathlib.Path(sys.argv[3])) if len(sys.argv) > 3 else None
        node.model.set("enable", 1)
        print("up", flush=True)
        for number, level in ((signal.SIGUSR1, 0), (signal.SIGUSR2, 1)):
            signal.signal(number, lambda *_, level=level: node.model.set("rst_n", level))
        said: dict[str, Any] = {}
        while wire.now < seconds:
            wire.run(LOOK)
            now = {
                "alive": node.model.get("alive").bit_count(),
                "matched": node.model.get("matched").bit_count(),
                "received": node.model.get("received"),
                "count": node.model.get("count"),
                "sent": node.model.get("number"),
            }
            if now != said:
                said = now
                print(json.dumps({**now, "dropped": node.drops()}), flush=True)
        print(json.dumps({"dropped": node.drops(), "faults": node.gates.faults}), flush=True)
        if capture is not None:
            capture.close()


main()
