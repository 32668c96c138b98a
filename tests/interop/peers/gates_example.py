"""An ordinary rclpy node beside an example of gateware: gates_example.py topic-pub-sub|imu-node SECONDS.

Subscribes to what the example publishes, publishes what it takes, and prints what it sees.
"""

import json
import signal
import sys
import time

import rclpy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Imu
from std_msgs.msg import String


def velocity() -> Twist:
    message = Twist()
    message.linear.x = 0.5
    return message


EXAMPLES = {
    "topic-pub-sub": (String, "bbb", lambda text: text.data, "aaa", lambda: String(data="fifteen octets!")),
    "imu-node": (Imu, "imu", lambda imu: imu.angular_velocity.z, "cmd_vel", velocity),
}

kind, topic, value, told, message = EXAMPLES[sys.argv[1]]
ends = time.monotonic() + float(sys.argv[2])
rclpy.init()
node = rclpy.create_node("peer")
got = []
node.create_subscription(kind, topic, lambda heard: got.append(value(heard)), 10)
publisher = node.create_publisher(type(message()), told, 10)
stopped = []
signal.signal(signal.SIGINT, lambda *_: stopped.append(True))
due = 0.0
while time.monotonic() < ends and not stopped:
    rclpy.spin_once(node, timeout_sec=0.05)
    if time.monotonic() > due:
        due = time.monotonic() + 0.2
        publisher.publish(message())
        infos = node.get_publishers_info_by_topic(topic)
        said = {
            "got": got[:20],
            "nodes": sorted(name for name, _ in node.get_node_names_and_namespaces()),
            "subscribers": publisher.get_subscription_count(),
            "types": [info.topic_type for info in infos],
            "publishers": [info.node_name for info in infos],
            "hashes": [str(info.topic_type_hash) for info in infos],
            "own": [str(info.topic_type_hash) for info in node.get_subscriptions_info_by_topic(topic)],
        }
        print(json.dumps(said), flush=True)
node.destroy_node()
rclpy.shutdown()
