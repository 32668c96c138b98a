#!/usr/bin/env python3
# A program with types in its annotations, which Python evaluates, and older names of modules.
import warnings

import rclpy
from rclpy.node import HIDDEN_NODE_PREFIX, Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.subscription import MessageInfo, Subscription
from rclpy.task import Future
from rclpy.validate_topic_name import TOPIC_SEPARATOR_STRING
from rclpy.waitable import Waitable
from std_msgs.msg import String

with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    from rclpy.qos_event import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy import event_handler

print("warned", [warning.category.__name__ for warning in caught])
print(PublisherEventCallbacks is event_handler.PublisherEventCallbacks)
print(SubscriptionEventCallbacks is event_handler.SubscriptionEventCallbacks)
print(HIDDEN_NODE_PREFIX, TOPIC_SEPARATOR_STRING)


class Typed(Node):
    publisher: Publisher[String]
    subscription: Subscription[String]
    waitable: Waitable[None]
    parameters: list[Parameter[int]]

    def __init__(self) -> None:
        super().__init__("typed")
        self.parameters = [self.declare_parameter("number", 3)]
        self.future: Future[str] = Future()
        self.publisher = self.create_publisher(String, "topic", 10)
        self.subscription = self.create_subscription(String, "topic", self.heard, 10)

    def heard(self, message: String, info: MessageInfo) -> None:
        self.future.set_result(message.data)


def speak(publisher: Publisher[String], text: str) -> Future[str]:
    publisher.publish(String(data=text))
    return node.future


rclpy.init()
node = Typed()
while node.publisher.get_subscription_count() == 0:
    rclpy.spin_once(node, timeout_sec=0.05)
future = speak(node.publisher, "typed")
rclpy.spin_until_future_complete(node, future, timeout_sec=5.0)
print(future.result(), node.parameters[0].value, isinstance(node.publisher, Publisher))
rclpy.shutdown()
