#!/usr/bin/env python3
# A subscription whose callback is a function, and a loop of spin_once.
import rclpy
from std_msgs.msg import String

heard = []


def chatter_callback(msg):
    heard.append(msg.data)
    print("heard", msg.data)


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node("listener")
    subscription = node.create_subscription(String, "chatter", chatter_callback, 10)
    subscription  # prevent unused variable warning
    while rclpy.ok() and len(heard) < 5:
        rclpy.spin_once(node, timeout_sec=1.0)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
