"""An rclpy node that obeys the commands of roslet_ros2.py. rclpy_ros2.py [NAME]; without a name it has a node only in
what it forks: see `mortal`.
"""

import array
import contextlib
import importlib
import os
import sys
import threading
import time

import rclpy
from commands import described, fork, kill, logged, process, run
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
)
from ros2_samples import QOS, Inbox, build, differences, expected, request, response, sample

POLICIES = {2: "durability", 4: "deadline", 8: "liveliness", 16: "reliability", 32: "history", 64: "lifespan"}

endpoints = {}  # what a key stands for
inboxes = {}
facts = {}
node = None


def find(type_name):
    package, kind, name = type_name.split("/")
    return getattr(importlib.import_module(package + "." + kind), name)


def make(type_name, fields):
    message = find(type_name)()
    for name, value in fields.items():
        setattr(message, name, value)
    return message


def octets(value):
    return array.array("B", value)


def duration(seconds):
    return Duration(nanoseconds=round(seconds * 1e9))


def profile(qos):
    qos = {**QOS, **qos}
    made = QoSProfile(
        history=getattr(HistoryPolicy, qos["history"].upper()),
        depth=qos["depth"],
        reliability=getattr(ReliabilityPolicy, qos["reliability"].upper()),
        durability=getattr(DurabilityPolicy, qos["durability"].upper()),
        liveliness=getattr(LivelinessPolicy, qos["liveliness"].upper()),
    )
    if qos["deadline"]:
        made.deadline = duration(qos["deadline"])
    if qos["lifespan"]:
        made.lifespan = duration(qos["lifespan"])
    if qos["lease"]:
        made.liveliness_lease_duration = duration(qos["lease"])
    return made


def policy(status):
    return POLICIES[int(status.last_policy_kind)]


def publisher(key, topic, type_name, qos):
    told = facts[key] = []
    events = PublisherEventCallbacks(
        incompatible_qos=lambda status: told.append(["incompatible", policy(status)]),
        deadline=lambda status: told.append(["deadline"]),
        liveliness=lambda status: told.append(["lost"]),
    )
    made = node.create_publisher(find(type_name), topic, profile(qos), event_callbacks=events)
    endpoints[key] = (made, type_name)


def liveliness(told, status):
    if status.alive_count_change > 0:
        told.append(["alive"])
    if status.not_alive_count_change > 0:
        told.append(["lost"])


def subscription(key, topic, type_name, size, qos, nap=0.0):
    told = facts[key] = []
    inbox = inboxes[key] = Inbox(type_name, size, nap)
    events = SubscriptionEventCallbacks(
        incompatible_qos=lambda status: told.append(["incompatible", policy(status)]),
        deadline=lambda status: told.append(["deadline"]),
        liveliness=lambda status: liveliness(told, status),
        message_lost=lambda status: told.append(["messages lost", status.total_count_change]),
    )
    made = node.create_subscription(find(type_name), topic, inbox, profile(qos), event_callbacks=events)
    endpoints[key] = (made, type_name)


def publish(key, first, count, size, pause):
    made, type_name = endpoints[key]
    for i in range(first, first + count):
        made.publish(build(sample(type_name, i, size), make, octets))
        time.sleep(pause)


def close(key):
    made, _ = endpoints.pop(key)
    for destroy in (
        node.destroy_publisher,
        node.destroy_subscription,
        node.destroy_service,
        node.destroy_client,
    ):
        if destroy(made):  # False for what is another kind of thing
            return


def matched(key):
    made, _ = endpoints[key]
    if hasattr(made, "get_subscription_count"):
        return made.get_subscription_count()
    return made.get_publisher_count() if hasattr(made, "get_publisher_count") else -1


def service(key, name, type_name):
    def answer(asked, answered):
        for field, value in response(type_name, asked).items():
            setattr(answered, field, value)
        return answered

    endpoints[key] = (node.create_service(find(type_name), name, answer), type_name)


def client(key, name, type_name):
    endpoints[key] = (node.create_client(find(type_name), name), type_name)


def ready(key):
    return endpoints[key][0].service_is_ready()


def call(key, first, count, size, timeout):
    """So many calls in flight at once: what was wrong with the answers, "timeout" for one that never came."""
    made, type_name = endpoints[key]
    futures = []
    for i in range(first, first + count):
        asked = find(type_name).Request()
        for field, value in build(request(type_name, i, size), make, octets).items():
            setattr(asked, field, value)
        futures.append(made.call_async(asked))
    end = time.monotonic() + timeout
    wrong = []
    for i, future in enumerate(futures, first):
        while not future.done() and time.monotonic() < end:
            time.sleep(0.002)
        if future.done():
            wrong += differences(expected(type_name, i, size), future.result(), str(i))
        else:
            wrong.append("%d: timeout" % i)
            made.remove_pending_request(future)
    return wrong


def seconds(span):
    return None if span.nanoseconds >= 2**62 else span.nanoseconds / 1e9


def graph_endpoints(topic):
    found = []
    for kind, infos in (
        ("publisher", node.get_publishers_info_by_topic(topic)),
        ("subscription", node.get_subscriptions_info_by_topic(topic)),
    ):
        for one in infos:
            qos = one.qos_profile
            found.append(
                {
                    "kind": kind,
                    "node": one.node_namespace.rstrip("/") + "/" + one.node_name,
                    "type": one.topic_type,
                    "hash": str(one.topic_type_hash),
                    "reliability": qos.reliability.name.lower(),
                    "durability": qos.durability.name.lower(),
                    "liveliness": qos.liveliness.name.lower(),
                    "deadline": seconds(qos.deadline),
                    "lifespan": seconds(qos.lifespan),
                    "lease": seconds(qos.liveliness_lease_duration),
                }
            )
    return found


def services_of(full_name):
    namespace, _, name = full_name.rpartition("/")
    return dict(node.get_service_names_and_types_by_node(name, namespace or "/"))


def log(texts):
    """One line of each level; rclpy wants a place in the program for each."""
    logger = node.get_logger()
    logger.debug(texts[0])
    logger.info(texts[1])
    logger.warning(texts[2])
    logger.error(texts[3])
    logger.fatal(texts[4])


def hear_log():
    from rcl_interfaces.msg import Log

    heard = inboxes["/rosout"] = []
    qos = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(Log, "/rosout", lambda entry: heard.append(logged(entry)), qos)


def tell_time(seconds):
    from rosgraph_msgs.msg import Clock

    if "/clock" not in endpoints:
        endpoints["/clock"] = (node.create_publisher(Clock, "/clock", 10), "rosgraph_msgs/msg/Clock")
    message = Clock()
    message.clock.sec, message.clock.nanosec = int(seconds), round(seconds % 1 * 1e9)
    endpoints["/clock"][0].publish(message)


def simulate(wanted):
    node.set_parameters([rclpy.Parameter("use_sim_time", value=wanted)])


def describe(asked, type_name, type_hash, timeout):
    """What a node says a type is made of."""
    from type_description_interfaces.srv import GetTypeDescription

    service = node.create_client(GetTypeDescription, asked + "/get_type_description")
    assert service.wait_for_service(timeout)
    request = GetTypeDescription.Request(type_name=type_name, type_hash=type_hash, include_type_sources=False)
    future = service.call_async(request)
    end = time.monotonic() + timeout
    while not future.done() and time.monotonic() < end:
        time.sleep(0.002)
    found = future.result()
    node.destroy_client(service)
    return described(found)


def begin(name, namespace="/"):
    global node
    rclpy.init()
    node = rclpy.create_node(name, namespace=namespace)
    executor = SingleThreadedExecutor()
    executor.add_node(node)

    def spin():
        with contextlib.suppress(ExternalShutdownException):
            executor.spin()

    threading.Thread(target=spin, daemon=True).start()


def close_node():
    node.destroy_node()
    rclpy.shutdown()


def mortal(name):
    """A node that lives until it is killed. Once it hears std_msgs/msg/UInt32 on /to, it says its pid on /from."""
    from std_msgs.msg import String, UInt32

    rclpy.init()
    made = rclpy.create_node(name)
    talker = made.create_publisher(String, "/from", 10)
    made.create_subscription(UInt32, "/to", lambda _: talker.publish(String(data="%d" % os.getpid())), 10)
    rclpy.spin(made)


COMMANDS = {
    "publisher": publisher,
    "subscription": subscription,
    "publish": publish,
    "assert_liveliness": lambda key: endpoints[key][0].assert_liveliness(),
    "heard": lambda key: inboxes[key].told(),
    "last": lambda key: inboxes[key].numbers[-1:],
    "events": lambda key: facts[key],
    "matched": matched,
    "close": close,
    "service": service,
    "client": client,
    "ready": ready,
    "call": call,
    "nodes": lambda: sorted(
        namespace.rstrip("/") + "/" + name for name, namespace in node.get_node_names_and_namespaces()
    ),
    "topics": lambda: dict(node.get_topic_names_and_types()),
    "services": lambda: dict(node.get_service_names_and_types()),
    "services_of": services_of,
    "endpoints": graph_endpoints,
    "counts": lambda topic: [node.count_publishers(topic), node.count_subscribers(topic)],
    "service_counts": lambda name: [node.count_services(name), node.count_clients(name)],
    "log": log,
    "hear_log": hear_log,
    "heard_log": lambda: inboxes["/rosout"],
    "tell_time": tell_time,
    "simulate": simulate,
    "now": lambda: node.get_clock().now().nanoseconds / 1e9,
    "describe": describe,
    "process": process,
    "close_node": close_node,
    "mortal": lambda name: fork(lambda: mortal(name)),
    "kill": kill,
}

if len(sys.argv) > 1:
    begin(*sys.argv[1:])
run(COMMANDS)
os._exit(0)  # whatever threads of the middleware are doing
