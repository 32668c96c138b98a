#!/usr/bin/env python3
# A goal that ends and is forgotten while a cancel request waits for the one before it, and goals that nobody executes.
import gc

import rclpy
from action_msgs.srv import CancelGoal
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.task import Future
from test_msgs.action import Fibonacci


def execute(handle):
    print("executes", handle.request.order)
    return Fibonacci.Result()


async def cancel(handle):
    print("cancel", handle.request.order)
    if handle.request.order == 0:
        handles[1].execute()
        handles[1].abort()
        later = Future()
        timer = node.create_timer(1.0, lambda: later.done() or later.set_result(None), group)
        await later
        node.destroy_timer(timer)
    return CancelResponse.ACCEPT


rclpy.init()
node = rclpy.create_node("late")
group = ReentrantCallbackGroup()
handles = []
server = ActionServer(
    node,
    Fibonacci,
    "late",
    execute,
    callback_group=group,
    handle_accepted_callback=handles.append,
    cancel_callback=cancel,
    result_timeout=0.1,
)
client = ActionClient(node, Fibonacci, "late", callback_group=group)
executor = SingleThreadedExecutor()
executor.add_node(node)
client.wait_for_server()
for order in range(2):
    executor.spin_until_future_complete(client.send_goal_async(Fibonacci.Goal(order=order)), timeout_sec=10)
    while len(handles) == order:
        executor.spin_once(timeout_sec=0.1)
everything = node.create_client(CancelGoal, "late/_action/cancel_goal", callback_group=group)
everything.wait_for_service()
answer = everything.call_async(CancelGoal.Request())
executor.spin_until_future_complete(answer, timeout_sec=10)
print(answer.result().return_code, len(answer.result().goals_canceling), [one.status for one in handles[:1]])

# The executor is gone before the goal is executed: it stays as it is, also for the next executor.
executor.remove_node(node)
executor.shutdown()
del executor
gc.collect()
print(node.executor)
client.destroy()
server.destroy()
feedback = QoSProfile(depth=3, reliability=ReliabilityPolicy.BEST_EFFORT)
server = ActionServer(
    node,
    Fibonacci,
    "nobody",
    execute,
    handle_accepted_callback=handles.append,
    feedback_pub_qos_profile=feedback,
    status_pub_qos_profile=QoSProfile(depth=1),
)
client = ActionClient(
    node,
    Fibonacci,
    "nobody",
    feedback_sub_qos_profile=feedback,
    status_sub_qos_profile=QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
)
for name in ("feedback", "status"):
    for one in (
        *node.get_publishers_info_by_topic("nobody/_action/" + name),
        *node.get_subscriptions_info_by_topic("nobody/_action/" + name),
    ):
        print(name, one.qos_profile.reliability.name, one.qos_profile.durability.name)
executor = SingleThreadedExecutor()
executor.add_node(node)
client.wait_for_server()
executor.spin_until_future_complete(client.send_goal_async(Fibonacci.Goal(order=3)), timeout_sec=10)
while len(handles) == 2:
    executor.spin_once(timeout_sec=0.1)
executor.remove_node(node)
executor.shutdown()
del executor
gc.collect()
handles[2].execute()
print(node.executor, handles[2].status)
for _ in range(5):
    rclpy.spin_once(node, timeout_sec=0.05)
print(handles[2].status, handles[2].is_active)
rclpy.shutdown()
