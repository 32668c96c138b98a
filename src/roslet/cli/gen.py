"""`roslet gen`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roslet.cli.options import USAGE, CommandError, Group
from roslet.errors import UnknownType
from roslet.idl import ROS1, ROS2, Registry

if TYPE_CHECKING:
    import argparse

    from roslet.idl import TypeName


def add(parser: argparse.ArgumentParser) -> None:
    """Declare the commands."""
    group = Group(parser)
    python = group.command(
        "python",
        run_python,
        "write message classes as a Python package",
        "roslet gen python my_ws/gen --types my_ws/src\n"
        "roslet gen python out geometry_msgs std_srvs/SetBool --dialect ros1",
        "types json",
    )
    python.description = (
        "Write message classes as a Python package, with type stubs.\n\nroslet makes the same classes at run time, so that "
        "this is needed only where definitions are not:\nunder MicroPython, for editors, in frozen programs. "
        "The package needs roslet.wire. Files that\nwould not change are left alone."
    )
    python.add_argument("directory", metavar="DIR", help="where the package goes; made where it is not there")
    python.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help="a package, or a type such as package/Name, with all it is made of; default: what --types loaded",
    )
    python.add_argument(
        "--dialect",
        choices=(ROS1, ROS2),
        default=ROS1,
        help="the system whose messages they are (default ros1)",
    )


def run_python(arguments: argparse.Namespace) -> int:
    """`roslet gen python`."""
    from roslet.cli.output import emit_json, note
    from roslet.gen.python_package import write_package

    registry = Registry(arguments.dialect)
    loaded: list[TypeName] = []
    for path in arguments.types:
        loaded += registry.load(path)
    names: list[TypeName | str] = []
    for name in arguments.names:
        if "/" in name:
            names.append(name)
            continue
        members = registry.names(None, name)
        if not members:
            raise UnknownType(f"no definitions of package {name} found")
        names += members
    if not arguments.names:
        names += sorted(set(loaded))
    if not names:
        raise CommandError("nothing to write: name packages or types, or load some with --types", USAGE)
    changed = write_package(arguments.directory, registry, names)
    if arguments.json:
        emit_json(changed)
        return 0
    for path in changed:
        print(path)
    if not changed:
        note("nothing has changed")
    return 0
