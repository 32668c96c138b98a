"""Discovery of many ROS 2 nodes, in virtual time: what it costs in packets, bytes, seconds and memory.

A node here is a participant with the endpoints that every ROS 2 node has in its smallest form: `ros_discovery_info` both
ways, /rosout, /parameter_events, and one topic each way. Everyone reads everyone's `ros_discovery_info`, so discovery is
complete when everyone has all endpoints and all of those samples.
"""

from __future__ import annotations

import gc
import sys
import time
import types
from typing import NamedTuple

from engine.rtps.network import Host, Network
from roslet.wire.rtps import qos
from roslet.wire.rtps.qos import Qos

RELIABLE = Qos((qos.RELIABLE, 10**8), history=(qos.KEEP_LAST, 10))
LATCHED = Qos((qos.RELIABLE, 10**8), qos.TRANSIENT_LOCAL, (qos.KEEP_LAST, 1))
ENDPOINTS = 6
# ParticipantEntitiesInfo of one node with these endpoints takes about this many octets.
GRAPH_SAMPLE = bytes((0, 1, 0, 0)) + bytes(220)
STEADY = 30.0


class Cost(NamedTuple):
    """What discovery cost. Packets and bytes are those sent, a multicast packet once, by all nodes together until it was
    complete and acknowledged; `seconds` are virtual; `cpu` is this machine's, and `held` octets of memory, for one node;
    `steady_` is a second of all nodes together, afterwards."""

    nodes: int
    packets: int
    received: int
    bytes: int
    seconds: float
    steady_packets: float
    steady_bytes: float
    cpu: float
    held: int
    counters: dict[str, int]


def add_node(network: Network) -> Host:
    """One more node, whose topic is read by the next."""
    host = network.host()
    number, now, participant = host.number, network.now, host.participant
    graph = "ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"
    participant.create_reader(*graph, LATCHED, now)
    info = participant.create_writer(*graph, LATCHED, now)
    participant.create_writer("rt/rosout", "rcl_interfaces::msg::dds_::Log_", LATCHED, now)
    participant.create_writer(
        "rt/parameter_events", "rcl_interfaces::msg::dds_::ParameterEvent_", RELIABLE, now
    )
    text = "std_msgs::msg::dds_::String_"
    participant.create_writer("rt/topic_%d" % number, text, RELIABLE, now)
    participant.create_reader("rt/topic_%d" % (number - 1), text, RELIABLE, now)
    info.write(GRAPH_SAMPLE, now)
    return host


def complete(network: Network) -> bool:
    """Whether everyone knows everyone, with all endpoints, and all samples of the graph were acknowledged."""
    others = len(network.hosts) - 1
    for host in network.hosts:
        participant = host.participant
        if len(participant.spdp.remotes) < others or len(participant.endpoints) < ENDPOINTS * others:
            return False
        writers = [*participant.writers.values(), *participant.sedp.writers.values()]
        if not all(writer.acknowledged(writer.last) for writer in writers):
            return False
        graph = [one for one in participant.readers.values() if one.data.topic == "ros_discovery_info"]
        if len(graph[0].proxies) < others:
            return False
    return True


def held(participant: object) -> int:
    """Octets of all that hangs on a participant, code and constants apart."""
    seen: set[int] = set()
    waiting = [participant]
    total = 0
    while waiting:
        one = waiting.pop()
        if id(one) in seen or isinstance(one, type | types.ModuleType | types.FunctionType | types.CodeType):
            continue
        seen.add(id(one))
        total += sys.getsizeof(one)
        waiting += gc.get_referents(one)
    return total


def measure(nodes: int, loss: float = 0.0, spread: float = 0.0, steady: float = STEADY) -> Cost:
    """Start `nodes` at once, or evenly over `spread` seconds, and watch."""
    network = Network(5, loss)
    network.deaf = True
    network.max_steps = 10**9
    begin = time.process_time()
    for _ in range(nodes):
        add_node(network)
        if spread:
            network.run(spread / nodes)
    started = network.now
    while not complete(network):
        if network.now > started + 120:
            raise AssertionError(f"{nodes} nodes do not meet")
        # In steps: to look is dear.
        network.run(0.002 if network.now < started + 0.02 else 0.02)
    seconds = network.now - started
    packets, size, received = network.sent, network.bytes, network.received
    cpu = (time.process_time() - begin) / nodes
    network.run(steady)
    counters: dict[str, int] = {}
    for host in network.hosts:
        for reason, count in host.participant.counters.items():
            counters[reason] = counters.get(reason, 0) + count
    return Cost(
        nodes,
        packets,
        received,
        size,
        seconds,
        (network.sent - packets) / steady,
        (network.bytes - size) / steady,
        cpu,
        held(network.hosts[0].participant),
        counters,
    )
