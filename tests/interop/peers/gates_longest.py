"""An ordinary rclpy node beside one in gates that sends back texts: gates_longest.py SECONDS.

Publishes on `in` texts that make messages of 1,390 to 1,400 octets, each when the one before came back on `out`, or again
after a while, and prints how long those were that came back as they were, and how many did not.
"""

import json
import signal
import sys
import time

import rclpy
from std_msgs.msg import String

LENGTHS = range(1385, 1396)
PATIENCE = 2.0

ends = time.monotonic() + float(sys.argv[1])
rclpy.init()
node = rclpy.create_node("peer")
texts = [chr(ord("a") + n) * length for n, length in enumerate(LENGTHS)]
same, other = [], []


def heard(text: String) -> None:
    (same if text.data in texts else other).append(len(text.data))


node.create_subscription(String, "out", heard, 10)
publisher = node.create_publisher(String, "in", 10)
stopped = []
signal.signal(signal.SIGINT, lambda *_: stopped.append(True))
due, at = 0.0, 0
while time.monotonic() < ends and not stopped:
    rclpy.spin_once(node, timeout_sec=0.05)
    back = len(texts[at]) in same
    if back and at + 1 < len(texts):
        at, due = at + 1, 0.0
    if time.monotonic() > due:
        due = time.monotonic() + PATIENCE
        publisher.publish(String(data=texts[at]))
        print(json.dumps({"same": sorted(set(same)), "other": other}), flush=True)
node.destroy_node()
rclpy.shutdown()
