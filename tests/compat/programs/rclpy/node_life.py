#!/usr/bin/env python3
# A node from its beginning to its end.
import gc
import weakref

import rclpy
from rclpy.exceptions import InvalidHandle
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String
from std_srvs.srv import Trigger


def show(name, function):
    try:
        print(name, function())
    except Exception as error:
        print(name, "raised", type(error).__name__)


class Mine(Node):
    def __init__(self, name="mine", **kwargs):
        super().__init__(name, **kwargs)
        self.timer = self.create_timer(0.01, self.tick)
        self.ticks = 0

    def tick(self):
        self.ticks += 1

    def destroy_node(self):
        print("destroying")
        return super().destroy_node()


rclpy.init()
node = Mine()
publisher = node.create_publisher(String, "topic", 1)
subscription = node.create_subscription(String, "topic", print, 1)
service = node.create_service(Trigger, "service", print)
client = node.create_client(Trigger, "service")
guard = node.create_guard_condition(print)
print([type(entity).__name__ for entity in (publisher, subscription, service, client, guard, node.timer)])
print(
    len(list(node.publishers)),
    len(list(node.subscriptions)),
    len(list(node.clients)),
    len(list(node.timers)),
    len(list(node.guards)),
)
print(
    node.get_clock().clock_type.name,
    node.get_clock().now() > node.get_clock().now() or True,
    node.context.ok(),
)
print(publisher.logger_name, subscription.logger_name, service.logger_name, client.logger_name)
for _ in range(50):
    rclpy.spin_once(node, timeout_sec=0.1)
    if node.ticks > 2:
        break
print(node.ticks > 2, node.executor is None)
print(
    node.destroy_timer(node.timer),
    node.destroy_service(service),
    node.destroy_client(client),
    node.destroy_guard_condition(guard),
)
print(node.destroy_timer(node.timer), len(list(node.timers)))
node.declare_parameter("number", 1)
fired = []
guard = node.create_guard_condition(lambda: fired.append(1))
guard.trigger()
node.destroy_guard_condition(guard)
rclpy.spin_once(node, timeout_sec=0.1)
print("destroyed before its call", fired)
node.destroy_node()
node.destroy_node()
show("ask for a parameter", lambda: node.get_parameter("number").value)
show("or for another", lambda: node.get_parameter_or("other").value)
show("list", lambda: "number" in node.list_parameters([], 0).names)
show("declare", lambda: node.declare_parameter("other", 1))
show("set", lambda: node.set_parameters([Parameter("number", value=2)]))
show("publish", lambda: publisher.publish(String()))
show("name", lambda: node.get_name())
show("create", lambda: node.create_publisher(String, "topic", 1))
show("spin_once", lambda: rclpy.spin_once(node, timeout_sec=0.1))

with rclpy.create_node("within") as within:
    print(within.get_name())
show("after with", lambda: within.get_name())

# Two of one name are allowed.
first, second = Mine("same"), Mine("same")
print(first.get_name() == second.get_name())
third = Mine("options", namespace="/ns", parameter_overrides=[Parameter("p", value=1)])
print(third.get_fully_qualified_name(), third.declare_parameter("p", 0).value)
gone = weakref.ref(first)
first.destroy_node()
del first
gc.collect()
print("collected", gone() is None)
rclpy.shutdown()
print("over", rclpy.ok())
show("name", lambda: second.get_name())
