"""Writes messages as freestanding C++17 headers.

    DIR/roslet/message.hpp          what all of them stand on: containers, errors, writer and reader
    DIR/std_msgs/String.hpp         ROS 1: struct std_msgs::String
    DIR/std_msgs/msg/String.hpp     ROS 2: struct std_msgs::msg::String

Both systems' headers may stand in one DIR. The text depends on the definitions and the bounds alone; a file is written only
if it changes.
"""

from __future__ import annotations

import os

from roslet.errors import Unsupported
from roslet.gen.collect import collect
from roslet.gen.cpp_bounds import Bounds
from roslet.gen.cpp_message import DURATION, SUPPORT, TIME, Headers
from roslet.gen.cpp_names import header_path
from roslet.gen.files import write_files
from roslet.idl import Action

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable

    from roslet.idl import Interface, Registry, TypeName


def support_header() -> str:
    """The text of `roslet/message.hpp`."""
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "support", "message.hpp")
    with open(path, encoding="utf-8", newline="") as file:
        return file.read()


def headers(
    registry: Registry, names: Iterable[TypeName | str], bounds: Bounds | None = None
) -> dict[str, str]:
    """The headers of `names` and of all they are made of: path to text.

    A name may be that of a message, service or action, as `Registry.interface` takes it. Raises what that raises, ValueError
    as `Headers.text` does, and Unsupported where ROS 1 has a message and a service of one name, which C++ cannot have.
    """
    interfaces: dict[str, Interface] = {}
    for name in names:
        collect(registry, registry.interface(name), interfaces)
    if registry.dialect == "ros2" and any(interface.name == TIME for interface in interfaces.values()):
        collect(registry, registry.interface(DURATION), interfaces)  # which is the difference of two times
    spelled = Headers(registry, Bounds() if bounds is None else bounds)
    files = {SUPPORT: support_header()}
    for interface in interfaces.values():
        if isinstance(interface, Action) and registry.dialect == "ros1":
            continue  # in ROS 1 an action is its messages
        path = header_path(interface.name, registry.dialect)
        if path in files:
            raise Unsupported(
                f"{interface.name.text(registry.dialect)} is two things: in C++ they would have one name"
            )
        files[path] = spelled.text(interface)
    return files


def write_headers(
    directory: str | os.PathLike[str],
    registry: Registry,
    names: Iterable[TypeName | str],
    bounds: Bounds | None = None,
) -> list[str]:
    """Write what `headers` gives under `directory`; the paths of the files that changed.

    Raises as that does, and then writes nothing. Other files there are left alone.
    """
    return write_files(directory, headers(registry, names, bounds))
