"""Publishes sensor_msgs/Image at 10 Hz on `image`: a test picture that moves.

python image_viewer.py &
python image_publisher.py
"""

from __future__ import annotations

import argparse
import colorsys
import json
import sys
import time
from typing import Any

import roslet

# Pixels by which the picture moves each time.
STEP = 4


def picture(number: int, width: int, height: int) -> bytes:
    """Picture `number`, counted from 1, as rgb8 rows: slanted bands of all colours, which move by STEP pixels a picture."""
    band = bytearray()
    for at in range(width):
        band += bytes(round(255 * part) for part in colorsys.hsv_to_rgb(at / width, 1.0, 1.0))
    ring = bytes(band * 2)
    rows = []
    for y in range(height):
        begin = 3 * ((STEP * number + y) % width)
        rows.append(ring[begin : begin + 3 * width])
    return b"".join(rows)


def main() -> int:
    parser = argparse.ArgumentParser(description="A moving test picture on the topic image.")
    parser.add_argument(
        "--network", default="ros2://", help="default: ros2://, which needs no master; or ros1://"
    )
    parser.add_argument("--rate", type=float, default=10.0, help="pictures a second (default 10)")
    parser.add_argument("--count", type=int, default=0, help="end after so many pictures (default 0: never)")
    parser.add_argument("--width", type=int, default=320)
    parser.add_argument("--height", type=int, default=240)
    parser.add_argument("--json", action="store_true", help="report every second, in JSON lines")
    arguments = parser.parse_args()
    width, height = arguments.width, arguments.height

    with roslet.Node("camera", network=arguments.network) as node:
        image = node.publisher("image", "sensor_msgs/Image")
        image.wait_for_subscribers(timeout=10.0)
        kind: Any = image.type
        message = kind(height=height, width=width, encoding="rgb8", step=3 * width)
        message.header.frame_id = "camera"
        rate = node.rate(arguments.rate)
        number = 0

        def report(final: bool) -> None:
            if arguments.json:
                print(json.dumps({"sent": number, "final": final}), flush=True)
            elif final:
                print(f"sent {number} pictures", flush=True)

        next_report = time.monotonic() + 1.0
        try:
            while not node.is_shutdown and (not arguments.count or number < arguments.count):
                number += 1
                message.header.stamp = node.now()
                message.data = picture(number, width, height)
                image.publish(message)
                rate.sleep()
                if time.monotonic() >= next_report:
                    next_report += 1.0
                    report(final=False)
        except KeyboardInterrupt:
            pass
        report(final=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
