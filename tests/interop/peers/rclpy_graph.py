"""rclpy as a witness of the graph. rclpy_graph.py NODE TOPIC SERVICE: one line for each change of what it sees.

`nodes NAMES ENCLAVES`, `publishers INFO` and `subscriptions INFO` of TOPIC, `types OF SERVICE`, `of TOPICS` that
NODE publishes; INFO is node, namespace, type, hash, reliability, durability, GUID. It subscribes to /witnessed.
"""

import sys
import time

import rclpy
import rclpy.executors
from std_msgs.msg import String


def info_of(infos):
    found = []
    for info in infos:
        found.append(
            " ".join(
                (
                    info.node_name,
                    info.node_namespace,
                    info.topic_type,
                    str(info.topic_type_hash),
                    info.qos_profile.reliability.name,
                    info.qos_profile.durability.name,
                    bytes(info.endpoint_gid[:16]).hex(),
                )
            )
        )
    return "; ".join(sorted(found))


def main():
    node_name, topic, service = sys.argv[1:4]
    rclpy.init()
    witness = rclpy.create_node("witness", start_parameter_services=False, enable_rosout=False)
    witness.create_subscription(String, "witnessed", print, 10)
    said = {}
    ends = time.monotonic() + 60.0

    def say(what, text):
        if said.get(what) != text:
            said[what] = text
            print(what, text, flush=True)

    while time.monotonic() < ends:
        try:
            rclpy.spin_once(witness, timeout_sec=0.02)
        except rclpy.executors.ExternalShutdownException:
            return
        nodes = sorted(
            namespace.rstrip("/") + "/" + name + " " + enclave
            for name, namespace, enclave in witness.get_node_names_and_namespaces_with_enclaves()
        )
        say("nodes", "; ".join(nodes))
        say("publishers", info_of(witness.get_publishers_info_by_topic(topic)))
        say("subscriptions", info_of(witness.get_subscriptions_info_by_topic(topic)))
        say("types", str(dict(witness.get_service_names_and_types()).get(service)))
        namespace, _, name = node_name.rpartition("/")
        try:
            of = witness.get_publisher_names_and_types_by_node(name, namespace or "/")
        except RuntimeError as error:
            of = type(error).__name__
        say("of", str(of))


main()
