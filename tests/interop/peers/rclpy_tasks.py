"""Actions and parameters under rclpy: `serve` has them, `ask` uses those of the node /server and prints what comes of it."""

import contextlib
import sys
import time

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from test_msgs.action import Fibonacci

STATUS = {4: "SUCCEEDED", 5: "CANCELED", 6: "ABORTED"}


def serve() -> None:
    node = rclpy.create_node("server")
    speed = ParameterDescriptor(
        description="metres a second", floating_point_range=[FloatingPointRange(from_value=0.0, to_value=2.0)]
    )
    node.declare_parameter("speed", 1.0, speed)
    node.declare_parameter("names", ["a", "b"])

    def execute(goal):
        sequence = [0, 1]
        for _ in range(1, goal.request.order):
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result(sequence=sequence)
            if goal.request.order == 13:
                goal.abort()
                return Fibonacci.Result(sequence=sequence)
            sequence.append(min(sequence[-1] + sequence[-2], 1 << 30))
            goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
            time.sleep(0.01)
        goal.succeed()
        return Fibonacci.Result(sequence=sequence)

    ActionServer(
        node,
        Fibonacci,
        "fibonacci",
        execute,
        goal_callback=lambda goal: GoalResponse.ACCEPT if goal.order > 0 else GoalResponse.REJECT,
        cancel_callback=lambda goal: CancelResponse.ACCEPT,
        callback_group=ReentrantCallbackGroup(),
    )
    executor = MultiThreadedExecutor(4)
    executor.add_node(node)
    print("serving", flush=True)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


def ask() -> None:
    node = rclpy.create_node("asker")

    def wait(future):
        rclpy.spin_until_future_complete(node, future, timeout_sec=10)
        return future.result()

    def settle(seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            rclpy.spin_once(node, timeout_sec=0.02)

    client = ActionClient(node, Fibonacci, "fibonacci")
    print("server", client.wait_for_server(20), flush=True)
    feedback = []
    goal = wait(
        client.send_goal_async(
            Fibonacci.Goal(order=5), lambda told: feedback.append(list(told.feedback.sequence))
        )
    )
    result = wait(goal.get_result_async())
    settle(0.3)
    print(STATUS[result.status], list(result.result.sequence), feedback[-1])
    print("accepted", wait(client.send_goal_async(Fibonacci.Goal(order=-1))).accepted)
    result = wait(wait(client.send_goal_async(Fibonacci.Goal(order=13))).get_result_async())
    print(STATUS[result.status], list(result.result.sequence))
    goal = wait(client.send_goal_async(Fibonacci.Goal(order=5000)))
    settle(0.1)
    print("canceling", len(wait(goal.cancel_goal_async()).goals_canceling))
    result = wait(goal.get_result_async())
    print(STATUS[result.status], 2 <= len(result.result.sequence) < 5000)
    goals = [wait(client.send_goal_async(Fibonacci.Goal(order=order))) for order in range(1, 6)]
    print([len(wait(goal.get_result_async()).result.sequence) for goal in goals])

    parameters = AsyncParameterClient(node, "server")
    print("parameters", parameters.wait_for_services(10))
    found = wait(parameters.get_parameters(["speed", "names"])).values
    print(found[0].double_value, list(found[1].string_array_value))
    results = wait(
        parameters.set_parameters(
            [Parameter("speed", value=1.5), Parameter("speed", value=9.0), Parameter("speed", value="x")]
        )
    ).results
    print(
        [one.successful for one in results], wait(parameters.get_parameters(["speed"])).values[0].double_value
    )
    (described,) = wait(parameters.describe_parameters(["speed"])).descriptors
    print(described.type, described.description, described.floating_point_range[0].to_value)
    print(
        [name for name in wait(parameters.list_parameters([], 10)).result.names if name in ("speed", "names")]
    )


rclpy.init()
{"serve": serve, "ask": ask}[sys.argv[1]]()
