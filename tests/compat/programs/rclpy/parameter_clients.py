#!/usr/bin/env python3
# Parameters of another node: services, clients, events, files.
import os
import tempfile

import rclpy
from rcl_interfaces.msg import ParameterEvent, ParameterType, SetParametersResult
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler
from rclpy.qos import qos_profile_parameter_events

rclpy.init()
owner = rclpy.create_node("owner")
asker = rclpy.create_node("asker")
owner.declare_parameter("number", 1)
owner.declare_parameter("deep.text", "one")
owner.declare_parameter("flag", False)
executor = SingleThreadedExecutor()
executor.add_node(owner)
executor.add_node(asker)


def wait(future):
    executor.spin_until_future_complete(future, timeout_sec=10)
    return future.result()


def settle(done):
    for _ in range(100):
        if done():
            return
        executor.spin_once(timeout_sec=0.05)


client = AsyncParameterClient(asker, "owner")
print("there", client.wait_for_services(timeout_sec=10.0), client.services_are_ready())
print("absent", AsyncParameterClient(asker, "nobody").wait_for_services(timeout_sec=0.2))
answer = wait(client.list_parameters())
print(
    sorted(name for name in answer.result.names if "." not in name or name.startswith("deep")),
    sorted(answer.result.prefixes)[:1],
)
print(sorted(wait(client.list_parameters(["deep"], 10)).result.names))
values = wait(client.get_parameters(["number", "deep.text", "absent"])).values
print(len(values))
values = wait(client.get_parameters(["number", "deep.text"])).values
print([(value.type, value.integer_value, value.string_value) for value in values])
print(list(wait(client.get_parameter_types(["flag", "number"])).types))
print([(d.name, d.type) for d in wait(client.describe_parameters(["number"])).descriptors])

events = []
asker.create_subscription(ParameterEvent, "/parameter_events", events.append, qos_profile_parameter_events)
handler = ParameterEventHandler(asker)
seen = []
handler.add_parameter_callback(
    "number", "owner", lambda parameter: seen.append(("one", parameter.value.integer_value))
)
handle = handler.add_parameter_event_callback(lambda event: seen.append(("all", event.node)))
settle(
    lambda: (
        asker.count_publishers("/parameter_events") >= 2 and owner.count_subscribers("/parameter_events") >= 2
    )
)

results = wait(
    client.set_parameters([Parameter("number", value=5), Parameter("flag", value="wrong")])
).results
print([(result.successful, bool(result.reason)) for result in results], owner.get_parameter("number").value)
settle(lambda: any(event.node == "/owner" for event in events) and len(seen) >= 2)
event = next(event for event in events if event.node == "/owner")
print(
    [p.name for p in event.changed_parameters],
    [p.name for p in event.new_parameters],
    event.stamp.sec > 10**9,
)
print(sorted(seen))
handler.remove_parameter_event_callback(handle)
result = wait(
    client.set_parameters_atomically([Parameter("number", value=6), Parameter("flag", value=True)])
).result
print(result.successful, owner.get_parameter("number").value, owner.get_parameter("flag").value)
print([result.successful for result in wait(client.set_parameters([Parameter("absent", value=1)])).results])
owner.add_on_set_parameters_callback(lambda parameters: SetParametersResult(successful=False, reason="never"))
print(
    [
        (result.successful, result.reason)
        for result in wait(client.set_parameters([Parameter("number", value=7)])).results
    ]
)

with tempfile.NamedTemporaryFile("w", suffix=".yaml", delete=False) as file:
    file.write(
        "owner:\n  ros__parameters:\n    number: 9\n    deep:\n      text: two\n/**:\n  ros__parameters:\n    flag: true\n"
    )
found = parameter_dict_from_yaml_file(file.name, use_wildcard=True, target_nodes=["/owner"])
print({name: (message.value.type, message.name) for name, message in sorted(found.items())})
print(len(wait(client.load_parameter_file(file.name, use_wildcard=True)).results))
os.unlink(file.name)

raw = asker.create_client(GetParameters, "/owner/get_parameters")
raw.wait_for_service()
answer = wait(raw.call_async(GetParameters.Request(names=["flag"])))
print(answer.values[0].type == ParameterType.PARAMETER_BOOL, answer.values[0].bool_value)
names = sorted(name for name, _ in owner.get_service_names_and_types_by_node("owner", "/"))
print(names)
silent = rclpy.create_node("silent", start_parameter_services=False, enable_rosout=False)
print(silent.get_service_names_and_types_by_node("silent", "/"))
executor.shutdown()
rclpy.shutdown()
