"""`roslet param`: the parameters of the master (ROS 1) or of nodes (ROS 2)."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from roslet.cli.graph import open_graph
from roslet.cli.options import CommandError, Group, below
from roslet.cli.parameters import NotSet

if TYPE_CHECKING:
    import argparse

_VALUE = "a YAML value: 5, 0.5, true, hello, [1, 2], {a: 1}; without PyYAML: a scalar or JSON"
_NODE = "the node whose parameter NAME is; without it NAME is a full name such as /node/name"


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    group = Group(parser)

    list_ = group.command(
        "list",
        run_list,
        "list parameter names",
        "roslet param list\nroslet param list /camera",
        "network json",
    )
    list_.add_argument("namespace", nargs="?", default="/", metavar="NAMESPACE", help="or NODE: its own only")

    describe = group.command(
        "describe",
        run_describe,
        "show the type, the text and the range of parameters (ROS 2)",
        "roslet param describe /camera rate\nroslet param describe /camera",
        "network json",
    )
    describe.add_argument("node", metavar="NODE")
    describe.add_argument("names", nargs="*", metavar="NAME", help="default: all that the node has")

    get = group.command(
        "get",
        run_get,
        "print a parameter, or all below a namespace or of a node",
        "roslet param get /camera/rate\nroslet param get /camera rate\nroslet param get /camera\n"
        "roslet param get /camera/rate --default 10",
        "network json",
    )
    get.add_argument("node", nargs="?", default="", metavar="NODE", help=_NODE)
    get.add_argument("name", metavar="NAME")
    get.add_argument("--default", metavar="VALUE", help="what to print where it is not set; else exit code 1")

    set_ = group.command(
        "set",
        run_set,
        "set a parameter",
        "roslet param set /camera/rate 30\nroslet param set /camera rate 30\n"
        "roslet param set /camera '{rate: 30, name: left}'\n"
        "roslet param set /offset -- -0.5\nroslet param set --string /serial 0042",
        "network",
    )
    set_.add_argument("node", nargs="?", default="", metavar="NODE", help=_NODE)
    set_.add_argument("name", metavar="NAME")
    set_.add_argument("value", metavar="VALUE", help=_VALUE)
    set_.add_argument("--string", action="store_true", help="VALUE is text, whatever it looks like")

    delete = group.command(
        "delete", run_delete, "delete parameters", "roslet param delete /camera/rate", "network"
    )
    delete.add_argument("names", nargs="+", metavar="NAME")
    delete.add_argument("--node", default="", metavar="NODE", help=_NODE)

    dump = group.command(
        "dump",
        run_dump,
        "write parameters to a file",
        "roslet param dump params.yaml\nroslet param dump - /camera\nroslet param dump params.json --json",
        "network json",
    )
    dump.add_argument("file", nargs="?", default="-", metavar="FILE", help="default: standard output")
    dump.add_argument("namespace", nargs="?", default="/", metavar="NAMESPACE", help="or NODE; default: all")
    dump.description = (
        "Write parameters to a file.\n\nYAML where PyYAML is installed, which is extra `cli` of roslet; "
        "otherwise JSON, which every\nYAML reader reads too. --json writes JSON in any case."
    )

    load = group.command(
        "load",
        run_load,
        "set parameters from a file",
        "roslet param load params.yaml\nroslet param load camera.yaml /camera\ncat params.json | roslet param load -",
        "network",
    )
    load.add_argument("file", metavar="FILE", help="- for standard input")
    load.add_argument(
        "namespace",
        nargs="?",
        default="/",
        metavar="NAMESPACE",
        help="or NODE: where to set them",
    )
    load.description = (
        "Set parameters from a file.\n\n"
        "A YAML file needs PyYAML (extra `cli` of roslet); a JSON file does not."
    )


def run_list(arguments: argparse.Namespace) -> int:
    """`roslet param list`: names that `roslet param get` takes, on ROS 2 as NODE NAME."""
    from roslet.cli.output import emit_json, note_nothing

    with open_graph(arguments.network) as graph:
        found = graph.parameters().names(arguments.namespace)
    if arguments.json:
        emit_json([f"{node} {name}".lstrip() for node, name in found])
        return 0
    for node, name in found:
        print(f"{node} {name}".lstrip())
    if not found:
        note_nothing("parameters", below(arguments.namespace))
    return 0


def run_describe(arguments: argparse.Namespace) -> int:
    """`roslet param describe`."""
    from roslet.cli.output import emit_json
    from roslet.cli.render import yaml_lines

    with open_graph(arguments.network) as graph:
        found = graph.parameters().describe(arguments.node, arguments.names)
    if arguments.json:
        emit_json(found)
    else:
        for line in yaml_lines({one.pop("name"): one for one in found}) if found else ():
            print(line)
    return 0


def run_get(arguments: argparse.Namespace) -> int:
    """`roslet param get`."""
    from roslet.cli.output import emit_json
    from roslet.cli.values import read_value

    with open_graph(arguments.network) as graph:
        try:
            value = graph.parameters().get(arguments.node, arguments.name)
        except NotSet:
            if arguments.default is None:
                raise
            value = read_value(arguments.default)
    if arguments.json:
        emit_json(value)
    elif isinstance(value, (dict, list)):
        from roslet.cli.render import yaml_lines

        for line in yaml_lines(value):
            print(line)
    else:
        print(scalar_text(value))
    return 0


def scalar_text(value: Any) -> str:
    """A scalar as a shell script wants it: text without quotes."""
    if value is True or value is False:
        return "true" if value else "false"
    return "" if value is None else str(value)


def run_set(arguments: argparse.Namespace) -> int:
    """`roslet param set`."""
    from roslet.cli.values import read_value

    value = arguments.value if arguments.string else read_value(arguments.value)
    with open_graph(arguments.network) as graph:
        graph.parameters().set(arguments.node, arguments.name, value)
    return 0


def run_delete(arguments: argparse.Namespace) -> int:
    """`roslet param delete`: each name; those that are not set are named and the exit code is 1."""
    with open_graph(arguments.network) as graph:
        missing = graph.parameters().delete(arguments.node, arguments.names)
    if missing:
        raise CommandError(f"not set: {', '.join(missing)}")
    return 0


def run_dump(arguments: argparse.Namespace) -> int:
    """`roslet param dump`."""
    from roslet.cli.values import yaml_module

    with open_graph(arguments.network) as graph:
        value = graph.parameters().dump(arguments.namespace)
    yaml = None if arguments.json else yaml_module()
    if yaml is not None:
        text = str(yaml.safe_dump(value, default_flow_style=False, allow_unicode=True))
        text = text.removesuffix("...\n")  # what PyYAML puts after a bare scalar
    else:
        from roslet.cli.output import json_text

        text = json_text(value, 2) + "\n"
    if arguments.file == "-":
        sys.stdout.write(text)
    else:
        with open(arguments.file, "w", encoding="utf-8") as file:
            file.write(text)
    return 0


def run_load(arguments: argparse.Namespace) -> int:
    """`roslet param load`."""
    from roslet.cli.values import read_document

    if arguments.file == "-":
        text, name = sys.stdin.read(), "standard input"
    else:
        with open(arguments.file, encoding="utf-8") as file:
            text, name = file.read(), arguments.file
    value = read_document(text, name)
    with open_graph(arguments.network) as graph:
        graph.parameters().load(value, arguments.namespace, name)
    return 0
