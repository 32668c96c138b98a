#!/usr/bin/env python3
# Action servers and clients: goals, feedback, results; rejected, cancelled, aborted, concurrent ones.
import threading
import time

import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import (
    ActionClient,
    ActionServer,
    CancelResponse,
    GoalResponse,
    get_action_client_names_and_types_by_node,
    get_action_names_and_types,
    get_action_server_names_and_types_by_node,
)
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from test_msgs.action import Fibonacci

NAMES = {getattr(GoalStatus, name): name[7:] for name in dir(GoalStatus) if name.startswith("STATUS_")}


class FibonacciServer(Node):
    def __init__(self):
        super().__init__("fibonacci_server")
        self.cancelling = threading.Event()
        self._action_server = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            execute_callback=self.execute,
            callback_group=ReentrantCallbackGroup(),
            goal_callback=self.goal,
            handle_accepted_callback=self.accepted,
            cancel_callback=self.cancel,
        )

    def goal(self, request):
        return GoalResponse.REJECT if request.order < 0 else GoalResponse.ACCEPT

    def accepted(self, goal_handle):
        goal_handle.execute()

    def cancel(self, goal_handle):
        return CancelResponse.ACCEPT if goal_handle.request.order >= 1000 else CancelResponse.REJECT

    def execute(self, goal_handle):
        order = goal_handle.request.order
        if order == 13:
            raise ValueError("unlucky")
        feedback = Fibonacci.Feedback()
        feedback.sequence = [0, 1]
        if order >= 1000:
            while not goal_handle.is_cancel_requested:
                time.sleep(0.01)
            goal_handle.canceled()
            return Fibonacci.Result(sequence=[order])
        for i in range(1, order):
            feedback.sequence.append(feedback.sequence[i] + feedback.sequence[i - 1])
            goal_handle.publish_feedback(feedback)
            time.sleep(0.005)
        if order == 7:
            goal_handle.abort()
        elif order != 8:
            goal_handle.succeed()
        result = Fibonacci.Result()
        result.sequence = feedback.sequence
        return result


class FibonacciClient(Node):
    def __init__(self):
        super().__init__("fibonacci_client")
        self._action_client = ActionClient(self, Fibonacci, "fibonacci")

    def run(self, order, cancel=False):
        feedback = []

        async def note(message):
            feedback.append(message)

        future = self._action_client.send_goal_async(
            Fibonacci.Goal(order=order), feedback_callback=note if order % 2 else feedback.append
        )
        handle = wait(future)
        if not handle.accepted:
            print(order, "rejected", NAMES[handle.status])
            return
        result_future = handle.get_result_async()
        if cancel:
            answer = wait(handle.cancel_goal_async())
            print(order, "cancel", answer.return_code, len(answer.goals_canceling))
        answer = wait(result_future)
        print(order, NAMES[answer.status], list(answer.result.sequence), NAMES[handle.status])
        lengths = [len(message.feedback.sequence) for message in feedback]
        print(order, lengths, all(message.goal_id == handle.goal_id for message in feedback))


def wait(future):
    deadline = time.monotonic() + 20
    while not future.done():
        if time.monotonic() > deadline:
            raise SystemExit("no answer")
        time.sleep(0.005)
    return future.result()


rclpy.init()
server = FibonacciServer()
client = FibonacciClient()
executor = MultiThreadedExecutor(num_threads=6)
executor.add_node(server)
executor.add_node(client)
thread = threading.Thread(target=executor.spin, daemon=True)
thread.start()
print(
    "there", client._action_client.wait_for_server(timeout_sec=10.0), client._action_client.server_is_ready()
)
print("absent", ActionClient(client, Fibonacci, "nowhere").wait_for_server(timeout_sec=0.2))
time.sleep(0.5)  # until the server knows the subscription of feedback too
client.run(5)
client.run(-1)
client.run(1000, cancel=True)
client.run(6, cancel=True)
client.run(7)
client.run(8)
client.run(13)

# Several at once.
handles = [
    wait(client._action_client.send_goal_async(Fibonacci.Goal(order=order))) for order in (2, 3, 4, 1001)
]
futures = [handle.get_result_async() for handle in handles]
print([list(wait(future).result.sequence) for future in futures[:3]])
print("still under way", futures[3].done(), handles[3].goal_id.uuid.dtype, len(handles[3].goal_id.uuid))
wait(handles[3].cancel_goal_async())
print(NAMES[wait(futures[3]).status])
print("result again", list(wait(handles[0].get_result_async()).result.sequence))
print("cancel when done", wait(handles[0].cancel_goal_async()).return_code)

print(get_action_names_and_types(client))
print(get_action_server_names_and_types_by_node(client, "fibonacci_server", "/"))
print(get_action_client_names_and_types_by_node(server, "fibonacci_client", "/"))
topics = dict(client.get_topic_names_and_types(no_demangle=False))
print({name: types for name, types in topics.items() if "fibonacci/" in name})
services = dict(server.get_service_names_and_types_by_node("fibonacci_server", "/"))
print({name: types for name, types in services.items() if "fibonacci/" in name})
executor.shutdown()
thread.join(5)
client._action_client.destroy()
server._action_server.destroy()
rclpy.shutdown()
