"""`roslet interface`: what definitions say, their hashes, their sizes. Needs no network and generates no code."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.cli.options import CommandError, Group
from roslet.errors import DefinitionError, UnknownType
from roslet.idl import ROS1, ROS2, Action, Message, Registry, Service

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator

    from roslet.idl import Dialect, Field, FieldType, Interface

NAMES = {ROS1: "ROS 1", ROS2: "ROS 2"}
_KINDS = {Message: "msg", Service: "srv", Action: "action"}


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    group = Group(parser)

    show = group.command(
        "show",
        run_show,
        "print a definition without its comments",
        "roslet interface show geometry_msgs/Pose\nroslet interface show -r sensor_msgs/msg/Imu\n"
        "roslet interface show --types my_ws/src my_msgs/Foo",
        "types json",
    )
    show.add_argument("type", metavar="TYPE", help="package/Name or package/msg/Name")
    show.add_argument("-r", "--recursive", action="store_true", help="with what nested types are made of")
    _dialect_option(show)

    hash_ = group.command(
        "hash",
        run_hash,
        "print the MD5 sum (ROS 1) and the RIHS01 hash (ROS 2)",
        "roslet interface hash std_msgs/String\nroslet interface hash --dialect ros1 std_srvs/SetBool",
        "types json",
    )
    hash_.add_argument("type", metavar="TYPE", help="package/Name or package/msg/Name")
    _dialect_option(hash_)

    size = group.command(
        "size",
        run_size,
        "print the fixed, or least and greatest, serialised size in each encoding",
        "roslet interface size geometry_msgs/Pose\nroslet interface size std_srvs/SetBool",
        "types json",
    )
    size.add_argument("type", metavar="TYPE", help="package/Name or package/msg/Name")
    _dialect_option(size)

    list_ = group.command(
        "list",
        run_list,
        "list the definitions that can be found",
        "roslet interface list\nroslet interface list geometry_msgs\nroslet interface list --kind srv --names",
        "types json",
    )
    list_.add_argument("package", nargs="?", metavar="PACKAGE", help="of this package only")
    list_.add_argument("--kind", choices=("msg", "srv", "action"), help="of this kind only")
    list_.add_argument("-q", "--names", action="store_true", help="names only, one a line")
    _dialect_option(list_)


def _dialect_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--dialect",
        choices=(ROS1, ROS2),
        help="the definition of this system only; default: where the type is found",
    )


def _registries(arguments: argparse.Namespace) -> dict[Dialect, Registry]:
    dialects: tuple[Dialect, ...] = (arguments.dialect,) if arguments.dialect else (ROS1, ROS2)
    registries = {dialect: Registry(dialect) for dialect in dialects}
    for path in arguments.types:
        problems = []
        for registry in registries.values():
            try:
                registry.load(path)
            except DefinitionError as error:
                problems.append(error)  # a package may have a name that only the other system allows
        if len(problems) == len(registries):
            raise problems[0]
    return registries


def find(registries: dict[Dialect, Registry], name: str) -> dict[Dialect, Interface]:
    """The definitions of `name`, by dialect; the dialect in which the name is spelled comes first.

    A definition that is wrong in one dialect is none of that dialect. Raises DefinitionError where none is right.
    """
    order = sorted(registries, key=lambda dialect: (dialect == ROS1) != (name.count("/") == 1))
    found: dict[Dialect, Interface] = {}
    problems: list[DefinitionError] = []
    for dialect in order:
        try:
            found[dialect] = registries[dialect].interface(name)
        except DefinitionError as error:
            problems.append(error)
    if not found:
        # Something that is wrong in a file says more than that there is no file.
        problems.sort(key=lambda problem: (not problem.file, isinstance(problem, UnknownType)))
        raise problems[0] if problems[0].file else CommandError(f"no definition of {name} found")
    return found


def run_show(arguments: argparse.Namespace) -> int:
    """`roslet interface show`."""
    registries = _registries(arguments)
    dialect, interface = next(iter(find(registries, arguments.type).items()))
    if arguments.json:
        from roslet.cli.output import emit_json

        emit_json(describe(interface, registries[dialect], arguments.recursive))
        return 0
    print(f"# {interface.name.text(dialect)} ({_KINDS[type(interface)]}, {NAMES[dialect]})")
    for at, part in enumerate(parts(interface)):
        if at:
            print("---")
        for line in definition_lines(part, registries[dialect] if arguments.recursive else None):
            print(line)
    return 0


def parts(interface: Interface) -> list[Message]:
    """The messages of which a definition consists, in the order of its file."""
    if isinstance(interface, Service):
        return [interface.request, interface.response]
    if isinstance(interface, Action):
        return [interface.goal, interface.result, interface.feedback]
    return [interface]


def definition_lines(message: Message, nested_in: Registry | None, indent: str = "") -> Iterator[str]:
    """The lines of a definition: constants, then fields; with a registry also what nested types are made of."""
    for constant in message.constants:
        yield f"{indent}{constant.type} {constant.name}={constant_text(constant.value, constant.text)}"
    for field in message.fields:
        default = "" if field.default is None else " " + literal(field.default)
        yield f"{indent}{type_text(field.type, message)} {field.name}{default}"
        if nested_in is not None and field.type.message is not None:
            yield from definition_lines(nested_in.message(field.type.message), nested_in, indent + "  ")


def type_text(kind: FieldType, message: Message) -> str:
    """A field's type, nested ones by their full name."""
    text = str(kind)
    if kind.message is None:
        return text
    return kind.message.text(message.dialect) + text[len(kind.spelled) :]


def constant_text(value: Any, text: str) -> str:
    """A constant's value as its definition may spell it."""
    return text if isinstance(value, str) else literal(value)


def literal(value: Any) -> str:
    """A default value as a definition spells it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return "[" + ", ".join(literal(item) for item in value) + "]"
    if isinstance(value, str):
        import json

        return json.dumps(value, ensure_ascii=False)
    return str(value)


def describe(interface: Interface, registry: Registry, recursive: bool) -> dict[str, Any]:
    """A definition as JSON data."""
    described: dict[str, Any] = {
        "type": interface.name.text(interface.dialect),
        "kind": _KINDS[type(interface)],
        "dialect": interface.dialect,
    }
    if isinstance(interface, Message):
        described.update(_describe_message(interface))
    else:
        names = ("goal", "result", "feedback") if isinstance(interface, Action) else ("request", "response")
        for name, part in zip(names, parts(interface), strict=True):
            described[name] = _describe_message(part)
    if recursive:
        described["nested"] = {
            message.name.text(message.dialect): _describe_message(message)
            for message in registry.dependencies(interface.name)
        }
    return described


def _describe_message(message: Message) -> dict[str, Any]:
    return {
        "constants": [
            {"name": constant.name, "type": str(constant.type), "value": constant.value}
            for constant in message.constants
        ],
        "fields": [_describe_field(field, message) for field in message.fields],
    }


def _describe_field(field: Field, message: Message) -> dict[str, Any]:
    described: dict[str, Any] = {"name": field.name, "type": type_text(field.type, message)}
    if field.default is not None:
        described["default"] = field.default
    return described


def run_hash(arguments: argparse.Namespace) -> int:
    """`roslet interface hash`."""
    from roslet.idl import md5sum, type_hash

    registries = _registries(arguments)
    hashes: dict[Dialect, str] = {}
    for dialect, interface in find(registries, arguments.type).items():
        if dialect == ROS2:
            hashes[dialect] = type_hash(registries[dialect], interface.name)
        elif isinstance(interface, Action):
            for message in interface.messages:
                if message.name.name == interface.name.name + "Action":
                    hashes[dialect] = md5sum(registries[dialect], message.name)
        else:
            hashes[dialect] = md5sum(registries[dialect], interface.name)
    if arguments.json:
        from roslet.cli.output import emit_json

        emit_json({"type": arguments.type, **hashes})
        return 0
    for which in sorted(hashes):
        print(f"{NAMES[which]}  {hashes[which]}" if len(registries) > 1 else hashes[which])
    return 0


def run_size(arguments: argparse.Namespace) -> int:
    """`roslet interface size`. The CDR encapsulation header of 4 bytes is counted, TCPROS' length prefix is not."""
    from roslet.cli.output import emit_json, table

    registries = _registries(arguments)
    rows: list[dict[str, Any]] = []
    found = find(registries, arguments.type)
    for dialect in sorted(found):
        for message in parts(found[dialect]):
            rows.append(_sizes(message, registries[dialect], dialect))
    if arguments.json:
        emit_json(rows)
        return 0

    def cell(value: int | None, absent: str) -> str:
        return absent if value is None else str(value)

    table(
        ("TYPE", "ENCODING", "FIXED", "MIN", "MAX"),
        [
            (
                row["type"],
                "ROS 1" if row["encoding"] == "ros1" else "CDR (ROS 2)",
                cell(row["fixed"], "-"),
                row["minimum"],
                cell(row["maximum"], "unbounded"),
            )
            for row in rows
        ],
    )
    return 0


def _sizes(message: Message, registry: Registry, dialect: Dialect) -> dict[str, Any]:
    from roslet.layout import CDR, layout
    from roslet.layout import ROS1 as ROS1_ENCODING

    encoding = ROS1_ENCODING if dialect == ROS1 else CDR
    found = layout(message, registry.message, encoding)
    header = 0 if dialect == ROS1 else 4
    minimum = found.minimum + header
    maximum = None if found.maximum is None else found.maximum + header
    return {
        "type": message.name.text(dialect),
        "encoding": encoding,
        "fixed": minimum if minimum == maximum else None,
        "minimum": minimum,
        "maximum": maximum,
    }


def run_list(arguments: argparse.Namespace) -> int:
    """`roslet interface list`."""
    from roslet.cli.output import emit_json, table

    where: dict[tuple[str, str, str], list[Dialect]] = {}
    for dialect, registry in _registries(arguments).items():
        for found in registry.names(arguments.kind, arguments.package):
            where.setdefault((found.package, found.kind, found.name), []).append(dialect)
    if not where and arguments.package:
        raise CommandError(f"no definitions of {arguments.package} found")
    rows = [("/".join(key), where[key]) for key in sorted(where)]
    if arguments.json:
        emit_json([{"type": name, "dialects": dialects} for name, dialects in rows])
    elif arguments.names:
        for name, _ in rows:
            print(name)
    else:
        table(("TYPE", "DEFINED FOR"), [(name, ", ".join(NAMES[d] for d in ds)) for name, ds in rows])
    return 0
