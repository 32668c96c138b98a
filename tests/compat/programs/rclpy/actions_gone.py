#!/usr/bin/env python3
# Action servers, and their nodes, that are destroyed while they execute a goal.
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import SingleThreadedExecutor
from test_msgs.action import Fibonacci


def execute(handle):
    destroy()
    print("gone", handle.is_active, handle.status, handle.is_cancel_requested)
    handle.publish_feedback(Fibonacci.Feedback())
    for end in (handle.succeed, handle.abort):
        try:
            end()
            print("ended", handle.is_active, handle.status)
        except RuntimeError as error:
            print("raised", type(error).__name__)
    return Fibonacci.Result()


rclpy.init()
for what in ("server", "node"):
    print(what)
    node = rclpy.create_node("server")
    other = rclpy.create_node("client")
    server = ActionServer(node, Fibonacci, what, execute)
    client = ActionClient(other, Fibonacci, what)
    destroy = server.destroy if what == "server" else node.destroy_node
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(other)
    client.wait_for_server()
    executor.spin_until_future_complete(client.send_goal_async(Fibonacci.Goal(order=1)), timeout_sec=10)
    for _ in range(10):
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    client.destroy()
    other.destroy_node()
    node.destroy_node()
rclpy.shutdown()
