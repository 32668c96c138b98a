#!/usr/bin/env python3
# What a publisher and a subscription are told about quality of service.
import time

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import (
    PublisherEventCallbacks,
    QoSPublisherMatchedInfo,
    SubscriptionEventCallbacks,
)
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_policy_name_from_kind,
)
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("events")
executor = SingleThreadedExecutor()
executor.add_node(node)


def settle(done, seconds=5.0):
    end = time.monotonic() + seconds
    while not done() and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    return bool(done())


def incompatible(name, publisher, subscription):
    told = {}
    first = node.create_publisher(
        String,
        name,
        QoSProfile(depth=1, **publisher),
        event_callbacks=PublisherEventCallbacks(incompatible_qos=lambda event: told.update(publisher=event)),
    )
    second = node.create_subscription(
        String,
        name,
        lambda message: None,
        QoSProfile(depth=1, **subscription),
        event_callbacks=SubscriptionEventCallbacks(
            incompatible_qos=lambda event: told.update(subscription=event)
        ),
    )
    settle(lambda: len(told) == 2)
    for side, event in sorted(told.items()):
        print(
            name,
            side,
            event.total_count,
            event.total_count_change,
            qos_policy_name_from_kind(event.last_policy_kind),
        )
    print(name, first.get_subscription_count(), node.count_publishers(name))
    node.destroy_publisher(first)
    node.destroy_subscription(second)


incompatible("reliability", {"reliability": ReliabilityPolicy.BEST_EFFORT}, {})
incompatible("durability", {}, {"durability": DurabilityPolicy.TRANSIENT_LOCAL})
incompatible("deadline", {}, {"deadline": Duration(seconds=1)})
incompatible(
    "liveliness", {"liveliness": LivelinessPolicy.AUTOMATIC}, {"liveliness": LivelinessPolicy.MANUAL_BY_TOPIC}
)

# Matched, and no longer.
told = []
publisher = node.create_publisher(
    String,
    "matched",
    10,
    event_callbacks=PublisherEventCallbacks(matched=lambda event: told.append(("p", event))),
)
subscription = node.create_subscription(
    String,
    "matched",
    lambda message: None,
    10,
    event_callbacks=SubscriptionEventCallbacks(matched=lambda event: told.append(("s", event))),
)
settle(lambda: len(told) == 2)
print(
    sorted(
        (side, e.total_count, e.total_count_change, e.current_count, e.current_count_change)
        for side, e in told
    )
)
print(isinstance(told[0][1], QoSPublisherMatchedInfo) or isinstance(told[1][1], QoSPublisherMatchedInfo))
told.clear()
node.destroy_subscription(subscription)
settle(lambda: told)
print(
    [(side, e.total_count, e.total_count_change, e.current_count, e.current_count_change) for side, e in told]
)

# Deadlines, on both sides.
missed = {"p": 0, "s": 0}


def miss(side):
    return lambda event: missed.update({side: missed[side] + event.total_count_change})


profile = QoSProfile(depth=10, deadline=Duration(seconds=0.1))
publisher = node.create_publisher(
    String, "late", profile, event_callbacks=PublisherEventCallbacks(deadline=miss("p"))
)
subscription = node.create_subscription(
    String,
    "late",
    lambda message: None,
    profile,
    event_callbacks=SubscriptionEventCallbacks(deadline=miss("s")),
)
settle(lambda: publisher.get_subscription_count() == 1)
publisher.publish(String())
print("missed", settle(lambda: missed["p"] >= 2 and missed["s"] >= 2))
node.destroy_publisher(publisher)
node.destroy_subscription(subscription)

# Liveliness that has to be asserted.
lost, alive = [], []
profile = QoSProfile(
    depth=10, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, liveliness_lease_duration=Duration(seconds=0.2)
)
publisher = node.create_publisher(
    String, "living", profile, event_callbacks=PublisherEventCallbacks(liveliness=lost.append)
)
subscription = node.create_subscription(
    String,
    "living",
    lambda message: None,
    profile,
    event_callbacks=SubscriptionEventCallbacks(liveliness=alive.append),
)
settle(lambda: publisher.get_subscription_count() == 1)
publisher.assert_liveliness()
print("alive", settle(lambda: alive and alive[-1].alive_count == 1))
print(
    "lost",
    settle(lambda: lost and alive[-1].not_alive_count == 1),
    lost[-1].total_count,
    alive[-1].alive_count,
)
publisher.assert_liveliness()
print("again", settle(lambda: alive[-1].alive_count == 1))
rclpy.shutdown()
