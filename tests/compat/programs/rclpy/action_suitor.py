#!/usr/bin/env python3
# An action client whose goals are rejected, cancelled, not cancelled, aborted, one after the other.
import rclpy
from action_msgs.msg import GoalStatus
from action_msgs.srv import CancelGoal
from rclpy.action import ActionClient
from test_msgs.action import Fibonacci

rclpy.init()
node = rclpy.create_node("suitor")
client = ActionClient(node, Fibonacci, "judged")
client.wait_for_server()
CODES = {
    getattr(CancelGoal.Response, name): name for name in dir(CancelGoal.Response) if name.startswith("ERROR_")
}
STATES = {getattr(GoalStatus, name): name for name in dir(GoalStatus) if name.startswith("STATUS_")}


def wait(future):
    rclpy.spin_until_future_complete(node, future, timeout_sec=10)
    return future.result()


for order, cancel in ((-1, False), (10, True), (1, True), (20, False)):
    handle = wait(client.send_goal_async(Fibonacci.Goal(order=order)))
    print(order, "accepted", handle.accepted)
    if not handle.accepted:
        print(order, STATES[handle.status])
        continue
    if cancel:
        answer = wait(handle.cancel_goal_async())
        same = [bytes(one.goal_id.uuid) == bytes(handle.goal_id.uuid) for one in answer.goals_canceling]
        print(order, "cancel", CODES[answer.return_code], same)
    answer = wait(handle.get_result_async())
    print(order, STATES[answer.status], list(answer.result.sequence))
    answer = wait(handle.cancel_goal_async())
    print(order, "cancel when ended", CODES[answer.return_code], len(answer.goals_canceling))
rclpy.shutdown()
