#!/usr/bin/env python3
# A publisher without a class: one node, one loop.
import time

import rclpy
from rclpy.duration import Duration
from std_msgs.msg import String


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node("talker")
    publisher = node.create_publisher(String, "chatter", 10)
    while publisher.get_subscription_count() == 0:
        time.sleep(0.02)
    message = String()
    for number in range(5):
        message.data = f"news {number}"
        node.get_logger().debug(message.data)
        publisher.publish(message)
    print("acknowledged", publisher.wait_for_all_acked(Duration(seconds=10)))
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
