"""A roslet node that obeys commands (see commands.py). roslet_ros2.py [NAME [NAMESPACE [NETWORK]]]; without a name it
has a node only in what it forks.

publisher KEY TOPIC TYPE QOS              publish KEY FIRST COUNT SIZE PAUSE      the messages are those of ros2_samples.py
subscription KEY TOPIC TYPE SIZE QOS      heard KEY, events KEY                   what came so far, since it was made
service, client KEY NAME TYPE             call KEY FIRST COUNT SIZE TIMEOUT       what was wrong with the answers
log TEXTS, hear_log, heard_log            tell_time SECONDS, simulate BOOL, now        describe NODE TYPE HASH TIMEOUT
matched KEY, ready KEY, close KEY         nodes, topics, services, services_of NODE, endpoints TOPIC, counts TOPIC
process, tables                           what it holds
mortal NAME, kill PID                     a node in a child, and its end
"""

import gc
import hashlib
import os
import pathlib
import struct
import sys
import time

from commands import described, fork, kill, logged, process, run
from ros2_samples import QOS, Inbox, build, differences, expected, request, response, sample

import roslet
from roslet.gen.runtime import message_class
from roslet.io.ros2 import Ros2Shell
from roslet.io.select import reactor
from roslet.names import parse_ros2_network
from roslet.node import events as kinds
from roslet.node.ros2.qos import from_dds, to_dds

WORKSPACE = pathlib.Path(__file__).resolve().parent.parent / "ros2_ws"

endpoints = {}
inboxes = {}
facts = {}
members = []  # of a crowd
node = None


def make(type_name, fields):
    return message_class("ros2", type_name)(**fields)


def profile(qos):
    qos = {**QOS, **qos}
    qos["liveliness_lease"] = qos.pop("lease")
    return roslet.QoS(**qos)


def watch(key, endpoint):
    told = facts[key] = []

    def on_event(event):
        kind = type(event)
        if kind is kinds.QosIncompatible:
            told.extend(["incompatible", policy] for policy in event.policies)
        elif kind is kinds.MessagesLost:
            told.append(["messages lost", event.count])
        elif kind in (kinds.DeadlineMissed, kinds.LivelinessLost, kinds.LivelinessRegained):
            names = {
                kinds.DeadlineMissed: "deadline",
                kinds.LivelinessLost: "lost",
                kinds.LivelinessRegained: "alive",
            }
            told.append([names[kind]])

    endpoint.on_event(on_event)
    endpoints[key] = endpoint


def publisher(key, topic, type_name, qos):
    watch(key, node.publisher(topic, type_name, qos=profile(qos)))


def subscription(key, topic, type_name, size, qos, nap=0.0):
    inbox = inboxes[key] = Inbox(type_name, size, nap)
    watch(key, node.subscribe(topic, type_name, inbox, qos=profile(qos)))


def publish(key, first, count, size, pause):
    made = endpoints[key]
    for i in range(first, first + count):
        made.publish(build(sample(made.type._type, i, size), make, bytes, ord))
        time.sleep(pause)


def matched(key):
    made = endpoints[key]
    return made.subscriber_count if hasattr(made, "subscriber_count") else made.publisher_count


def service(key, name, type_name):
    endpoints[key] = node.service(name, type_name, lambda asked: response(type_name, asked))


def client(key, name, type_name):
    endpoints[key] = node.client(name, type_name)


def call(key, first, count, size, timeout):
    made = endpoints[key]
    futures = []
    for i in range(first, first + count):
        fields = build(request(made.type._type, i, size), make, bytes, ord)
        futures.append(made.call_async(**fields))
    end = time.monotonic() + timeout
    wrong = []
    for i, future in enumerate(futures, first):
        try:
            answer = future.result(max(end - time.monotonic(), 0.001))
        except roslet.CallTimeout:
            wrong.append("%d: timeout" % i)
            continue
        wrong += differences(expected(made.type._type, i, size), answer, str(i))
    return wrong


def impatient(key, timeout):
    """What a call with a timeout raises, and after how long."""
    begun = time.monotonic()
    try:
        endpoints[key].call(timeout=timeout)
    except roslet.RosletError as error:
        return [type(error).__name__, str(error), time.monotonic() - begun]
    return None


def graph_endpoints(topic):
    found = []
    for one in node.endpoints(topic):
        qos = from_dds(one.qos)
        found.append(
            {
                "kind": "publisher" if one.kind == 1 else "subscription",
                "node": one.node_namespace.rstrip("/") + "/" + one.node_name,
                "type": one.type_name,
                "hash": one.type_hash,
                "reliability": qos.reliability,
                "durability": qos.durability,
                "liveliness": qos.liveliness,
                "deadline": qos.deadline,
                "lifespan": qos.lifespan,
                "lease": qos.liveliness_lease,
            }
        )
    return found


def of_graph(question):
    with node.reactor.lock:
        return question(node._network.graph)


def services_of(full_name):
    namespace, _, name = full_name.rpartition("/")
    return of_graph(lambda graph: graph.services((name, namespace or "/")))


def counts(topic):
    found = [one["kind"] for one in graph_endpoints(topic)]
    return [found.count("publisher"), found.count("subscription")]


def tables():
    """How much is held of others: participants, endpoints, and what our endpoints hold of theirs; and objects at all."""
    shell = node._network.shell
    with node.reactor.lock:
        participant = shell.participant
        graph = shell.context.graph
        found = {
            "remotes": len(participant.spdp.remotes),
            "endpoints": len(participant.endpoints),
            "graph participants": len(graph._participants),
            "graph endpoints": len(graph._endpoints),
            "writer proxies": sum(len(one.proxies) for one in participant.readers.values()),
            "reader proxies": sum(len(one.proxies) for one in participant.writers.values()),
        }
    gc.collect()
    return {**found, "objects": len(gc.get_objects())}


def keyed(key, topic, type_name):
    """A reader of a keyed topic, which a node does not have: the participant's own. It tells of samples by their payload,
    and of instances by their state. The key is a string, and the first field; Cyclone sends no key hash."""
    from roslet.engine.rtps.events import InstanceChanged
    from roslet.wire.rtps import qos as policies

    heard = inboxes[key] = []
    shell = node._network.shell

    def name_of(value):
        body = bytes(value.payload)
        return body[8 : 8 + body[4] - 1]

    def happened(event):
        if isinstance(event, InstanceChanged):
            heard.append(["instance", event.state, event.key.decode()])

    with node.reactor.lock:
        reader = shell.participant.create_reader(
            "rt" + topic,
            type_name,
            policies.Qos(reliability=(policies.RELIABLE, 10**8), history=(policies.KEEP_ALL, 1)),
            node.reactor.now(),
            keyed=True,
            key_of=name_of,
            sink=lambda proxy, value, when: heard.append(["sample", bytes(value.payload).hex()]),
        )
        shell.handle(reader.entity_id, happened)
        shell.flush()


def keyed_writer(key, topic, type_name):
    """A writer of a keyed topic, likewise; `write_keyed` and the others are those of cyclone_ros2.py."""
    from roslet.wire.rtps import qos as policies

    shell = node._network.shell
    with node.reactor.lock:
        endpoints[key] = shell.participant.create_writer(
            "rt" + topic,
            type_name,
            policies.Qos(reliability=(policies.RELIABLE, 10**8), history=(policies.KEEP_ALL, 1)),
            node.reactor.now(),
            keyed=True,
        )
        shell.flush()


def of_instance(act):
    """A command KEY NAME [VALUE] on an instance: `act(writer, key hash, serialised name, now, VALUE)`."""

    def command(key, name, *value):
        octets = name.encode() + b"\0"
        big, little = (struct.pack(order + "I", len(octets)) + octets for order in "><")
        with node.reactor.lock:
            act(endpoints[key], hashlib.md5(big).digest(), b"\0\1\0\0" + little, node.reactor.now(), *value)
            node._network.shell.flush()

    return command


def write_keyed(writer, instance, name, now, value):
    writer.write(name + bytes(-len(name) % 4) + struct.pack("<i", value), now, key=instance)


def log(texts):
    for level, text in zip(("debug", "info", "warning", "error", "fatal"), texts, strict=True):
        getattr(node.log, level)(text)


def hear_log():
    heard = inboxes["/rosout"] = []
    qos = roslet.QoS(1000, durability="transient_local")
    node.subscribe("/rosout", "rcl_interfaces/msg/Log", lambda entry: heard.append(logged(entry)), qos=qos)


def tell_time(seconds):
    if "/clock" not in endpoints:
        endpoints["/clock"] = node.publisher("/clock", "rosgraph_msgs/msg/Clock")
    endpoints["/clock"].publish(clock=roslet.Time.from_sec(seconds))


def describe(asked, type_name, type_hash, timeout):
    """What a node says a type is made of."""
    service = asked + "/get_type_description"
    with node.client(service, "type_description_interfaces/srv/GetTypeDescription") as asking:
        found = asking.call(
            type_name=type_name, type_hash=type_hash, include_type_sources=False, timeout=timeout
        )
    return described(found)


def begin(name, namespace="", network=None):
    global node
    roslet.load(WORKSPACE)
    node = roslet.Node(name, namespace=namespace, network=network)
    node.start()


class Member:
    """One of a crowd: a participant of its own with a node, a writer and a reader of /crowd. It is made below roslet.Node,
    whose services of parameters would be hundreds of endpoints more for each to learn of."""

    def __init__(self, number):
        self.number = number
        self.heard = []
        name, kind = "crowd_%d" % number, message_class("ros2", "std_msgs/msg/UInt32")
        self.shell = Ros2Shell(reactor(), parse_ros2_network(None, os.environ), "/" + name, print)
        self.payload = kind(data=number).serialize()
        with self.shell.reactor.lock:
            now, context = self.shell.reactor.now(), self.shell.context
            handle = context.add_node(name, "/", now)
            topic = ("rt/crowd", "std_msgs::msg::dds_::UInt32_", to_dds(roslet.QoS()), kind._type_hash, now)
            self.writer = context.create_writer(handle, *topic)
            self.reader = context.create_reader(handle, *topic, sink=self.hear)
            self.shell.flush()

    def hear(self, proxy, value, when):
        self.heard.append(int.from_bytes(bytes(value.payload[4:8]), "little"))

    def publish(self):
        with self.shell.reactor.lock:
            self.writer.write(self.payload, self.shell.reactor.now())
            self.shell.flush()


def crowd(first, count):
    members.extend(Member(number) for number in range(first, first + count))


def crowd_matched():
    """How many readers and how many writers each has matched with, each number once. Its own are not among them."""
    return sorted({len(one.writer.proxies) for one in members} | {len(one.reader.proxies) for one in members})


def mortal(name):
    """A node that lives until it is killed. Once it hears std_msgs/msg/UInt32 on /to, it says its pid on /from."""
    made = roslet.Node(name)
    talker = made.publisher("/from", "std_msgs/msg/String")
    made.subscribe("/to", "std_msgs/msg/UInt32", lambda _: talker.publish(data="%d" % os.getpid()))
    made.spin()


COMMANDS = {
    "publisher": publisher,
    "subscription": subscription,
    "publish": publish,
    "assert_liveliness": lambda key: endpoints[key].assert_liveliness(),
    "heard": lambda key: inboxes[key].told(),
    "last": lambda key: inboxes[key].numbers[-1:],
    "events": lambda key: facts[key],
    "matched": matched,
    "close": lambda key: endpoints.pop(key).close(),
    "service": service,
    "client": client,
    "ready": lambda key: endpoints[key].ready(),
    "call": call,
    "impatient": impatient,
    "nodes": lambda: node.nodes(),
    "topics": lambda: of_graph(lambda graph: graph.topics()),
    "services": lambda: of_graph(lambda graph: graph.services()),
    "services_of": services_of,
    "endpoints": graph_endpoints,
    "counts": counts,
    "counters": lambda: node.counters,
    "keyed": keyed,
    "heard_keyed": lambda key: inboxes[key],
    "keyed_writer": keyed_writer,
    "keyed_matched": lambda key: len(endpoints[key].proxies),
    "write_keyed": of_instance(write_keyed),
    "dispose_keyed": of_instance(lambda writer, key, name, now: writer.dispose(key, now, name)),
    "unregister_keyed": of_instance(lambda writer, key, name, now: writer.unregister(key, now, name)),
    "log": log,
    "hear_log": hear_log,
    "heard_log": lambda: inboxes["/rosout"],
    "tell_time": tell_time,
    "simulate": lambda wanted: node.set_parameter("use_sim_time", wanted),
    "now": lambda: node.now().to_sec(),
    "describe": describe,
    "process": process,
    "tables": tables,
    "crowd": crowd,
    "crowd_matched": crowd_matched,
    "crowd_publish": lambda: [one.publish() for one in members] and None,
    "crowd_heard": lambda: [sorted(one.heard) for one in members],
    "crowd_close": lambda: [one.shell.close() for one in members] and None,
    "close_node": lambda: node.close(),
    "mortal": lambda name: fork(lambda: mortal(name)),
    "kill": kill,
}

if len(sys.argv) > 1:
    begin(*sys.argv[1:])
run(COMMANDS)
