#!/usr/bin/env python3
# Publishers and subscriptions: what they are called, what they take, how they end.
import time

import rclpy
from rclpy.exceptions import InvalidHandle, InvalidTopicNameException
from rclpy.qos import QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from rclpy.serialization import serialize_message
from std_msgs.msg import Int32, String

rclpy.init()
node = rclpy.create_node("publishers", namespace="/space")


def show(name, function):
    try:
        print(name, function())
    except Exception as error:
        print(name, "raised", type(error).__name__)


for name in ("chatter", "/chatter", "~/chatter", "~", "{node}/chatter"):
    publisher = node.create_publisher(String, name, 10)
    print(
        name, publisher.topic, publisher.topic_name, publisher.qos_profile.depth, publisher.msg_type is String
    )
    node.destroy_publisher(publisher)
for name in ("", "a b", "1a", "a/"):
    show(repr(name), lambda: node.create_publisher(String, name, 10))
for wrong in (-1, "10", 1.5, None):
    show(repr(wrong), lambda: type(node.create_publisher(String, "depth", wrong)).__name__)
show("no message class", lambda: node.create_publisher(int, "a", 10))
show("no message class", lambda: node.create_publisher("std_msgs/msg/String", "a", 10))
show("no callback", lambda: node.create_subscription(String, "a", 5, 10))
show("bad name", lambda: node.create_subscription(String, "a b", print, 10))

heard = []
publisher = node.create_publisher(String, "chatter", 10)
subscription = node.create_subscription(String, "chatter", heard.append, QoSProfile(depth=5))
print(
    subscription.topic_name,
    subscription.qos_profile.depth,
    len(list(node.publishers)),
    len(list(node.subscriptions)),
)


def settle(done):
    end = time.monotonic() + 5
    while not done() and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.05)


settle(lambda: publisher.get_subscription_count() == 1)
print(publisher.get_subscription_count(), subscription.get_publisher_count())
publisher.publish(String(data="a message"))
publisher.publish(serialize_message(String(data="bytes")))
settle(lambda: len(heard) == 2)
print(heard)
for wrong in (None, "text", Int32(), {"data": "x"}):
    show(f"publish {wrong!r}", lambda: publisher.publish(wrong))
print(publisher.wait_for_all_acked())

# The oldest are dropped when a subscription is not spun.
heard.clear()
for number in range(20):
    publisher.publish(String(data=str(number)))
time.sleep(0.3)
for _ in range(15):
    rclpy.spin_once(node, timeout_sec=0.05)
print([message.data for message in heard])

# A subscription that fits every publisher, one that does not.
best = node.create_publisher(Int32, "best", qos_profile_sensor_data)
numbers = []
node.create_subscription(
    Int32,
    "best",
    lambda message: numbers.append(message.data),
    QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_AVAILABLE),
)
settle(lambda: best.get_subscription_count() == 1)
best.publish(Int32(data=4))
settle(lambda: numbers)
print(numbers)

print(node.destroy_subscription(subscription), node.destroy_subscription(subscription))
print(node.destroy_publisher(publisher))
show("destroyed", lambda: publisher.publish(String()))
show("destroyed", lambda: publisher.get_subscription_count())
with node.create_publisher(String, "within", 1) as within:
    print(within.topic_name)
show("after with", lambda: within.publish(String()))
rclpy.shutdown()
show("after shutdown", lambda: best.publish(Int32()))
show("after shutdown", lambda: rclpy.create_node("late"))
