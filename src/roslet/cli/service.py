"""`roslet service`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.cli.graph import only_type, open_graph
from roslet.cli.options import (
    ALL,
    UNREACHABLE,
    USAGE,
    CommandError,
    Group,
    below,
    full_name,
    load_types,
    positive,
)
from roslet.cli.output import emit_json, note, note_nothing, table

if TYPE_CHECKING:
    import argparse

    from roslet.cli.session import Session


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    group = Group(parser)

    list_ = group.listing(
        run_list, "services", "roslet service list\nroslet service list --types-too /camera"
    )
    list_.add_argument("-a", "--all", action="store_true", help=ALL)
    list_.add_argument(
        "-t",
        "--types-too",
        action="store_true",
        help="types too; on ROS 1 each server is asked (the master does not know)",
    )

    info = group.command(
        "info",
        run_info,
        "show a service's type, node and arguments",
        "roslet service info /add",
        "network types json",
    )
    info.add_argument("service", metavar="SERVICE")

    type_ = group.command(
        "type", run_type, "print a service's type", "roslet service type /add", "network json"
    )
    type_.add_argument("service", metavar="SERVICE")

    find = group.command(
        "find",
        run_find,
        "list the services of a type",
        "roslet service find std_srvs/SetBool",
        "network json",
    )
    find.add_argument("type", metavar="TYPE", help="package/Name or package/srv/Name, on either network")

    call = group.command(
        "call",
        run_call,
        "call a service and print its response",
        "roslet service call /add a:=1 b:=2\nroslet service call /add '{a: 1, b: 2}' --json\n"
        "roslet service call /enable true",
        "network types json",
    )
    call.add_argument("service", metavar="SERVICE")
    call.add_argument(
        "values",
        nargs="*",
        metavar="VALUE",
        help="field.path:=value, a mapping, or the fields' values in order",
    )
    call.add_argument("--type", metavar="TYPE", help="package/Name; default: what the server says")
    call.add_argument(
        "--timeout",
        type=positive,
        default=None,
        metavar="SECONDS",
        help="give up (exit code 3) after so long",
    )
    call.add_argument(
        "--wait",
        type=positive,
        default=None,
        metavar="SECONDS",
        help="wait so long for the service to be there",
    )


def run_list(arguments: argparse.Namespace) -> int:
    """`roslet service list`."""
    namespace = below(arguments.namespace)
    with open_graph(arguments.network) as graph:
        services = graph.services
        names = [
            name
            for name in sorted(services)
            if name.startswith(namespace) and (arguments.all or not graph.hidden(name))
        ]
        rows: list[dict[str, Any]] = []
        for name in names:
            row: dict[str, Any] = {"service": name, "nodes": services[name]}
            if arguments.types_too:
                try:
                    row["type"] = graph.service_type(name)
                except CommandError:
                    row["type"] = None
            rows.append(row)
    if arguments.json:
        emit_json(rows)
    elif arguments.names:
        for name in names:
            print(name)
    elif arguments.types_too:
        table(
            ("SERVICE", "TYPE", "NODE"),
            [(row["service"], row["type"] or "no answer", ", ".join(row["nodes"])) for row in rows],
        )
    else:
        table(("SERVICE", "NODE"), [(row["service"], ", ".join(row["nodes"])) for row in rows])
    if not rows and not arguments.json:
        note_nothing("services", namespace)
    return 0


def run_info(arguments: argparse.Namespace) -> int:
    """`roslet service info`."""
    from roslet.cli.interface import definition_lines
    from roslet.errors import DefinitionError
    from roslet.idl import Registry

    name = full_name(arguments.service)
    with open_graph(arguments.network) as graph:
        described: dict[str, Any] = {
            "service": name,
            **graph.service_info(name),
            "request": None,
            "response": None,
        }
    kind = described["type"]
    registry = Registry(graph.dialect)
    for path in arguments.types:
        registry.load(path)
    try:
        service = registry.service(kind)
        for part, message in (("request", service.request), ("response", service.response)):
            described[part] = list(definition_lines(message, None))
    except DefinitionError:
        pass  # not installed here: the server's answer has a name and a sum, no definition
    if arguments.json:
        emit_json(described)
        return 0
    print(f"Service: {name}")
    print(f"Type:    {kind}")
    for key, title in graph.service_titles:
        value = described[key]
        text = ", ".join(value) or "-" if isinstance(value, list) else value
        print(f"{title + ':':<8} {text}")
    for title, part in (("Request", "request"), ("Response", "response")):
        lines = described[part]
        print()
        if lines is None:
            print(f"{title}: {kind} is not installed here; load it with --types")
        else:
            print(f"{title}: nothing" if not lines else f"{title}:")
            for line in lines:
                print("  " + line)
    return 0


def run_type(arguments: argparse.Namespace) -> int:
    """`roslet service type`."""
    name = full_name(arguments.service)
    with open_graph(arguments.network) as graph:
        kind = graph.service_type(name)
    if arguments.json:
        emit_json({"service": name, "type": kind})
    else:
        print(kind)
    return 0


def run_find(arguments: argparse.Namespace) -> int:
    """`roslet service find`. On ROS 1 every server is asked; one that does not answer is of no type."""
    wanted = arguments.type.replace("/srv/", "/", 1)
    found = []
    with open_graph(arguments.network) as graph:
        for name in sorted(graph.services):
            try:
                kind = graph.service_type(name)
            except CommandError:
                continue
            if wanted in [one.replace("/srv/", "/", 1) for one in kind.split(", ")]:
                found.append(name)
    if arguments.json:
        emit_json(found)
    else:
        for name in found:
            print(name)
        if not found:
            note(f"no services of {arguments.type}")
    return 0


def run_call(arguments: argparse.Namespace) -> int:
    """`roslet service call`."""
    from roslet.cli.render import plain, yaml_lines
    from roslet.cli.session import open_session
    from roslet.cli.values import build
    from roslet.errors import ServiceFailed, UnknownType

    load_types(arguments)
    name = full_name(arguments.service)
    with open_session(arguments, "call") as session:
        graph = session.graph
        if arguments.wait is not None:
            _wait(session, name, arguments.wait)
        kind = arguments.type or only_type(name, graph.service_type(name), "give --type")
        if kind == "*":
            raise CommandError(f"the server of {name} does not say its type; give --type", USAGE)
        from roslet.gen.runtime import service_class

        try:
            service_type = service_class(graph.dialect, kind)
        except UnknownType as error:
            raise CommandError(f"{error}; load it with --types DIR") from None
        node = session.node
        request = build(service_type.Request, arguments.values, node.now)
        try:
            response = node.client(name, service_type).call(request, timeout=arguments.timeout)
        except ServiceFailed as error:
            raise CommandError(f"{name} failed: {error}") from None
    value = plain(response)
    if arguments.json:
        emit_json(value)
    else:
        for line in yaml_lines(value) if value else ():
            print(line)
    return 0


def _wait(session: Session, name: str, seconds: float) -> None:
    import time

    end = time.monotonic() + seconds
    while not session.graph.has_service(name):
        if time.monotonic() >= end:
            raise CommandError(f"there is no service {name} within {seconds:g} s", UNREACHABLE)
        session.pause(0.05)
