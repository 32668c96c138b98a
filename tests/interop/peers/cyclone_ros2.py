"""A CycloneDDS program that obeys the commands of roslet_ros2.py. There is no rmw in it: topics, types and services have
the names that ROS 2 gives them in DDS, and the types are written by hand in cyclone_types.py.
"""

import os
import struct
import sys
import threading
import time
import uuid

from commands import fork, kill, process, run
from cyclone_types import GRAPHS, HASH, SERVICES, TYPES, Keyed, String, UInt32, make
from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsParticipant
from cyclonedds.core import Listener, Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from ros2_samples import QOS, Inbox, build, differences, expected, request, response, sample

POLICIES = {
    2: "durability",
    3: "presentation",
    4: "deadline",
    5: "latency_budget",
    6: "ownership",
    8: "liveliness",
    11: "reliability",
    12: "destination_order",
    25: "representation",
}
# What rclpy cannot say and we never do, by what it concerns.
STRANGE = {
    "presentation": Policy.PresentationAccessScope.Topic(False, False),
    "latency_budget": Policy.LatencyBudget(duration(seconds=1)),
    "ownership": Policy.Ownership.Exclusive,
    "destination_order": Policy.DestinationOrder.BySourceTimestamp,
    "representation": Policy.DataRepresentation(
        use_cdrv0_representation=False, use_xcdrv2_representation=True
    ),
    "partition": Policy.Partition(["elsewhere"]),
}
KEPT = {"durability": "transient_local", "depth": 1}

endpoints = {}
inboxes = {}
facts = {}
nodes = {}  # by participant, as its newest ros_discovery_info has them
participant = None


def span(seconds):
    return duration(infinite=True) if seconds is None else duration(nanoseconds=round(seconds * 1e9))


def profile(qos):
    qos = {**QOS, **qos}
    reliable = qos["reliability"] == "reliable"
    live = Policy.Liveliness
    live = live.Automatic if qos["liveliness"] == "automatic" else live.ManualByTopic
    return Qos(
        Policy.Reliability.Reliable(duration(seconds=10)) if reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal
        if qos["durability"] == "transient_local"
        else Policy.Durability.Volatile,
        Policy.History.KeepAll if qos["history"] == "keep_all" else Policy.History.KeepLast(qos["depth"]),
        Policy.DurabilityService(
            cleanup_delay=0,
            history=Policy.History.KeepLast(qos["depth"]),
            max_samples=-1,
            max_instances=-1,
            max_samples_per_instance=-1,
        ),
        Policy.Deadline(span(qos["deadline"])),
        Policy.Lifespan(span(qos["lifespan"])),
        live(span(qos["lease"])),
        *(STRANGE[name] for name in qos.get("strange", ())),
    )


class Endpoint:
    def __init__(self, entity, type_name):
        self.entity = entity
        self.type_name = type_name
        self.open = True


class Watching(Listener):
    """Keeps what happens to an endpoint."""

    def __init__(self, told):
        self.told = told
        super().__init__()

    def on_requested_incompatible_qos(self, reader, status):
        self.told.append(["incompatible", POLICIES[status.last_policy_id]])

    def on_offered_incompatible_qos(self, writer, status):
        self.told.append(["incompatible", POLICIES[status.last_policy_id]])

    def on_requested_deadline_missed(self, reader, status):
        self.told.append(["deadline"])

    def on_offered_deadline_missed(self, writer, status):
        self.told.append(["deadline"])

    def on_liveliness_changed(self, reader, status):
        if status.alive_count_change > 0:
            self.told.append(["alive"])
        if status.not_alive_count_change > 0:
            self.told.append(["lost"])

    def on_liveliness_lost(self, writer, status):
        self.told.append(["lost"])

    def on_sample_lost(self, reader, status):
        self.told.append(["messages lost", status.total_count_change])


def publisher(key, topic, type_name, qos):
    told = facts[key] = []
    made = Topic(participant, "rt" + topic, TYPES[type_name])
    writer = DataWriter(participant, made, qos=profile(qos), listener=Watching(told))
    endpoints[key] = Endpoint(writer, type_name)


def taking(endpoint, sink):
    """A thread that gives every valid sample to `sink`."""

    def take():
        while endpoint.open:
            for one in endpoint.entity.take(100):
                if one.sample_info.valid_data:
                    sink(one)
            time.sleep(0.003)

    threading.Thread(target=take, daemon=True).start()


def subscription(key, topic, type_name, size, qos, nap=0.0):
    told = facts[key] = []
    inbox = inboxes[key] = Inbox(type_name, size, nap)
    made = Topic(participant, "rt" + topic, TYPES[type_name])
    reader = DataReader(participant, made, qos=profile(qos), listener=Watching(told))
    endpoint = endpoints[key] = Endpoint(reader, type_name)
    taking(endpoint, inbox)


def publish(key, first, count, size, pause):
    made = endpoints[key]
    for i in range(first, first + count):
        made.entity.write(build(sample(made.type_name, i, size), make, list, ord))
        time.sleep(pause)


def matched(key):
    entity = endpoints[key].entity
    if isinstance(entity, DataWriter):
        return len(entity.get_matched_subscriptions())
    return len(entity.get_matched_publications())


def close(key):
    endpoint = endpoints.pop(key)
    endpoint.open = False
    time.sleep(0.02)
    del endpoint


def keyed(key, topic):
    made = Topic(participant, "rt" + topic, Keyed)
    endpoints[key] = Endpoint(DataWriter(participant, made, qos=profile({})), "keyed")


def hear_keyed(key, topic):
    """Every sample and every change of an instance's state: ALIVE 16, DISPOSED 32, UNREGISTERED 64."""
    heard = inboxes[key] = []
    made = Topic(participant, "rt" + topic, Keyed)
    reader = DataReader(participant, made, qos=profile({"history": "keep_all"}))
    endpoint = endpoints[key] = Endpoint(reader, "keyed")

    def take():
        while endpoint.open:
            for one in reader.take(100):
                valid, state = one.sample_info.valid_data, one.sample_info.instance_state
                heard.append([one.name, one.value, state] if valid else [one.key_sample.name, None, state])
            time.sleep(0.003)

    threading.Thread(target=take, daemon=True).start()


def write_keyed(key, name, value):
    endpoints[key].entity.write(Keyed(name=name, value=value))


def dispose_keyed(key, name):
    endpoints[key].entity.dispose(Keyed(name=name, value=0))


def unregister_keyed(key, name):
    writer = endpoints[key].entity
    writer.unregister_instance(Keyed(name=name, value=0))


def user_data(name, value):
    return Policy.Userdata(("%s=%s;" % (name, value)).encode())


def both_ways(name, type_name, serving):
    """Reader and writer of a service, or of a client of it, and what identifies them in the header."""
    asked, answered = SERVICES[type_name]
    requests = Topic(participant, "rq" + name + "Request", asked)
    replies = Topic(participant, "rr" + name + "Reply", answered)
    own = uuid.uuid4()
    identity = user_data("serviceid" if serving else "clientid", ".".join("%x" % one for one in own.bytes))
    qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10), identity)
    reads, writes = (requests, replies) if serving else (replies, requests)
    reader = DataReader(participant, reads, qos=qos)
    writer = DataWriter(participant, writes, qos=qos)
    return reader, writer, struct.unpack("<Q", own.bytes[:8])[0]


def service(key, name, type_name):
    reader, writer, _ = both_ways(name, type_name, True)
    endpoint = endpoints[key] = Endpoint(reader, type_name)
    endpoint.writer = writer
    answered = SERVICES[type_name][1]

    def serve(asked):
        # The request may come before Cyclone knows who hears the reply; its rmw waits for that likewise.
        end = time.monotonic() + 5
        while not writer.get_matched_subscriptions() and time.monotonic() < end:
            time.sleep(0.001)
        fields = response(type_name, asked)
        writer.write(answered(client=asked.client, number=asked.number, **fields))

    taking(endpoint, serve)


def client(key, name, type_name):
    reader, writer, own = both_ways(name, type_name, False)
    endpoint = endpoints[key] = Endpoint(reader, type_name)
    endpoint.writer, endpoint.own, endpoint.last, endpoint.answers = writer, own, 0, {}

    def hear(answer):
        if answer.client == own:
            endpoint.answers[answer.number] = answer

    taking(endpoint, hear)


def ready(key):
    endpoint = endpoints[key]
    return bool(endpoint.writer.get_matched_subscriptions() and endpoint.entity.get_matched_publications())


def call(key, first, count, size, timeout):
    endpoint = endpoints[key]
    kind = SERVICES[endpoint.type_name][0]
    numbers = []
    for i in range(first, first + count):
        endpoint.last += 1
        fields = build(request(endpoint.type_name, i, size), make, list)
        if endpoint.type_name == "std_srvs/srv/Trigger":
            fields = {"structure_needs_at_least_one_member": 0}
        endpoint.writer.write(kind(client=endpoint.own, number=endpoint.last, **fields))
        numbers.append((i, endpoint.last))
    end = time.monotonic() + timeout
    wrong = []
    for i, number in numbers:
        while number not in endpoint.answers and time.monotonic() < end:
            time.sleep(0.002)
        answer = endpoint.answers.pop(number, None)
        if answer is None:
            wrong.append("%d: timeout" % i)
        else:
            wrong += differences(expected(endpoint.type_name, i, size), answer, str(i))
    return wrong


def graph(gid_size):
    """Take part in ros_discovery_info, with gids of that many octets."""
    # Without keys all participants are one instance: of depth 1 the last one told would be all that is heard.
    deep = profile({**KEPT, "depth": 100})
    qos = Qos(Policy.Userdata(HASH.encode() if gid_size == 16 else b""), base=deep)
    told = Topic(participant, "ros_discovery_info", GRAPHS[gid_size][2])
    endpoints["graph"] = Endpoint(DataWriter(participant, told, qos=qos), gid_size)
    reader = Endpoint(DataReader(participant, told, qos=qos), gid_size)

    def hear(one):
        nodes[bytes(one.gid.data)] = [
            [node.node_namespace.rstrip("/") + "/" + node.node_name, len(node.readers), len(node.writers)]
            for node in one.nodes
        ]

    taking(reader, hear)


def tell_node(namespace, name, keys):
    """That a node has these publishers, and nothing else; without a name, that there is none."""
    writer = endpoints["graph"]
    gid, node, info = GRAPHS[writer.type_name]

    def gid_of(entity):
        return gid(data=list(entity.get_guid().bytes.ljust(writer.type_name, b"\0")))

    found = [node(namespace, name, [], [gid_of(endpoints[key].entity) for key in keys])] if name else []
    writer.entity.write(info(gid=gid_of(participant), nodes=found))


def participants():
    """The guids of participants that Cyclone knows of, its own included."""
    return {
        one.key.bytes
        for one in known.read(1000)
        if one.sample_info.valid_data and one.sample_info.instance_state == 16
    }


def listed():
    """The nodes of participants that are there: as an rmw does, those of one that has left are forgotten."""
    there = participants()
    return sorted(one[0] for gid, found in nodes.items() if gid[:16] in there for one in found)


def begin():
    global participant, known
    participant = DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID", "0")))
    known = BuiltinDataReader(participant, BuiltinTopicDcpsParticipant)


def mortal(name):
    """As in roslet_ros2.py."""
    begin()
    qos = profile({})
    reader = DataReader(participant, Topic(participant, "rt/to", UInt32), qos=qos)
    writer = DataWriter(participant, Topic(participant, "rt/from", String), qos=qos)
    while True:
        for one in reader.take(100):
            if one.sample_info.valid_data:
                writer.write(String(data="%d" % os.getpid()))
        time.sleep(0.01)


COMMANDS = {
    "publisher": publisher,
    "subscription": subscription,
    "publish": publish,
    "assert_liveliness": lambda key: None,
    "heard": lambda key: inboxes[key].told(),
    "last": lambda key: inboxes[key].numbers[-1:],
    "events": lambda key: facts[key],
    "matched": matched,
    "close": close,
    "graph": graph,
    "tell_node": tell_node,
    "nodes": listed,
    "keyed": keyed,
    "hear_keyed": hear_keyed,
    "heard_keyed": lambda key: inboxes[key],
    "write_keyed": write_keyed,
    "dispose_keyed": dispose_keyed,
    "unregister_keyed": unregister_keyed,
    "service": service,
    "client": client,
    "ready": ready,
    "call": call,
    "participants": lambda: len(participants()),
    "process": process,
    "mortal": lambda name: fork(lambda: mortal(name)),
    "kill": kill,
}

if len(sys.argv) > 1:
    begin()
run(COMMANDS)
os._exit(0)  # whatever threads of the middleware are doing
