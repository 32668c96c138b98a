"""`roslet node`."""

from __future__ import annotations

import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from roslet.cli.graph import Graph
from roslet.cli.options import UNREACHABLE, CommandError, Group, count, full_name, positive
from roslet.cli.output import emit_json, json_text, note, seconds_text, section, table
from roslet.errors import CallTimeout, ProtocolError, RemoteError, Unreachable

if TYPE_CHECKING:
    import argparse


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    group = Group(parser)

    list_ = group.command(
        "list", run_list, "list nodes", "roslet node list\nroslet node list --names", "network json"
    )
    list_.add_argument("namespace", nargs="?", default="/", metavar="NAMESPACE", help="those below it only")
    list_.add_argument("-q", "--names", action="store_true", help="names only, one a line")

    info = group.command(
        "info",
        run_info,
        "show a node's topics, services and connections",
        "roslet node info /talker",
        "network json",
    )
    info.add_argument("node", metavar="NODE")

    ping = group.command(
        "ping",
        run_ping,
        "measure how fast nodes answer",
        "roslet node ping /talker -n 4\nroslet node ping --all -n 1",
        "network json",
    )
    ping.add_argument("nodes", nargs="*", metavar="NODE")
    ping.add_argument("-a", "--all", action="store_true", help="every node that the master knows")
    ping.add_argument("-n", "--count", type=count, metavar="COUNT", help="stop after COUNT rounds")
    ping.add_argument(
        "--every", type=positive, default=1.0, metavar="SECONDS", help="between two rounds (default 1)"
    )

    kill = group.command(
        "kill",
        run_kill,
        "ask nodes to end",
        "roslet node kill /talker\nroslet node kill --all",
        "network json",
    )
    kill.add_argument("nodes", nargs="*", metavar="NODE")
    kill.add_argument("-a", "--all", action="store_true", help="every node but /rosout")


def run_list(arguments: argparse.Namespace) -> int:
    """`roslet node list`."""
    namespace = full_name(arguments.namespace).rstrip("/") + "/"
    with Graph(arguments.network) as graph:
        rows = []
        for node in graph.nodes():
            if node.startswith(namespace):
                parts = (graph.publishers, graph.subscribers, graph.services)
                rows.append((node, *(sum(node in nodes for nodes in part.values()) for part in parts)))
    if arguments.json:
        keys = ("node", "publishes", "subscribes", "services")
        emit_json([dict(zip(keys, row, strict=True)) for row in rows])
        return 0
    if arguments.names:
        for row in rows:
            print(row[0])
    else:
        table(("NODE", "PUBLISHES", "SUBSCRIBES", "SERVICES"), rows)
    if not rows:
        note("no nodes" if namespace == "/" else f"no nodes below {namespace}")
    return 0


def _uri(graph: Graph, name: str) -> str:
    uri = graph.lookup_node(name)
    if uri is None:
        raise CommandError(f"the master knows no node {name}")
    return uri


def run_info(arguments: argparse.Namespace) -> int:
    """`roslet node info`. What the master knows is shown even where the node does not answer; then exit code 3."""
    name = full_name(arguments.node)
    problem = ""
    with Graph(arguments.network) as graph:
        uri = _uri(graph, name)
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
    if arguments.json:
        emit_json(described)
    else:
        _print_info(described)
    if problem:
        raise CommandError(f"the node does not answer: {problem}", UNREACHABLE)
    return 0


def _topics(graph: Graph, part: dict[str, list[str]], node: str) -> list[dict[str, str]]:
    return [
        {"topic": topic, "type": graph.types.get(topic, "*")} for topic in sorted(part) if node in part[topic]
    ]


def _connections(graph: Graph, rows: Any) -> list[dict[str, Any]]:
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


def _print_info(described: dict[str, Any]) -> None:
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


def run_ping(arguments: argparse.Namespace) -> int:
    """`roslet node ping`. The exit code is 3 where a node did not answer."""
    if bool(arguments.nodes) == arguments.all:
        raise CommandError("name the nodes, or give --all", 2)
    results: dict[str, list[float]] = {}
    lost: dict[str, int] = {}
    with Graph(arguments.network) as graph:
        nodes = graph.nodes() if arguments.all else [full_name(node) for node in arguments.nodes]
        uris = {node: _uri(graph, node) for node in nodes}
        try:
            done = 0
            while True:
                for node, uri in uris.items():
                    _ping(graph, node, uri, results.setdefault(node, []), lost, arguments.json)
                done += 1
                if done == arguments.count:
                    break
                time.sleep(arguments.every)
        finally:
            if not arguments.json:
                _print_pings(results, lost)
    if lost:
        raise CommandError(f"no answer from {', '.join(sorted(lost))}", UNREACHABLE)
    return 0


def _ping(graph: Graph, node: str, uri: str, times: list[float], lost: dict[str, int], as_json: bool) -> None:
    begin = time.perf_counter()
    try:
        graph.node(uri, "getPid")
    except (Unreachable, CallTimeout, RemoteError, ProtocolError) as error:
        lost[node] = lost.get(node, 0) + 1
        if as_json:
            print(json_text({"node": node, "uri": uri, "seconds": None, "error": str(error)}), flush=True)
        else:
            print(f"{node}  {uri}  no answer: {error}", flush=True)
        return
    took = time.perf_counter() - begin
    times.append(took)
    if as_json:
        print(json_text({"node": node, "uri": uri, "seconds": took}), flush=True)
    else:
        print(f"{node}  {uri}  {seconds_text(took)}", flush=True)


def _print_pings(results: dict[str, list[float]], lost: dict[str, int]) -> None:
    print()
    table(
        ("NODE", "ANSWERED", "LOST", "FASTEST", "MEAN", "SLOWEST"),
        [
            (
                node,
                len(times),
                lost.get(node, 0),
                seconds_text(min(times)) if times else "-",
                seconds_text(sum(times) / len(times)) if times else "-",
                seconds_text(max(times)) if times else "-",
            )
            for node, times in results.items()
        ],
    )


def run_kill(arguments: argparse.Namespace) -> int:
    """`roslet node kill`. The exit code is 3 where a node could not be asked."""
    if bool(arguments.nodes) == arguments.all:
        raise CommandError("name the nodes, or give --all", 2)
    failed: dict[str, str] = {}
    ended = []
    with Graph(arguments.network) as graph:
        if arguments.all:
            nodes = [node for node in graph.nodes() if node != "/rosout"]
        else:
            nodes = [full_name(node) for node in arguments.nodes]
        uris = {node: _uri(graph, node) for node in nodes}
        for node, uri in uris.items():
            try:
                graph.node(uri, "getPid")
                with suppress(Unreachable):  # it answered a moment ago, and may end before it answers this
                    graph.node(uri, "shutdown", "roslet node kill")
                ended.append(node)
            except (Unreachable, CallTimeout, RemoteError, ProtocolError) as error:
                failed[node] = str(error)
    if arguments.json:
        emit_json({"asked": ended, "failed": failed})
    else:
        for node in ended:
            print(f"asked {node} to end")
        if not uris:
            note("no nodes")
    if failed:
        text = "; ".join(f"{node}: {problem}" for node, problem in failed.items())
        raise CommandError(f"not asked: {text}", UNREACHABLE)
    return 0
