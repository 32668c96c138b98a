#!/usr/bin/env python3
# A minimal action client: callbacks for the answer, the feedback and the result.
import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.node import Node
from test_msgs.action import Fibonacci


class MinimalActionClient(Node):
    def __init__(self):
        super().__init__("minimal_action_client")
        self._action_client = ActionClient(self, Fibonacci, "fibonacci")
        self.lengths = []

    def goal_response_callback(self, future):
        goal_handle = future.result()
        print("accepted", goal_handle.accepted)
        self._get_result_future = goal_handle.get_result_async()
        self._get_result_future.add_done_callback(self.get_result_callback)

    def feedback_callback(self, feedback):
        self.lengths.append(len(feedback.feedback.sequence))

    def get_result_callback(self, future):
        result = future.result().result
        if future.result().status == GoalStatus.STATUS_SUCCEEDED:
            print("result", list(result.sequence))
        # Feedback is a topic: what is published before the server knows the client's subscription is lost.
        print("feedback", set(self.lengths) <= {3, 4, 5})
        rclpy.shutdown()

    def send_goal(self):
        self._action_client.wait_for_server()
        self._send_goal_future = self._action_client.send_goal_async(
            Fibonacci.Goal(order=4), feedback_callback=self.feedback_callback
        )
        self._send_goal_future.add_done_callback(self.goal_response_callback)


rclpy.init()
node = MinimalActionClient()
node.send_goal()
rclpy.spin(node)

# And once more in one coroutine.
rclpy.init()
node = rclpy.create_node("coroutine_client")
client = ActionClient(node, Fibonacci, "fibonacci")
client.wait_for_server()


async def ask():
    handle = await client.send_goal_async(Fibonacci.Goal(order=3))
    return await handle.get_result_async()


executor = rclpy.get_global_executor()
task = executor.create_task(ask)
rclpy.spin_until_future_complete(node, task)
print(list(task.result().result.sequence), task.result().status)
rclpy.shutdown()
