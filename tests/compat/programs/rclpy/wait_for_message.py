#!/usr/bin/env python3
# wait_for_message, and durability: what a late subscription gets.
import threading
import time

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import Int32, String

rclpy.init()
node = rclpy.create_node("waiting")
print(wait_for_message(String, node, "nothing", time_to_wait=0.2))
kept = QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
publisher = node.create_publisher(Int32, "kept", kept)
for number in range(5):
    publisher.publish(Int32(data=number))
print(
    wait_for_message(
        Int32,
        node,
        "kept",
        qos_profile=QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL),
        time_to_wait=5.0,
    )
)
heard = []
node.create_subscription(Int32, "kept", lambda message: heard.append(message.data), kept)
end = time.monotonic() + 5
while len(heard) < 3 and time.monotonic() < end:
    rclpy.spin_once(node, timeout_sec=0.1)
print(heard)
now_and_then = node.create_publisher(String, "sometimes", 10)


def publish():
    while now_and_then.get_subscription_count() == 0:
        time.sleep(0.02)
    now_and_then.publish(String(data="at last"))


thread = threading.Thread(target=publish)
thread.start()
print(wait_for_message(String, node, "sometimes", time_to_wait=10.0))
thread.join()
late = []
node.create_subscription(String, "sometimes", late.append, 10)
for _ in range(5):
    rclpy.spin_once(node, timeout_sec=0.05)
print(late)
rclpy.shutdown()
