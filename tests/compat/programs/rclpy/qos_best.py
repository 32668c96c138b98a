#!/usr/bin/env python3
# Policies that are left to the other side: what a publisher and a subscription make of those that are there.
import time

import rclpy
from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_best_available,
)
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("best")
other = rclpy.create_node("other")
plain = QoSProfile(depth=1)
best_effort = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
slow = QoSProfile(depth=1, deadline=Duration(seconds=2))
fast = QoSProfile(depth=1, deadline=Duration(seconds=1))
asserted = QoSProfile(
    depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, liveliness_lease_duration=Duration(seconds=3)
)
cases = (
    (),
    (plain,),
    (best_effort,),
    (plain, best_effort),
    (kept,),
    (kept, plain),
    (slow, fast),
    (slow, plain),
    (asserted,),
    (asserted, plain),
)


def settle(done):
    end = time.monotonic() + 5
    while not done() and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.05)


def show(name, info):
    found = info.qos_profile
    print(
        name,
        found.reliability.name,
        found.durability.name,
        found.liveliness.name,
        found.deadline.nanoseconds,
        found.liveliness_lease_duration.nanoseconds,
    )


for number, profiles in enumerate(cases):
    name = f"published_{number}"
    for profile in profiles:
        other.create_publisher(String, name, profile)
    settle(lambda: node.count_publishers(name) == len(profiles))
    subscription = node.create_subscription(String, name, print, qos_profile_best_available)
    settle(lambda: subscription.get_publisher_count() == len(profiles))
    settle(lambda: node.count_subscribers(name) == 1)
    show(name, node.get_subscriptions_info_by_topic(name)[0])
    print(subscription.get_publisher_count())

    name = f"subscribed_{number}"
    for profile in profiles:
        other.create_subscription(String, name, print, profile)
    settle(lambda: node.count_subscribers(name) == len(profiles))
    publisher = node.create_publisher(String, name, qos_profile_best_available)
    settle(lambda: publisher.get_subscription_count() == len(profiles))
    settle(lambda: node.count_publishers(name) == 1)
    show(name, node.get_publishers_info_by_topic(name)[0])
    print(publisher.get_subscription_count())
rclpy.shutdown()
