"""Hears mros_comm_measure/Coordinate on `ping`, checks that none is lost or altered, and sends each back on `pong`.

python coordinate_listener.py
"""

from __future__ import annotations

import argparse
import json
import struct
import sys
import time
from typing import Any

import roslet
from coordinate_talker import DEPTH, Coordinate, coordinate


def main() -> int:
    parser = argparse.ArgumentParser(description="Checks what comes on ping and sends it back on pong.")
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://, which needs no master; or ros1://"
    )
    parser.add_argument("--count", type=int, default=0, help="end after so many messages (default 0: never)")
    parser.add_argument("--seconds", type=float, help="end after so many seconds")
    parser.add_argument("--json", action="store_true", help="report every second, in JSON lines")
    arguments = parser.parse_args()

    with roslet.Node("listener", network=arguments.network) as node:
        pong = node.publisher("pong", Coordinate, qos=DEPTH)
        heard = wrong = 0
        latest: int | None = None

        def callback(message: Any) -> None:
            nonlocal heard, wrong, latest
            if not heard:  # the talker has found us; let us have found it before the first one goes back
                pong.wait_for_subscribers(timeout=1.0)
            pong.publish(message)
            heard += 1
            number = round(message.x / 0.1)
            expected = struct.pack("<3f", *coordinate(number))
            in_order = latest is None or number == latest + 1
            if not in_order or struct.pack("<3f", message.x, message.y, message.z) != expected:
                wrong += 1
                print(f"not what was expected after message {latest}: {message}", file=sys.stderr, flush=True)
            latest = number
            if not arguments.json:
                x, y, z = message.x, message.y, message.z
                print(f"I heard [x: {x:.6f}, y: {y:.6f}, z: {z:.6f}] at {message.time.secs} sec", flush=True)

        def report(final: bool) -> None:
            if arguments.json:
                print(json.dumps({"heard": heard, "wrong": wrong, "final": final}), flush=True)
            elif final:
                print(f"heard {heard}, wrong {wrong}", flush=True)

        def done() -> bool:
            return bool(arguments.count) and heard >= arguments.count

        node.subscribe("ping", Coordinate, callback, qos=DEPTH)
        report(final=False)  # ready
        end = None if arguments.seconds is None else time.monotonic() + arguments.seconds
        try:
            while not node.is_shutdown and not done() and (end is None or time.monotonic() < end):
                node.spin_until(done, timeout=1.0)
                report(final=False)
        except KeyboardInterrupt:
            pass
        report(final=True)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
