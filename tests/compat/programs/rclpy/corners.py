#!/usr/bin/env python3
# What is asked for seldom: calls without an answer, goals that are rejected, values that are not set, callbacks that refuse.
import threading

import rclpy
from rclpy.action import ActionClient, ActionServer, GoalResponse
from rclpy.parameter import Parameter
from rclpy.qos_overriding_options import QosCallbackResult, QoSOverridingOptions
from std_msgs.msg import String
from std_srvs.srv import Trigger
from test_msgs.action import Fibonacci


def show(name, function):
    try:
        print(name, function())
    except Exception as error:
        print(name, "raised", type(error).__name__)


rclpy.init()
node = rclpy.create_node("corners")
thread = threading.Thread(target=rclpy.spin, args=(node,))
thread.start()

absent = node.create_client(Trigger, "absent")
show("no server", lambda: absent.call(Trigger.Request(), timeout_sec=0.1))
node.create_service(Trigger, "present", lambda request, response: response)
present = node.create_client(Trigger, "present")
present.wait_for_service()
show("a server", lambda: present.call(Trigger.Request(), timeout_sec=10.0))

server = ActionServer(
    node,
    Fibonacci,
    "fibonacci",
    lambda handle: Fibonacci.Result(),
    goal_callback=lambda request: GoalResponse.REJECT,
)
client = ActionClient(node, Fibonacci, "fibonacci")
client.wait_for_server()
show("rejected", lambda: client.send_goal(Fibonacci.Goal(order=1)).status)

node.declare_parameter("group.unset", Parameter.Type.STRING)
node.declare_parameter("group.set", 1)
show(
    "by prefix",
    lambda: [(name, one.type_.name) for name, one in node.get_parameters_by_prefix("group").items()],
)
show("or", lambda: node.get_parameter_or("group.unset").value)
show("negative", lambda: node.create_timer(-1.0, print))
options = QoSOverridingOptions.with_default_policies(
    callback=lambda profile: QosCallbackResult(successful=profile.depth < 5, reason="deep")
)
show(
    "shallow", lambda: node.create_publisher(String, "shallow", 4, qos_overriding_options=options).topic_name
)
show("deep", lambda: node.create_publisher(String, "deep", 5, qos_overriding_options=options))
client.destroy()
server.destroy()
rclpy.shutdown()
thread.join()
