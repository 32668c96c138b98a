#!/usr/bin/env python3
# A node class that publishes on a timer.
import rclpy
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher_ = self.create_publisher(String, "chatter", 10)
        self.timer = self.create_timer(0.02, self.timer_callback)
        self.i = 0

    def timer_callback(self):
        if self.i == 5:
            self.publisher_.wait_for_all_acked(Duration(seconds=5))
            raise SystemExit
        if self.publisher_.get_subscription_count() == 0:
            return
        self.publisher_.publish(String(data=f"news {self.i}"))
        print("said", self.i)
        self.i += 1


def main(args=None):
    try:
        with rclpy.init(args=args):
            rclpy.spin(Talker())
    except (KeyboardInterrupt, ExternalShutdownException):
        print("interrupted")
    except SystemExit:
        print("said it all")


if __name__ == "__main__":
    main()
