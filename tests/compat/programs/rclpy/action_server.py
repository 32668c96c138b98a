#!/usr/bin/env python3
# A minimal action server with a coroutine for each goal; ends after two.
import rclpy
from rclpy.action import ActionServer
from rclpy.node import Node
from test_msgs.action import Fibonacci


class MinimalActionServer(Node):
    def __init__(self):
        super().__init__("minimal_action_server")
        self.left = 2
        self._action_server = ActionServer(self, Fibonacci, "fibonacci", self.execute_callback)

    async def execute_callback(self, goal_handle):
        print("executing %d" % goal_handle.request.order)
        feedback_msg = Fibonacci.Feedback()
        feedback_msg.sequence = [0, 1]
        for i in range(1, goal_handle.request.order):
            feedback_msg.sequence.append(feedback_msg.sequence[i] + feedback_msg.sequence[i - 1])
            goal_handle.publish_feedback(feedback_msg)
        goal_handle.succeed()
        result = Fibonacci.Result()
        result.sequence = feedback_msg.sequence
        self.left -= 1
        return result


rclpy.init()
node = MinimalActionServer()
while node.left:
    rclpy.spin_once(node)
for _ in range(20):
    rclpy.spin_once(node, timeout_sec=0.05)
node.destroy_node()
rclpy.shutdown()
