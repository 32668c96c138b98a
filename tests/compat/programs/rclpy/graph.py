#!/usr/bin/env python3
# Who is there: nodes, topics, services, endpoints.
import time

import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.topic_endpoint_info import TopicEndpointTypeEnum
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger

rclpy.init()
node = Node("watcher", namespace="/here")
other = Node("other", namespace="/there", start_parameter_services=False, enable_rosout=False)
hidden = rclpy.create_node("_hidden")


def settle(done):
    end = time.monotonic() + 10
    while not done() and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.05)


print(node.get_name(), node.get_namespace(), node.get_fully_qualified_name(), hidden.get_namespace())
print(node.wait_for_node("/there/other", 5.0), node.wait_for_node("/nobody", 0.2))
settle(lambda: len(node.get_node_names()) == 3)
print(sorted(node.get_node_names()))
print(sorted(node.get_node_names_and_namespaces()))
print(sorted(node.get_node_names_and_namespaces_with_enclaves()))
print(sorted(node.get_fully_qualified_node_names()))

publisher = node.create_publisher(
    String, "topic", QoSProfile(depth=3, durability=DurabilityPolicy.TRANSIENT_LOCAL)
)
subscription = other.create_subscription(
    String,
    "/here/topic",
    print,
    QoSProfile(depth=7, reliability=ReliabilityPolicy.BEST_EFFORT, deadline=Duration(seconds=1)),
)
service = other.create_service(Trigger, "service", lambda request, response: response)
client = node.create_client(Trigger, "/there/service")
settle(lambda: node.count_subscribers("topic") == 1 and client.service_is_ready())
print(
    node.count_publishers("topic"),
    node.count_subscribers("topic"),
    node.count_publishers("/here/topic"),
    node.count_publishers("nothing"),
)
print(
    node.count_services("/there/service"),
    node.count_clients("/there/service"),
    other.count_services("service"),
)
topics = dict(node.get_topic_names_and_types())
print(topics["/here/topic"], topics["/rosout"], topics["/parameter_events"])
print([name for name in dict(node.get_topic_names_and_types(no_demangle=True)) if name.endswith("topic")])
print(dict(node.get_service_names_and_types())["/there/service"])
print(node.get_publisher_names_and_types_by_node("watcher", "/here"))
print(node.get_subscriber_names_and_types_by_node("other", "/there"))
print(
    [
        entry
        for entry in node.get_service_names_and_types_by_node("other", "/there")
        if "type_desc" not in entry[0]
    ]
)
print(node.get_client_names_and_types_by_node("watcher", "/here"))
try:
    node.get_publisher_names_and_types_by_node("nobody", "/")
except Exception as error:
    print(type(error).__name__)
publishers = node.get_publishers_info_by_topic("topic")
print(len(publishers), node.get_publishers_info_by_topic("nothing"))
info = publishers[0]
print(
    info.node_name,
    info.node_namespace,
    info.topic_type,
    info.endpoint_type == TopicEndpointTypeEnum.PUBLISHER,
)
print(
    len(info.endpoint_gid),
    info.topic_type_hash,
    info.qos_profile.durability.name,
    info.qos_profile.reliability.name,
)
info = node.get_subscriptions_info_by_topic("topic")[0]
print(info.node_name, info.node_namespace, info.endpoint_type.name, info.qos_profile.reliability.name)
print(info.qos_profile.deadline, info.qos_profile.lifespan, info.qos_profile.liveliness.name)
print(
    sorted(
        info.node_namespace + "/" + info.node_name for info in node.get_publishers_info_by_topic("/rosout")
    )
)
print(
    node.resolve_topic_name("topic"),
    node.resolve_topic_name("~/topic"),
    node.resolve_service_name("/service"),
)

client.destroy()
other.destroy_service(service)
other.destroy_subscription(subscription)
settle(lambda: node.count_subscribers("topic") == 0 and node.count_services("/there/service") == 0)
print(
    node.count_subscribers("topic"),
    node.count_services("/there/service"),
    node.count_clients("/there/service"),
)
other.destroy_node()
settle(lambda: "other" not in node.get_node_names())
print(sorted(node.get_node_names()))
for wrong in ("no-de", "", "a/b"):
    try:
        rclpy.create_node(wrong)
    except Exception as error:
        print(type(error).__name__)
try:
    rclpy.create_node("node", namespace="in valid")
except Exception as error:
    print(type(error).__name__)
print(rclpy.create_node("node", namespace="relative").get_fully_qualified_name())
rclpy.shutdown()
