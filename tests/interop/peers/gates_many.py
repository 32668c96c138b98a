"""An ordinary rclpy node beside one in gates that has several topics each way: gates_many.py SECONDS.

Publishes on some of `in<n>` and prints what comes back on `out<n>`, by topic, and what the graph says of the other node.
"""

import json
import signal
import sys
import time

import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import String, UInt8


def twist(number: int) -> Twist:
    message = Twist()
    message.linear.x, message.angular.z = 4.0, float(number)
    return message


TOPICS = {
    0: (String, lambda number: String(data=f"0 {number}"), lambda text: int(text.data.split()[1])),
    2: (UInt8, lambda number: UInt8(data=number % 256), lambda octet: octet.data),
    3: (
        String,
        lambda number: String(data=f"3 {number} ".ljust(150, "x")),
        lambda text: int(text.data.split()[1]),
    ),
    4: (Twist, twist, lambda velocity: int(velocity.angular.z)),
}
OTHER = ("echoes", "/")

ends = time.monotonic() + float(sys.argv[1])
rclpy.init()
node = rclpy.create_node("peer")
got = {topic: [] for topic in TOPICS}
publishers = {}
for topic, (kind, _, value) in TOPICS.items():
    node.create_subscription(
        kind, f"out{topic}", lambda heard, n=topic, of=value: got[n].append(of(heard)), 10
    )
    publishers[topic] = node.create_publisher(kind, f"in{topic}", 10)
stopped = []
signal.signal(signal.SIGINT, lambda *_: stopped.append(True))
due, number = 0.0, 0
while time.monotonic() < ends and not stopped:
    rclpy.spin_once(node, timeout_sec=0.05)
    if time.monotonic() > due:
        due, number = time.monotonic() + 0.3, number + 1
        for topic, (_, message, _) in TOPICS.items():
            publishers[topic].publish(message(number))
        known = "echoes" in node.get_node_names()
        said = {
            "got": {topic: numbers[:20] for topic, numbers in got.items()},
            "publishes": dict(node.get_publisher_names_and_types_by_node(*OTHER)) if known else {},
            "subscribes": dict(node.get_subscriber_names_and_types_by_node(*OTHER)) if known else {},
        }
        print(json.dumps(said), flush=True)
node.destroy_node()
rclpy.shutdown()
