#!/usr/bin/env python3
# A service callback that raises ends the spin of its node with that exception; one that returns no response as well.
import rclpy
from std_srvs.srv import Trigger

rclpy.init()
node = rclpy.create_node("failing")


def raising(request, response):
    raise RuntimeError("out of order")


node.create_service(Trigger, "raising", raising)
client = node.create_client(Trigger, "raising")
client.wait_for_service()
future = client.call_async(Trigger.Request())
try:
    rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
except RuntimeError as error:
    print("raised", error)
print(future.done(), rclpy.ok())


node.create_service(Trigger, "nothing", lambda request, response: None)
client = node.create_client(Trigger, "nothing")
client.wait_for_service()
future = client.call_async(Trigger.Request())
try:
    rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
except TypeError:
    print("TypeError")
print(future.done(), rclpy.ok())
rclpy.shutdown()
