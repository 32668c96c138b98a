"""An rclpy node that looks at the board's: its parameters, its log. Prints one line for each thing that it found."""

import sys
import time

import rclpy
from rcl_interfaces.msg import Log
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient


def main():
    rclpy.init()
    node = rclpy.create_node("looker")
    heard = []
    node.create_subscription(Log, "/rosout", heard.append, 10)
    client = AsyncParameterClient(node, "board")

    def answer(future):
        rclpy.spin_until_future_complete(node, future, timeout_sec=10.0)
        return future.result()

    if not client.wait_for_services(20.0):
        sys.exit("no services of parameters")
    print("names", sorted(answer(client.list_parameters([], 0)).result.names), flush=True)
    print("speed", answer(client.get_parameters(["speed"])).values[0].double_value, flush=True)
    described = answer(client.describe_parameters(["speed"])).descriptors[0]
    print("range", described.floating_point_range[0].to_value, flush=True)
    print(
        "refused",
        answer(client.set_parameters([Parameter("speed", value=11.0)])).results[0].successful,
        flush=True,
    )
    print(
        "taken",
        answer(client.set_parameters([Parameter("speed", value=2.5)])).results[0].successful,
        flush=True,
    )
    end = time.monotonic() + 10
    while time.monotonic() < end and not [one for one in heard if one.name == "board"]:
        rclpy.spin_once(node, timeout_sec=0.1)
    print("log", [(one.level, one.msg) for one in heard if one.name == "board"][:1], flush=True)


main()
