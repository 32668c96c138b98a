"""`roslet doctor` on ROS 2: this host, this network, and who is there."""

from __future__ import annotations

import os
from collections import Counter
from typing import TYPE_CHECKING

from roslet.cli.doctor import FINE, INFO, PROBLEM, WARNING, Finding
from roslet.cli.ros2.graph import Ros2Graph, full_name, mismatches
from roslet.cli.ros2.multicast import Listener, has_route, hears_itself
from roslet.cli.ros2.nodes import vendor_name
from roslet.engine.ros2.context import is_old
from roslet.errors import InvalidName, Unreachable
from roslet.io.domain import GROUP
from roslet.io.interfaces import choose, interfaces, require
from roslet.io.udp import MAX_PARTICIPANT_ID, UNICAST_IDS
from roslet.names import LOCALHOST, OFF, SUBNET, SYSTEM_DEFAULT, TOPIC, parse_ros2_network
from roslet.wire import discovery_info
from roslet.wire.rtps import locator

if TYPE_CHECKING:
    from collections.abc import Mapping

    from roslet.engine.rtps.spdp import RemoteParticipant
    from roslet.io.interfaces import Interface
    from roslet.names import Ros2Network
    from roslet.wire.rtps.endpoint_data import EndpointData

_VARIABLES = (
    "ROSLET_NETWORK",
    "ROS_DOMAIN_ID",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_STATIC_PEERS",
    "ROS_LOCALHOST_ONLY",
    "RMW_IMPLEMENTATION",
    "ROS_SECURITY_ENABLE",
    "FASTDDS_BUILTIN_TRANSPORTS",
    "FASTRTPS_DEFAULT_PROFILES_FILE",
    "FASTDDS_DEFAULT_PROFILES_FILE",
    "ROS_DISCOVERY_SERVER",
    "CYCLONEDDS_URI",
)
# Of the domains whose ports Linux does not also give to whoever wants any port: from 32768 on it does.
LAST_QUIET_DOMAIN = 101

_POLICY_REMEDIES = {
    "reliability": "let the publisher be reliable, or the subscription best_effort",
    "durability": "let the publisher be transient_local, or the subscription volatile",
    "deadline": "let the publisher's deadline be no longer than the subscription's",
    "liveliness": "let the publisher's liveliness and lease be at least as strict as the subscription's",
    "partition": "let them share a partition",
    "representation": "let the subscription take the publisher's data representation",
    "ownership": "let both ends have the same ownership",
    "latency_budget": "let the publisher's latency budget be no longer than the subscription's",
}


def examine(url: str, seconds: float) -> list[Finding]:
    """Every finding, in the order in which one thing needs the other."""
    found = environment(os.environ)
    try:
        network = parse_ros2_network(url, dict(os.environ))
        there = interfaces()
        require(there, network.interfaces)
    except (InvalidName, Unreachable) as error:
        found.append(Finding("network", PROBLEM, str(error), "mend the URL or the variable"))
        return found
    found.append(Finding("network", INFO, f"{network.url}, discovery range {network.range}"))
    found += _range(network)
    if network.line is not None:
        return found + _on_a_line(network, seconds)
    chosen = choose(there, network.interfaces)
    found += _interfaces(chosen, network)
    found += _ports(network.domain_id)
    if not chosen:
        return found
    if network.range in (SUBNET, SYSTEM_DEFAULT):
        for one in chosen:
            if one.multicast:
                found.append(_multicast(one.name, one.number, one.address))
        if not has_route():
            found.append(
                Finding(
                    "multicast",
                    WARNING,
                    f"there is no route for {GROUP}: programs that leave the interface to the system cannot send to it",
                    f"ip route add 239.0.0.0/8 dev {chosen[0].name}",
                )
            )
    with Listener(network.domain_id, chosen) as listener, Ros2Graph(network.url, "doctor") as graph:
        graph.pause(seconds)
        heard = listener.heard()
        with graph.node.reactor.lock:
            remotes = list(graph.net.shell.participant.spdp.remotes.values())
            counters = dict(graph.net.shell.participant.counters)
        found += _participants(graph, remotes)
        if network.range in (SUBNET, SYSTEM_DEFAULT):
            found += _reach(remotes, heard, seconds)
        found += _dropped(counters)
        found += _graph(graph)
    return found


def _on_a_line(network: Ros2Network, seconds: float) -> list[Finding]:
    """What there is on a serial line; nothing of this host's interfaces matters there."""
    try:
        with Ros2Graph(network.url, "doctor") as graph:
            graph.pause(seconds)
            with graph.node.reactor.lock:
                remotes = list(graph.net.shell.participant.spdp.remotes.values())
                counters = dict(graph.net.shell.participant.counters)
            return [*_participants(graph, remotes), *_dropped(counters), *_graph(graph)]
    except Unreachable as error:
        return [Finding("network", PROBLEM, str(error), "connect the device, or end what else has it open")]


def environment(variables: Mapping[str, str]) -> list[Finding]:
    """What the environment says, and where it contradicts itself."""
    there = [f"{name}={variables[name]}" for name in _VARIABLES if variables.get(name)]
    found = [Finding("environment", INFO, " ".join(there) or "no variable of ROS 2 is set")]

    def add(level: str, text: str, remedy: str) -> None:
        found.append(Finding("environment", level, text, remedy))

    reach = variables.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "")
    if variables.get("ROS_LOCALHOST_ONLY") == "1":
        for name in ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS"):
            if variables.get(name):
                add(
                    WARNING,
                    f"{name} is set, and ROS_LOCALHOST_ONLY=1 puts it out of force",
                    "unset ROS_LOCALHOST_ONLY, which is the older of the two",
                )
    elif variables.get("ROS_STATIC_PEERS") and reach in (OFF, SYSTEM_DEFAULT):
        add(
            WARNING,
            f"ROS_STATIC_PEERS is set, and the discovery range {reach} uses none",
            "set ROS_AUTOMATIC_DISCOVERY_RANGE to SUBNET or LOCALHOST",
        )
    if "zenoh" in variables.get("RMW_IMPLEMENTATION", ""):
        add(
            PROBLEM,
            "programs started here use Zenoh, which neither roslet nor any DDS hears",
            "set RMW_IMPLEMENTATION to rmw_fastrtps_cpp or rmw_cyclonedds_cpp",
        )
    if variables.get("ROS_SECURITY_ENABLE", "").lower() == "true":
        add(
            WARNING,
            "programs started here use DDS security, which roslet does not speak",
            "unset ROS_SECURITY_ENABLE",
        )
    if variables.get("FASTDDS_BUILTIN_TRANSPORTS", "").upper() in ("SHM", "TCPV4", "TCPV6", "UDPV6"):
        add(
            PROBLEM,
            "programs started here that use Fast DDS do not speak UDP over IPv4",
            "set FASTDDS_BUILTIN_TRANSPORTS to UDPv4 or DEFAULT",
        )
    if variables.get("ROS_DISCOVERY_SERVER"):
        add(
            WARNING,
            "programs started here that use Fast DDS ask a discovery server, which roslet does not",
            "unset ROS_DISCOVERY_SERVER",
        )
    return found


def _range(network: Ros2Network) -> list[Finding]:
    if network.range == OFF:
        text, remedy = "nobody is looked for, and nobody taken", "set ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET"
        return [Finding("network", PROBLEM, text, remedy)]
    if network.range == LOCALHOST:
        text = "participants of other hosts are found only as static peers"
        return [
            Finding("network", WARNING, text, "set ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET to find them all")
        ]
    return []


def _interfaces(chosen: list[Interface], network: Ros2Network) -> list[Finding]:
    if not chosen:
        return [
            Finding(
                "interfaces",
                PROBLEM,
                "no interface with an IPv4 address is up",
                "ip link set lo up, or connect the host to a network",
            )
        ]
    found = [
        Finding(
            "interfaces",
            FINE,
            f"{one.name} {one.address}/{one.bits}{'' if one.multicast else ', no multicast'}",
        )
        for one in chosen
    ]
    if all(one.loopback for one in chosen) and network.range != LOCALHOST:
        found.append(
            Finding(
                "interfaces",
                WARNING,
                "there is nothing but loopback: nobody on another host is reached",
                "connect the host to a network, if others are to be reached",
            )
        )
    for one in chosen:
        if not one.multicast and network.range != LOCALHOST:
            found.append(
                Finding(
                    "interfaces",
                    WARNING,
                    f"{one.name} has multicast switched off",
                    f"ip link set {one.name} multicast on, or name the others in $ROS_STATIC_PEERS",
                )
            )
    return found


def _ports(domain: int) -> list[Finding]:
    import socket

    taken = []
    for number in range(MAX_PARTICIPANT_ID + 1):
        port = locator.metatraffic_unicast_port(domain, number)
        if port > 65535:
            break
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", port))
            except OSError:
                taken.append(number)
    first = locator.metatraffic_multicast_port(domain)
    text = f"domain {domain} has ports from {first} on; {len(taken)} participants of this host hold theirs"
    if len(taken) > MAX_PARTICIPANT_ID:
        return [Finding("ports", PROBLEM, text, "end some, or use another domain")]
    found = [Finding("ports", FINE, text)]
    if taken and taken[-1] >= UNICAST_IDS:
        found.append(
            Finding(
                "ports",
                WARNING,
                f"participants beyond number {UNICAST_IDS - 1} are not found by those who look for them without multicast",
                "spread the nodes over fewer processes, or name peers with their port",
            )
        )
    if domain > LAST_QUIET_DOMAIN:
        found.append(
            Finding(
                "ports",
                WARNING,
                f"ports from {first} on are among those that Linux gives to whoever asks for any",
                f"use a domain up to {LAST_QUIET_DOMAIN}",
            )
        )
    return found


def _multicast(name: str, number: int, address: str) -> Finding:
    problem = hears_itself(number, address)
    if not problem:
        return Finding("multicast", FINE, f"{name} ({address}) sends to {GROUP} and hears itself")
    return Finding(
        "multicast",
        PROBLEM,
        f"{name} ({address}): {problem}",
        f"let the firewall pass UDP to {GROUP}; ip link set {name} multicast on; or name the others in $ROS_STATIC_PEERS",
    )


def _participants(graph: Ros2Graph, remotes: list[RemoteParticipant]) -> list[Finding]:
    if not remotes:
        return [
            Finding(
                "participants",
                WARNING,
                "nobody else is seen",
                "let the others use the same ROS_DOMAIN_ID and ROS_AUTOMATIC_DISCOVERY_RANGE; beyond a router, name them in "
                "$ROS_STATIC_PEERS",
            )
        ]
    names: dict[bytes, list[str]] = {}
    for one in graph.node_infos():
        names.setdefault(one.participant, []).append(one.full_name)
    old = {one.guid[:12] for one in _discovery_writers(graph) if is_old(one)}
    found = []
    for remote in sorted(remotes, key=lambda one: (one.host, one.data.guid_prefix)):
        data = remote.data
        nodes = names.get(data.guid_prefix)
        lease = "never expires" if remote.lease is None else f"lease {remote.lease:g} s"
        text = (
            f"{remote.host}: {vendor_name(data.vendor_id)}, RTPS {data.version[0]}.{data.version[1]}, {lease}, "
            f"{', '.join(nodes) if nodes else 'no node of ROS'}"
        )
        if data.guid_prefix in old:
            text += " (Humble or older)"
        if data.version[0] != 2:
            remedy = "use an implementation of RTPS 2"
            found.append(Finding("participants", PROBLEM, f"{text}: another protocol", remedy))
        else:
            found.append(Finding("participants", FINE, text))
    return found


def _discovery_writers(graph: Ros2Graph) -> list[EndpointData]:
    with graph.node.reactor.lock:
        return [
            one for one in graph.net.graph.endpoint_data() if one.topic == discovery_info.TOPIC and one.writer
        ]


def _reach(remotes: list[RemoteParticipant], heard: set[bytes], seconds: float) -> list[Finding]:
    """Whether multicast comes in, from those who are there."""
    silent = [one for one in remotes if one.data.guid_prefix not in heard]
    if not remotes:
        return []
    if not silent:
        return [Finding("multicast", FINE, f"announcements of all {len(remotes)} participants come in")]
    hosts = ", ".join(sorted({one.host for one in silent}))
    return [
        Finding(
            "multicast",
            WARNING,
            f"{len(silent)} of {len(remotes)} participants ({hosts}) are known by unicast alone: no announcement of "
            f"theirs came by multicast within {seconds:g} s",
            "look for a firewall, a switch that snoops IGMP without a querier, or their discovery range; listen longer "
            "with --for",
        )
    ]


def _dropped(counters: dict[str, int]) -> list[Finding]:
    """What the participant threw away, and why; some at the start of every acquaintance."""
    if not counters:
        return []
    text = ", ".join(f"{value} {key}" for key, value in sorted(counters.items()))
    return [Finding("traffic", INFO, f"dropped of what came: {text}")]


def _graph(graph: Ros2Graph) -> list[Finding]:
    """What in the graph does not go together."""
    found = []
    endpoints = [one for one in graph.endpoints() if one.channel]
    for writer, reader, policies in mismatches(endpoints):
        remedies = [_POLICY_REMEDIES.get(name, f"let {name} of both ends agree") for name in policies]
        found.append(
            Finding(
                f"topic {writer.name}" if writer.channel == TOPIC else f"service {writer.name}",
                PROBLEM,
                f"{full_name(reader)} hears nothing of {full_name(writer)}: QoS {', '.join(policies)}",
                "; ".join(remedies),
            )
        )
    found += _types(graph)
    counts = Counter(one.full_name for one in graph.node_infos())
    for name, count in sorted(counts.items()):
        if count > 1:
            found.append(
                Finding(
                    f"node {name}",
                    WARNING,
                    f"{count} nodes have this name: their parameters and services answer for each other",
                    "start all but one with another name: --ros-args -r __node:=NAME",
                )
            )
    if not found:
        found.append(
            Finding(
                "graph", FINE, f"{len(graph.nodes())} nodes, {len(graph.topics())} topics: all go together"
            )
        )
    return found


def _types(graph: Ros2Graph) -> list[Finding]:
    found = []
    # A service's requests and responses are channels of their own, with hashes of their own.
    by_name: dict[tuple[str, str], dict[str, set[tuple[str, str]]]] = {}
    for one in graph.endpoints():
        if one.channel:
            types = by_name.setdefault((one.channel, one.name), {})
            types.setdefault(one.type_name, set()).add((one.type_hash, full_name(one)))
    for (channel, name), types in sorted(by_name.items()):
        about = f"{'topic' if channel == TOPIC else 'service'} {name}"
        if len(types) > 1:
            who = "; ".join(
                f"{kind} of {', '.join(sorted({node for _, node in ends}))}"
                for kind, ends in sorted(types.items())
            )
            found.append(
                Finding(
                    about,
                    PROBLEM,
                    f"it has several types: {who}",
                    "rename one of them, or let all use one type",
                )
            )
        for kind, ends in sorted(types.items()):
            hashes = {text for text, _ in ends if text}
            if len(hashes) > 1:
                who = "; ".join(f"{node} has {text[:19]}..." for text, node in sorted(ends) if text)
                found.append(
                    Finding(
                        about,
                        PROBLEM,
                        f"{kind} is not the same everywhere: {who}",
                        "build all of them with the same definition",
                    )
                )
    return found
