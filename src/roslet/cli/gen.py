"""`roslet gen`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from roslet.cli.options import USAGE, CommandError, Group
from roslet.errors import UnknownType
from roslet.gen.cpp_bounds import MAXIMUM_BOUND, SEQUENCE_BOUND, STRING_BOUND
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
    _what(python, "where the package goes; made where it is not there")
    cpp = group.command(
        "cpp",
        run_cpp,
        "write messages as freestanding C++17 headers",
        "roslet gen cpp include --types my_ws/src --dialect ros2\n"
        "roslet gen cpp include geometry_msgs std_srvs/SetBool --string-bound 32\n"
        "roslet gen cpp include sensor_msgs/msg/Image --dialect ros2 --bounds bounds.txt",
        "types json",
    )
    cpp.description = (
        "Write messages as C++17 headers that need no heap, exceptions or RTTI: a header for each type,\n"
        "and roslet/message.hpp.\n\n"
        "Strings and sequences have bounds: those of the definition, else those of the options. A file of bounds\n"
        "has lines such as `std_msgs/Header.frame_id 16`; `names[]` are the strings in the array `names`.\n"
        "Files that would not change are left alone."
    )
    _what(cpp, "where the headers go, the folder for the compiler's -I; made where it is not there")
    cpp.add_argument(
        "--string-bound",
        metavar="N",
        type=bound,
        default=STRING_BOUND,
        help="octets of a string that has no bound of its own (default %(default)s)",
    )
    cpp.add_argument(
        "--sequence-bound",
        metavar="N",
        type=bound,
        default=SEQUENCE_BOUND,
        help="elements of a sequence that has no bound of its own (default %(default)s)",
    )
    cpp.add_argument("--bounds", metavar="FILE", help="bounds of single fields")


def _what(parser: argparse.ArgumentParser, directory: str) -> None:
    """Declare where the code goes and what it is of."""
    parser.add_argument("directory", metavar="DIR", help=directory)
    parser.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help="a package, or a type such as package/Name, with all it is made of; default: what --types loaded",
    )
    parser.add_argument(
        "--dialect",
        choices=(ROS1, ROS2),
        default=ROS1,
        help="the system whose messages they are (default ros1)",
    )


def bound(text: str) -> int:
    """An argument type: a bound."""
    value = int(text)
    if not 1 <= value <= MAXIMUM_BOUND:
        raise ValueError(text)
    return value


def run_cpp(arguments: argparse.Namespace) -> int:
    """`roslet gen cpp`."""
    from roslet.gen.cpp import write_headers
    from roslet.gen.cpp_bounds import Bounds, read_bounds

    registry, names = _definitions(arguments)
    at: dict[tuple[TypeName, str], int] = {}
    if arguments.bounds is not None:
        try:
            with open(arguments.bounds, encoding="utf-8") as file:
                text = file.read()
        except (OSError, UnicodeDecodeError) as error:
            raise CommandError(f"cannot read {arguments.bounds}: {error}") from None
        at = read_bounds(text, registry, arguments.bounds)
    bounds = Bounds(arguments.string_bound, arguments.sequence_bound, at)
    try:
        changed = write_headers(arguments.directory, registry, names, bounds)
    except ValueError as error:
        raise CommandError(str(error)) from None
    return _report(changed, arguments.json)


def run_python(arguments: argparse.Namespace) -> int:
    """`roslet gen python`."""
    from roslet.gen.python_package import write_package

    registry, names = _definitions(arguments)
    return _report(write_package(arguments.directory, registry, names), arguments.json)


def _definitions(arguments: argparse.Namespace) -> tuple[Registry, list[TypeName | str]]:
    """The definitions, and the names of those to write. Raises CommandError where there are none."""
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
    return registry, names


def _report(changed: list[str], json: bool) -> int:
    from roslet.cli.output import emit_json, note

    if json:
        emit_json(changed)
        return 0
    for path in changed:
        print(path)
    if not changed:
        note("nothing has changed")
    return 0
