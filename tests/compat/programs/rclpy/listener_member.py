#!/usr/bin/env python3
# A node class that ends its own spin.
import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.subscription = self.create_subscription(String, "chatter", self.listener_callback, 10)
        self.count = 0

    def listener_callback(self, msg):
        print("heard", msg.data)
        self.count += 1
        if self.count == 5:
            rclpy.shutdown()


def main(args=None):
    rclpy.init(args=args)
    listener = Listener()
    rclpy.spin(listener)  # returns, since the end comes from within
    print("ok", rclpy.ok())
    listener.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
