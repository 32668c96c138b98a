#!/usr/bin/env python3
# A talker that waits for two listeners.
import time

import rclpy
from rclpy.duration import Duration
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("talker")
publisher = node.create_publisher(String, "chatter", 10)
while publisher.get_subscription_count() < 2:
    time.sleep(0.02)
for number in range(5):
    publisher.publish(String(data=f"news {number}"))
publisher.wait_for_all_acked(Duration(seconds=5))
print("told", publisher.get_subscription_count() <= 2)
rclpy.shutdown()
