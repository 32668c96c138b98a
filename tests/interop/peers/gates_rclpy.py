"""An ordinary rclpy node: gates_rclpy.py NAME SECONDS [latched].

Subscribes to `count`, publishes `shown`, and prints what it sees; `latched` wants what was published before it subscribed.
"""

import json
import signal
import sys
import time

import rclpy
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile
from std_msgs.msg import UInt32

name, seconds = sys.argv[1], float(sys.argv[2])
rclpy.init()
node = rclpy.create_node(name)
got = []
unmet = []
events = SubscriptionEventCallbacks(
    incompatible_qos=lambda event: unmet.append(QoSPolicyKind(event.last_policy_kind).name)
)
latched = "latched" in sys.argv
durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
node.create_subscription(
    UInt32,
    "count",
    lambda message: got.append(message.data),
    QoSProfile(depth=10, durability=durability),
    event_callbacks=events,
)
publisher = node.create_publisher(UInt32, "shown", 10)
ends = time.monotonic() + seconds
stopped = []
signal.signal(signal.SIGINT, lambda *_: stopped.append(True))
number, due = 0, 0.0
while time.monotonic() < ends and not stopped:
    rclpy.spin_once(node, timeout_sec=0.05)
    if time.monotonic() > due:
        due = time.monotonic() + 0.2
        number += 1
        publisher.publish(UInt32(data=1000 + number))
        infos = node.get_publishers_info_by_topic("count")
        said = {
            "got": got,
            "unmet": unmet,
            "nodes": sorted(name for name, _ in node.get_node_names_and_namespaces()),
            "subscribers": publisher.get_subscription_count(),
            "own": [str(info.topic_type_hash) for info in node.get_publishers_info_by_topic("shown")],
            "hashes": [str(info.topic_type_hash) for info in infos],
            "publishers": [info.node_name for info in infos],
        }
        print(json.dumps(said), flush=True)
node.destroy_node()
rclpy.shutdown()
