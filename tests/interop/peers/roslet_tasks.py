"""The same as rclpy_tasks.py on roslet's own API."""

import contextlib
import sys
import time

import roslet

types = roslet.load(sys.argv[2])
FIBONACCI = "test_msgs/action/Fibonacci"


def serve() -> None:
    with roslet.Node("server") as node:
        node.declare_parameter("speed", 1.0, range=(0.0, 2.0), text="metres a second")
        node.declare_parameter("names", ["a", "b"])

        def execute(goal):
            sequence = [0, 1]
            for _ in range(1, goal.request.order):
                if goal.cancel_requested:
                    goal.canceled(sequence=sequence)
                    return None
                if goal.request.order == 13:
                    goal.abort(sequence=sequence)
                    return None
                sequence.append(min(sequence[-1] + sequence[-2], 1 << 30))
                goal.feedback(sequence=sequence)
                time.sleep(0.01)
            return {"sequence": sequence}

        node.action_server("fibonacci", FIBONACCI, execute, on_goal=lambda request: request.order > 0)
        print("serving", flush=True)
        with contextlib.suppress(KeyboardInterrupt):
            node.spin()


def ask() -> None:
    with roslet.Node("asker") as node:
        client = node.action_client("fibonacci", FIBONACCI)
        print("server", client.wait(20), flush=True)
        feedback = []
        goal = client.send_goal(
            order=5, feedback=lambda told: feedback.append(told.sequence.tolist()), timeout=10
        )
        status, result = goal.result(10)
        node.sleep(0.3)
        print(status, result.sequence.tolist(), feedback[-1])
        try:
            client.send_goal(order=-1, timeout=10)
            print("accepted", True)
        except roslet.RosletError:
            print("accepted", False)
        status, result = client.send_goal(order=13, timeout=10).result(10)
        print(status, result.sequence.tolist())
        goal = client.send_goal(order=5000, timeout=10)
        node.sleep(0.1)
        print("canceling", int(goal.cancel(10)))
        status, result = goal.result(10)
        print(status, 2 <= len(result.sequence) < 5000)
        goals = [client.send_goal(order=order, timeout=10) for order in range(1, 6)]
        print([len(goal.result(10)[1].sequence) for goal in goals])

        def call(service, kind, **fields):
            with node.client("/server/" + service, "rcl_interfaces/srv/" + kind) as one:
                return one.call(timeout=10, **fields)

        def value(kind, **fields):
            return roslet.gen.runtime.message_class("ros2", "rcl_interfaces/msg/ParameterValue")(
                type=kind, **fields
            )

        def parameter(found):
            return roslet.gen.runtime.message_class("ros2", "rcl_interfaces/msg/Parameter")(
                name="speed", value=found
            )

        print("parameters", True)
        found = call("get_parameters", "GetParameters", names=["speed", "names"]).values
        print(found[0].double_value, list(found[1].string_array_value))
        wanted = [value(3, double_value=1.5), value(3, double_value=9.0), value(4, string_value="x")]
        results = call(
            "set_parameters", "SetParameters", parameters=[parameter(one) for one in wanted]
        ).results
        now = call("get_parameters", "GetParameters", names=["speed"]).values[0].double_value
        print([one.successful for one in results], now)
        (described,) = call("describe_parameters", "DescribeParameters", names=["speed"]).descriptors
        print(described.type, described.description, described.floating_point_range[0].to_value)
        names = call("list_parameters", "ListParameters", depth=10).result.names
        print([name for name in names if name in ("speed", "names")])


{"serve": serve, "ask": ask}[sys.argv[1]]()
