#!/usr/bin/env python3
# The node that asks for and sets the parameters of another one, and looks it up in the graph.
import time

import rclpy
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler

rclpy.init()
node = rclpy.create_node("asker")
client = AsyncParameterClient(node, "/space/owner")
print("there", client.wait_for_services(timeout_sec=20.0))
changes = []  # the declaration too, where this node is fast
handler = ParameterEventHandler(node)
handler.add_parameter_callback("text", "/space/owner", lambda told: changes.append(told.value.string_value))


def settle(done):
    end = time.monotonic() + 10
    while not done() and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.05)
    return bool(done())


def answer(future):
    rclpy.spin_until_future_complete(node, future, timeout_sec=10.0)
    return future.result()


print("known", settle(lambda: "/space/owner" in node.get_fully_qualified_node_names()))
settle(lambda: node.count_publishers("/parameter_events") == 2)
names = ["text", "number", "list", "octets"]
for name, value in zip(names, answer(client.get_parameters(names)).values, strict=True):
    print(name, value.type, list(value.double_array_value), list(value.byte_array_value), value.string_value)
print(sorted(answer(client.list_parameters()).result.names))
described = answer(client.describe_parameters(["number"])).descriptors[0]
print(described.description, described.type, described.integer_range[0].to_value)
wanted = [Parameter("number", value=7), Parameter("number", value=11), Parameter("text", value="bad")]
print([result.successful for result in answer(client.set_parameters(wanted)).results])
print(answer(client.set_parameters_atomically([Parameter("text", value="bye")])).result.successful)
print("told", settle(lambda: changes[-1:] == ["bye"]))
print(parameter_value_to_python(answer(client.get_parameters(["number"])).values[0]))
print([name for name, _ in node.get_service_names_and_types_by_node("owner", "/space")])
print([name for name, _ in node.get_publisher_names_and_types_by_node("owner", "/space")])
print(sorted(info.node_name for info in node.get_publishers_info_by_topic("/rosout")))
answer(client.set_parameters([Parameter("over", value=True)]))
print("gone", settle(lambda: "/space/owner" not in node.get_fully_qualified_node_names()))
rclpy.shutdown()
