"""`roslet node`."""

from __future__ import annotations

import time
from contextlib import suppress
from typing import TYPE_CHECKING

from roslet.cli.graph import open_graph, open_ros1
from roslet.cli.options import ALL, UNREACHABLE, USAGE, CommandError, Group, below, count, full_name, positive
from roslet.cli.output import emit_json, json_text, note, note_nothing, seconds_text, table
from roslet.errors import CallTimeout, ProtocolError, RemoteError, Unreachable

if TYPE_CHECKING:
    import argparse

    from roslet.cli.ros1.graph import Ros1Graph


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    group = Group(parser)

    list_ = group.listing(run_list, "nodes", "roslet node list\nroslet node list --names")
    list_.add_argument("-a", "--all", action="store_true", help=ALL)

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
        "measure how fast nodes answer (ROS 1)",
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
        "ask nodes to end (ROS 1)",
        "roslet node kill /talker\nroslet node kill --all",
        "network json",
    )
    kill.add_argument("nodes", nargs="*", metavar="NODE")
    kill.add_argument("-a", "--all", action="store_true", help="every node but /rosout")


def run_list(arguments: argparse.Namespace) -> int:
    """`roslet node list`."""
    namespace = below(arguments.namespace)
    with open_graph(arguments.network) as graph:
        parts = (graph.publishers, graph.subscribers, graph.services)
        rows = []
        for node in graph.nodes():
            if node.startswith(namespace) and (arguments.all or not graph.hidden(node)):
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
        note_nothing("nodes", namespace)
    return 0


def run_info(arguments: argparse.Namespace) -> int:
    """`roslet node info`. What is known is shown even where the node does not answer; then exit code 3."""
    name = full_name(arguments.node)
    with open_graph(arguments.network) as graph:
        described, problem = graph.node_info(name)
        if arguments.json:
            emit_json(described)
        else:
            graph.print_node(described)
    if problem:
        raise CommandError(f"the node does not answer: {problem}", UNREACHABLE)
    return 0


def run_ping(arguments: argparse.Namespace) -> int:
    """`roslet node ping`. The exit code is 3 where a node did not answer."""
    if bool(arguments.nodes) == arguments.all:
        raise CommandError("name the nodes, or give --all", USAGE)
    results: dict[str, list[float]] = {}
    lost: dict[str, int] = {}
    from roslet.cli.ros1.nodes import uri_of

    with open_ros1(arguments.network, "node ping") as graph:
        nodes = graph.nodes() if arguments.all else [full_name(node) for node in arguments.nodes]
        uris = {node: uri_of(graph, node) for node in nodes}
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


def _ping(
    graph: Ros1Graph, node: str, uri: str, times: list[float], lost: dict[str, int], as_json: bool
) -> None:
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
        raise CommandError("name the nodes, or give --all", USAGE)
    failed: dict[str, str] = {}
    ended = []
    from roslet.cli.ros1.nodes import uri_of

    with open_ros1(arguments.network, "node kill") as graph:
        if arguments.all:
            nodes = [node for node in graph.nodes() if node != "/rosout"]
        else:
            nodes = [full_name(node) for node in arguments.nodes]
        uris = {node: uri_of(graph, node) for node in nodes}
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
