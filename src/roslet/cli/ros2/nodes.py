"""A node of ROS 2, as discovery knows it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.cli.options import CommandError
from roslet.cli.output import note, section
from roslet.cli.ros2.graph import full_name, gid_text, qos_data, qos_text
from roslet.names import REPLY, REQUEST, TOPIC
from roslet.wire.rtps.guid import VENDOR_NAMES

if TYPE_CHECKING:
    from roslet.cli.ros2.graph import Ros2Graph
    from roslet.engine.ros2.graph import EndpointInfo

# What the name of every topic and service of an action has in it.
ACTION = "/_action/"
_SEND_GOAL = ACTION + "send_goal"


def actions_of(endpoints: dict[str, list[EndpointInfo]]) -> dict[str, list[EndpointInfo]]:
    """Of services by name: the actions that they belong to, each with the endpoints of its send_goal."""
    return {name[: -len(_SEND_GOAL)]: found for name, found in endpoints.items() if name.endswith(_SEND_GOAL)}


def action_type(one: EndpointInfo) -> str:
    """The action that a send_goal service belongs to."""
    return one.type_name.removesuffix("_SendGoal")


def describe(graph: Ros2Graph, name: str) -> dict[str, Any]:
    """See `Graph.node_info`."""
    infos = [one for one in graph.node_infos() if one.full_name == name]
    if not infos:
        raise CommandError(f"there is no node {name}")
    if len(infos) > 1:
        note(f"{len(infos)} nodes are called {name}; what follows is of all of them")
    vendor, host = participant_of(graph, infos[0].participant)

    def of(channel: str, writers: bool) -> list[EndpointInfo]:
        found = [
            one for part in graph.of(channel, writers).values() for one in part if full_name(one) == name
        ]
        return sorted(found, key=lambda one: one.name)

    def rows(channel: str, writers: bool, key: str) -> list[dict[str, Any]]:
        return [
            {key: one.name, "type": one.type_name, "qos": qos_data(one.qos)}
            for one in of(channel, writers)
            if ACTION not in one.name
        ]

    def actions(channel: str) -> list[dict[str, Any]]:
        found = actions_of({one.name: [one] for one in of(channel, False)})
        return [{"action": action, "type": action_type(one[0])} for action, one in found.items()]

    return {
        "node": name,
        "enclave": infos[0].enclave,
        "participant": gid_text(infos[0].participant),
        "vendor": vendor,
        "host": host,
        "publishes": rows(TOPIC, True, "topic"),
        "subscribes": rows(TOPIC, False, "topic"),
        "services": rows(REQUEST, False, "service"),
        "clients": rows(REPLY, False, "service"),
        "action_servers": actions(REQUEST),
        "action_clients": actions(REPLY),
    }


def participant_of(graph: Ros2Graph, prefix: bytes) -> tuple[str, str]:
    """Vendor and host of a participant."""
    participant = graph.net.shell.participant
    if prefix == participant.guid_prefix:
        return "roslet", "this process"
    remote = participant.spdp.remotes.get(prefix)
    if remote is None:
        return "unknown", "gone"
    return vendor_name(remote.data.vendor_id), remote.host


def vendor_name(vendor_id: bytes) -> str:
    """Who made an implementation, or its number."""
    return VENDOR_NAMES.get(vendor_id, f"vendor {vendor_id[0]}.{vendor_id[1]}")


def print_described(described: dict[str, Any]) -> None:
    """See `Graph.print_node`."""
    print(f"Node:    {described['node']}")
    print(f"Enclave: {described['enclave'] or '-'}")
    print(f"Vendor:  {described['vendor']}")
    print(f"Host:    {described['host']}")
    for title, part, key in (
        ("Publishes", "publishes", "topic"),
        ("Subscribes", "subscribes", "topic"),
        ("Services", "services", "service"),
        ("Clients", "clients", "service"),
    ):
        print()
        # Services have the same policies everywhere; those of topics decide who hears whom.
        section(
            title,
            [
                (row[key], row["type"], qos_text(row["qos"]) if key == "topic" else "")
                for row in described[part]
            ],
        )
    for title, part in (("Action servers", "action_servers"), ("Action clients", "action_clients")):
        print()
        section(title, [(row["action"], row["type"]) for row in described[part]])
