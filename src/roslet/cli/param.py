"""`roslet param`: the parameter server."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from roslet.cli.graph import Graph
from roslet.cli.options import CommandError, Group, full_name
from roslet.errors import Fault

if TYPE_CHECKING:
    import argparse

_VALUE = "a YAML value: 5, 0.5, true, hello, [1, 2], {a: 1}; without PyYAML: a scalar or JSON"


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
    list_.add_argument("namespace", nargs="?", default="/", metavar="NAMESPACE", help="those below it only")

    get = group.command(
        "get",
        run_get,
        "print a parameter, or all below a namespace",
        "roslet param get /camera/rate\nroslet param get /camera\nroslet param get /camera/rate --default 10",
        "network json",
    )
    get.add_argument("name", metavar="NAME")
    get.add_argument("--default", metavar="VALUE", help="what to print where it is not set; else exit code 1")

    set_ = group.command(
        "set",
        run_set,
        "set a parameter",
        "roslet param set /camera/rate 30\nroslet param set /camera '{rate: 30, name: left}'\n"
        "roslet param set /offset -- -0.5\nroslet param set --string /serial 0042",
        "network",
    )
    set_.add_argument("name", metavar="NAME")
    set_.add_argument("value", metavar="VALUE", help=_VALUE)
    set_.add_argument("--string", action="store_true", help="VALUE is text, whatever it looks like")

    delete = group.command(
        "delete", run_delete, "delete parameters", "roslet param delete /camera/rate", "network"
    )
    delete.add_argument("names", nargs="+", metavar="NAME")

    dump = group.command(
        "dump",
        run_dump,
        "write parameters to a file",
        "roslet param dump params.yaml\nroslet param dump - /camera\nroslet param dump params.json --json",
        "network json",
    )
    dump.add_argument("file", nargs="?", default="-", metavar="FILE", help="default: standard output")
    dump.add_argument(
        "namespace", nargs="?", default="/", metavar="NAMESPACE", help="what to dump; default: all"
    )
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
    load.add_argument("namespace", nargs="?", default="/", metavar="NAMESPACE", help="where to set them")
    load.description = (
        "Set parameters from a file.\n\n"
        "A YAML file needs PyYAML (extra `cli` of roslet); a JSON file does not."
    )


def run_list(arguments: argparse.Namespace) -> int:
    """`roslet param list`."""
    from roslet.cli.output import emit_json, note

    namespace = full_name(arguments.namespace).rstrip("/") + "/"
    with Graph(arguments.network) as graph:
        names = sorted(str(name) for name in graph.master("getParamNames"))
    names = [name for name in names if name.startswith(namespace)]
    if arguments.json:
        emit_json(names)
        return 0
    for name in names:
        print(name)
    if not names:
        note("no parameters" if namespace == "/" else f"no parameters below {namespace}")
    return 0


def get_parameter(graph: Graph, name: str) -> Any:
    """A parameter's value. Raises CommandError where it is not set."""
    try:
        return graph.master("getParam", name)
    except Fault:
        raise CommandError(f"parameter {name} is not set") from None


def run_get(arguments: argparse.Namespace) -> int:
    """`roslet param get`."""
    from roslet.cli.output import emit_json
    from roslet.cli.values import read_value

    with Graph(arguments.network) as graph:
        try:
            value = plain(get_parameter(graph, full_name(arguments.name)))
        except CommandError:
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


def plain(value: Any) -> Any:
    """A parameter with what JSON lacks turned into text."""
    if isinstance(value, dict):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(inner) for inner in value]
    if isinstance(value, (bytes, bytearray)):
        return value.decode("utf-8", "backslashreplace")
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    return str(value)


def run_set(arguments: argparse.Namespace) -> int:
    """`roslet param set`."""
    from roslet.cli.values import read_value

    name = full_name(arguments.name)
    value = arguments.value if arguments.string else read_value(arguments.value)
    with Graph(arguments.network) as graph:
        _set(graph, name, value)
    return 0


def _set(graph: Graph, name: str, value: Any) -> None:
    try:
        graph.master("setParam", name, value)
    except Fault as error:
        raise CommandError(f"the master does not set {name}: {error.message}") from None


def run_delete(arguments: argparse.Namespace) -> int:
    """`roslet param delete`: each name; those that are not set are named and the exit code is 1."""
    missing = []
    with Graph(arguments.network) as graph:
        for name in [full_name(name) for name in arguments.names]:
            try:
                graph.master("deleteParam", name)
            except Fault:
                missing.append(name)
    if missing:
        raise CommandError(f"not set: {', '.join(missing)}")
    return 0


def run_dump(arguments: argparse.Namespace) -> int:
    """`roslet param dump`."""
    from roslet.cli.values import yaml_module

    namespace = full_name(arguments.namespace)
    with Graph(arguments.network) as graph:
        value = plain(get_parameter(graph, namespace))
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
    namespace = full_name(arguments.namespace)
    if not isinstance(value, dict) and namespace == "/":
        raise CommandError(f"{name}: expected names and values, not {type(value).__name__}")
    with Graph(arguments.network) as graph:
        if isinstance(value, dict):
            # One by one: setting a namespace as a whole would delete what the file does not name.
            for key, inner in value.items():
                _set(graph, namespace.rstrip("/") + "/" + str(key).lstrip("/"), inner)
        else:
            _set(graph, namespace, value)
    return 0
