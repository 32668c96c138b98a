#!/usr/bin/env python3
# A node whose parameters another one asks for and sets.
import rclpy
from rcl_interfaces.msg import IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node


class Owner(Node):
    def __init__(self):
        super().__init__("owner", namespace="/space")
        self.declare_parameter("text", "hello")
        limits = [IntegerRange(from_value=0, to_value=10, step=1)]
        self.declare_parameter("number", 3, ParameterDescriptor(description="a number", integer_range=limits))
        self.declare_parameter("list", [1.5, 2.5])
        self.declare_parameter("octets", [b"\x01", b"\xff"])
        self.declare_parameter("over", False)
        self.add_on_set_parameters_callback(self.check)

    def check(self, parameters):
        print("set", [(parameter.name, parameter.value) for parameter in parameters])
        good = all(parameter.value != "bad" for parameter in parameters)
        return SetParametersResult(successful=good, reason="" if good else "not that word")


rclpy.init()
node = Owner()
while not node.get_parameter("over").value:
    rclpy.spin_once(node)
for _ in range(10):
    rclpy.spin_once(node, timeout_sec=0.05)
print(node.get_parameter("number").value, node.get_parameter("text").value)
rclpy.shutdown()
