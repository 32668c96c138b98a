"""Receives sensor_msgs/Image on `image` and saves what it got as a PNG file: the latest, once a second and at the end.

python image_viewer.py --save image.png
"""

from __future__ import annotations

import argparse
import json
import math
import os
import pathlib
import struct
import sys
import time
import zlib
from typing import Any

import roslet
from image_publisher import STEP, picture


def png(width: int, height: int, rgb: bytes | memoryview) -> bytes:
    """A PNG file (RFC 2083) of 8-bit RGB rows without gaps."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    # Before each row stands its filter type, 0: none.
    rows = b"".join(b"\0" + rgb[3 * width * y : 3 * width * (y + 1)] for y in range(height))
    header = struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + chunk(b"IDAT", zlib.compress(rows))
        + chunk(b"IEND", b"")
    )


def save(path: pathlib.Path, message: Any) -> None:
    """Write an rgb8 image in one step, so that whoever looks finds a whole file."""
    beside = path.with_name(path.name + ".part")
    beside.write_bytes(png(message.width, message.height, memoryview(message.data)))
    os.replace(beside, path)


def main() -> int:
    parser = argparse.ArgumentParser(description="Saves pictures from the topic image.")
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://, which needs no master; or ros1://"
    )
    parser.add_argument(
        "--save", type=pathlib.Path, default="image.png", metavar="FILE", help="default: image.png"
    )
    parser.add_argument("--count", type=int, default=0, help="end after so many pictures (default 0: never)")
    parser.add_argument("--seconds", type=float, help="end after so many seconds")
    parser.add_argument(
        "--check",
        action="store_true",
        help="compare with what image_publisher.py sends; exit code 1 where not equal",
    )
    parser.add_argument("--json", action="store_true", help="report every second, in JSON lines")
    arguments = parser.parse_args()

    with roslet.Node("viewer", network=arguments.network) as node:
        received = wrong = 0
        latest: Any = None
        number: int | None = None

        def callback(message: Any) -> None:
            nonlocal received, wrong, latest, number
            received += 1
            latest = message
            if arguments.check:
                width, data = message.width, bytes(message.data)
                # Whichever comes first; from then on the next one each time. They begin again when the bands are round.
                candidates = range(1, width // math.gcd(STEP, width) + 1) if number is None else [number + 1]
                found = [one for one in candidates if data == picture(one, width, message.height)]
                if not found:
                    wrong += 1
                    print(
                        f"what came after picture {number} is not the next one", file=sys.stderr, flush=True
                    )
                number = found[0] if found else None

        def report(final: bool) -> None:
            if latest is not None and latest.encoding == "rgb8":
                save(arguments.save, latest)
            if arguments.json:
                print(json.dumps({"received": received, "wrong": wrong, "final": final}), flush=True)
            elif latest is not None:
                size = f"{latest.width} x {latest.height}, {latest.encoding}"
                print(f"received {received}, latest {size}, in {arguments.save}", flush=True)

        def done() -> bool:
            return bool(arguments.count) and received >= arguments.count

        node.subscribe("image", "sensor_msgs/Image", callback)
        end = None if arguments.seconds is None else time.monotonic() + arguments.seconds
        try:
            while not node.is_shutdown and not done() and (end is None or time.monotonic() < end):
                node.spin_until(done, timeout=1.0)
                report(final=False)
        except KeyboardInterrupt:
            pass
        report(final=True)
    return 1 if wrong or not received else 0


if __name__ == "__main__":
    sys.exit(main())
