"""Type stubs of message classes, for editors and type checkers."""

from __future__ import annotations

import os

from roslet.gen import python
from roslet.gen.files import write_files
from roslet.gen.lines import render
from roslet.gen.python_names import attribute
from roslet.idl import Message, Service
from roslet.layout import PRIMITIVE_SIZE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from roslet.gen.lines import Block
    from roslet.idl import Interface, Registry
    from roslet.idl.records import Dialect, Field, FieldType, TypeName

MARK = "# Generated from the definitions of %s by roslet.gen.stubs. Do not edit."


def kind_stub(package: str, kind: str, members: list[Interface], root: str) -> str:
    """The stub of a module that has the classes `members`; `root` is the module that has the packages (dots:
    a relative one)."""
    imports: dict[str, None] = {}
    classes: list[str | Block] = []
    for member in sorted(members, key=lambda one: (not isinstance(one, Message), one.name)):
        classes += [
            "",
            *(_message(member, imports) if isinstance(member, Message) else _holder(member, imports)),
        ]
    lines = [MARK % package, "", "import typing as _typing", "from collections import abc as _abc", ""]
    lines += ["from roslet.wire import message as _message", "from roslet.wire import time as _time"]
    joint = "" if root.endswith(".") else "."
    for text in sorted(imports):
        other, other_kind = text.split(".")
        if (other, other_kind) != (package, kind):
            lines.append(
                "from %s%s%s import %s as %s" % (root, joint, other, other_kind, _alias(other, other_kind))
            )
    return render([*_only_used(lines, render(classes)), *classes])


def _only_used(lines: list[str], text: str) -> Iterator[str]:
    """The lines without the imports that `text` does not use."""
    for line in lines:
        name = line.rpartition(" as ")[2]
        if " import " not in " " + line or name + "." in text:
            yield line


def _alias(package: str, kind: str) -> str:
    return "_%s_%s" % (package, kind)


def _reference(name: TypeName, imports: dict[str, None], here: TypeName) -> str:
    if (name.package, name.kind) == (here.package, here.kind):
        return name.name
    imports["%s.%s" % (name.package, name.kind)] = None
    return "%s.%s" % (_alias(name.package, name.kind), name.name)


_SCALARS = {"bool": "bool", "float32": "float", "float64": "float", "string": "str", "wstring": "str"}


def _single(kind: FieldType, imports: dict[str, None], here: TypeName) -> str:
    if kind.message is not None:
        text = _reference(kind.message, imports, here)
        stamp = kind.message.package == "builtin_interfaces" and kind.message.name in ("Time", "Duration")
        # What node.now() gives serves as well.
        return "%s | _time.%s" % (text, kind.message.name) if stamp else text
    primitive = kind.primitive or ""
    if primitive in ("time", "duration"):
        return "_time." + primitive.capitalize()
    return _SCALARS.get(primitive, "int")


def _read(field: Field, imports: dict[str, None], here: TypeName) -> str:
    """The type of an attribute."""
    kind = field.type
    if kind.array is None:
        return _single(kind, imports, here)
    if kind.primitive == "uint8":
        return "_message.Bytes"
    if kind.primitive in PRIMITIVE_SIZE:
        return "_typing.Any"
    return "list[%s]" % _single(kind, imports, here)


def _given(field: Field, imports: dict[str, None], here: TypeName) -> str:
    """The type of a parameter of `__init__`."""
    kind = field.type
    if kind.array is None:
        single = _single(kind, imports, here)
        return single + " | None" if single[:1] == "_" or single[:1].isupper() else single
    if kind.primitive == "uint8":
        return "_message.Bytes | _abc.Sequence[int]"
    if kind.primitive in PRIMITIVE_SIZE:
        return "_typing.Any"
    return "list[%s] | None" % _single(kind, imports, here)


def _message(message: Message, imports: dict[str, None]) -> Iterator[str | Block]:
    here = message.name
    body: list[str | Block] = []
    for constant in message.constants:
        body.append("%s: _typing.ClassVar[%s]" % (constant.name, type(constant.value).__name__))
    for field in message.fields:
        body.append("%s: %s" % (attribute(field.name), _read(field, imports, here)))
    if message.fields:
        body.append("def __init__(")
        parameters: list[str | Block] = ["self,"]
        for field in message.fields:
            parameters.append("%s: %s = ...," % (attribute(field.name), _given(field, imports, here)))
        body += [parameters, ") -> None: ..."]
    else:
        body.append("def __init__(self) -> None: ...")
    yield "class %s(_message.%s):" % (here.name, python.base(message))
    yield body


def _holder(interface: Any, imports: dict[str, None]) -> Iterator[str | Block]:
    here = interface.name
    yield "class %s(%s):" % (
        here.name,
        "_message.Service" if isinstance(interface, Service) else "_message.Action",
    )
    yield [
        "%s = %s" % (name, _reference(part, imports, here)) for name, part in python.parts(interface).items()
    ]


def members(registry: Registry, package: str, kind: Any) -> list[Interface]:
    """Everything that `roslet.msgs...package.kind` has: what is defined, and what is derived of it."""
    found: dict[str, Interface] = {}
    waiting = [registry.interface(name) for name in registry.names(kind, package)]
    while waiting:
        interface = waiting.pop()
        found[interface.name.name] = interface
        if not isinstance(interface, Message):
            parts = python.parts(interface).values()
            waiting += [registry.interface(part) for part in parts if part.kind == kind]
    if kind == "msg" and registry.dialect == "ros1":
        for name in registry.names("action", package):
            for message in registry.action(name).messages:
                found[message.name.name] = message
    return [found[name] for name in sorted(found)]


def bundled_stubs(registry: Registry, dialect: Dialect) -> dict[str, str]:
    """The stubs of all packages of a registry: path under `roslet/msgs` to text."""
    files: dict[str, str] = {}
    for package in registry.packages():
        folder = "%s/%s" % (dialect, package)
        kinds = []
        for kind in ("action", "msg", "srv"):
            found = members(registry, package, kind)
            if found:
                kinds.append(kind)
                root = "roslet.msgs." + dialect
                files["%s/%s.pyi" % (folder, kind)] = kind_stub(package, kind, found, root)
        names = "".join(["from . import %s as %s\n" % (kind, kind) for kind in kinds])
        files[folder + "/__init__.pyi"] = MARK % package + "\n\n" + names
    return files


def write_bundled_stubs(directory: str | os.PathLike[str]) -> list[str]:
    """Write the stubs of the bundled packages of both dialects under `directory` (`src/roslet/msgs`); what
    changed."""
    from roslet.idl import Registry

    both: tuple[Dialect, ...] = ("ros1", "ros2")
    files: dict[str, str] = {}
    for dialect in both:
        files.update(bundled_stubs(Registry(dialect, None), dialect))
    return write_files(directory, files)


if __name__ == "__main__":
    import sys

    for changed_path in write_bundled_stubs(sys.argv[1]):
        print(changed_path)
