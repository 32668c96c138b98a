#!/usr/bin/env python3
# What a program is told by its arguments: names, topics, parameters, levels.
import sys

import rclpy
from rclpy.node import Node
from rclpy.utilities import remove_ros_args
from std_msgs.msg import String
from std_srvs.srv import Trigger

print(remove_ros_args(sys.argv)[1:])
rclpy.init(args=sys.argv)
node = Node(
    "arguments", allow_undeclared_parameters=True, automatically_declare_parameters_from_overrides=True
)
print(node.get_name(), node.get_namespace())
print(node.get_logger().get_effective_level().name)
print(
    node.create_publisher(String, "chatter", 1).topic_name,
    node.create_publisher(String, "~/private", 1).topic_name,
)
print(
    node.create_service(Trigger, "service", print).service_name,
    node.create_client(Trigger, "/absolute").service_name,
)
print(node.resolve_topic_name("chatter"), node.resolve_topic_name("chatter", only_expand=True))
for name in sorted(node.list_parameters([], 0).names):
    parameter = node.get_parameter(name)
    print(
        " ",
        name,
        parameter.type_,
        parameter.value if not hasattr(parameter.value, "tolist") else parameter.value.tolist(),
    )
strict = Node(
    "strict", use_global_arguments=False, cli_args=["--ros-args", "-r", "__ns:=/mine", "-p", "own:=1"]
)
print(
    strict.get_fully_qualified_name(),
    strict.declare_parameter("own", 5).value,
    strict.declare_parameter("number", 0).value,
)
second = Node("second")
print(
    second.get_fully_qualified_name(),
    second.declare_parameter("number", 0).value,
    second.has_parameter("text"),
)
rclpy.shutdown()
