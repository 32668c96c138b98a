"""A node of ROS 1, as the master and the node itself know it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.cli.options import CommandError
from roslet.cli.output import section
from roslet.errors import CallTimeout, ProtocolError, RemoteError, Unreachable

if TYPE_CHECKING:
    from roslet.cli.ros1.graph import Ros1Graph


def uri_of(graph: Ros1Graph, name: str) -> str:
    """Where the slave API of a node is. Raises CommandError where there is no such node."""
    uri = graph.lookup_node(name)
    if uri is None:
        raise CommandError(f"the master knows no node {name}")
    return uri


def describe(graph: Ros1Graph, name: str) -> tuple[dict[str, Any], str]:
    """See `Graph.node_info`."""
    uri = uri_of(graph, name)
    problem = ""
    described: dict[str, Any] = {
        "node": name,
        "uri": uri,
        "pid": None,
        "publishes": _topics(graph, graph.publishers, name),
        "subscribes": _topics(graph, graph.subscribers, name),
        "services": [service for service in sorted(graph.services) if name in graph.services[service]],
        "connections": [],
    }
    try:
        described["pid"] = graph.node(uri, "getPid")
        described["connections"] = _connections(graph, graph.node(uri, "getBusInfo"))
    except (Unreachable, CallTimeout, RemoteError, ProtocolError) as error:
        problem = str(error)
    return described, problem


def _topics(graph: Ros1Graph, part: dict[str, list[str]], node: str) -> list[dict[str, str]]:
    return [
        {"topic": topic, "type": graph.types.get(topic, "*")} for topic in sorted(part) if node in part[topic]
    ]


def _connections(graph: Ros1Graph, rows: Any) -> list[dict[str, Any]]:
    """The rows of getBusInfo: [id, whom, direction, transport, topic, connected, description]; the last are optional.

    A node names those it receives from by the URI of their slave API; the master tells who that is.
    """
    names = {graph.lookup_node(node): node for node in graph.nodes()}
    found = []
    for row in rows if isinstance(rows, list) else []:
        if isinstance(row, list) and len(row) >= 5:
            found.append(
                {
                    "topic": str(row[4]),
                    "direction": {"i": "in", "o": "out", "b": "both"}.get(str(row[2]), str(row[2])),
                    "peer": names.get(str(row[1]), str(row[1])),
                    "transport": str(row[3]),
                    "connected": bool(row[5]) if len(row) > 5 else True,
                }
            )
    return sorted(found, key=lambda row: (row["topic"], row["direction"], row["peer"]))


def print_described(described: dict[str, Any]) -> None:
    """See `Graph.print_node`."""
    print(f"Node: {described['node']}")
    print(f"URI:  {described['uri']}")
    print(f"PID:  {'-' if described['pid'] is None else described['pid']}")
    for title, part in (("Publishes", "publishes"), ("Subscribes", "subscribes")):
        print()
        section(title, [(row["topic"], row["type"]) for row in described[part]])
    print()
    section("Services", [(service,) for service in described["services"]])
    print()
    section(
        "Connections",
        [
            (
                row["topic"],
                {"in": "from", "out": "to"}.get(row["direction"], "with"),
                row["peer"],
                row["transport"],
                "" if row["connected"] else "(connecting)",
            )
            for row in described["connections"]
        ],
    )
