"""The message classes of a bundle: with code of their own for what the program sends and gets, by field tables for
the rest."""

from __future__ import annotations

import ast
import re

from roslet.gen import python
from roslet.gen.lines import render
from roslet.gen.python_names import class_reference
from roslet.gen.python_package import interface_module
from roslet.idl import Message, full_text, md5sum, type_hash
from roslet.layout import CDR, ROS1, layout

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import Any, Literal

    from roslet.gen.lines import Block
    from roslet.idl import Interface, Registry
    from roslet.idl.records import TypeName

_CDR_HEADER = 4
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*(/(msg|srv))?/[A-Za-z][A-Za-z0-9_]*$")


def mentioned(program: str, registry: Registry) -> list[str]:
    """The types that a program names: texts such as "std_msgs/msg/String", and what looks like `...std_msgs.msg.String`."""
    found: dict[str, None] = {}
    for node in ast.walk(ast.parse(program)):
        candidate = ""
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and _NAME.match(node.value):
            candidate = node.value
        elif isinstance(node, ast.Attribute):
            candidate = _dotted(node)
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("roslet.msgs."):
            package, kind = node.module.split(".")[-2:]
            for alias in node.names:
                found.update(dict.fromkeys(_known("%s/%s/%s" % (package, kind, alias.name), registry)))
        if candidate:
            found.update(dict.fromkeys(_known(candidate, registry)))
    return list(found)


def _dotted(node: ast.Attribute) -> str:
    kind = node.value
    if not isinstance(kind, ast.Attribute) or kind.attr not in ("msg", "srv"):
        return ""
    package = kind.value
    name = (
        package.attr
        if isinstance(package, ast.Attribute)
        else package.id
        if isinstance(package, ast.Name)
        else ""
    )
    return "%s/%s/%s" % (name, kind.attr, node.attr) if name else ""


def _known(name: str, registry: Registry) -> list[str]:
    try:
        registry.interface(name)
    except Exception:  # no type, whatever it is
        return []
    return [name]


class Types:
    """Modules of the classes of `fast` types and `compact` ones and of all they are made of, under `roslet.msgs`.
    With `exact` fast ones fall back on the codec that compact ones have as well: without any of those, it need not
    be there. What is only `sent` has no code to be received."""

    def __init__(
        self,
        dialect: Literal["ros1", "ros2"],
        registry: Registry,
        fast: Iterable[str],
        compact: Iterable[str],
        exact: bool,
        sent: Iterable[str] = (),
    ) -> None:
        self.dialect = dialect
        self._exact = exact
        self._sent: set[str] = set()
        self._registry = registry
        self._interfaces: dict[str, Interface] = {}
        self._fast: set[str] = set()
        for name in fast:
            self._collect(registry.interface(name), True)
        known = set(self._interfaces)
        for name in sent:
            self._collect(registry.interface(name), not exact)
        self._sent = set(self._interfaces) - known
        for name in compact:
            self._collect(registry.interface(name), False)

    @property
    def messages(self) -> list[Message]:
        """Those that have a size."""
        return [one for one in self._interfaces.values() if isinstance(one, Message)]

    def maximum(self, message: Message) -> int | None:
        """The most octets of one, with CDR's header on ROS 2; None where nothing bounds it."""
        if self.dialect == "ros1":
            return layout(message, self._registry.message, ROS1).maximum
        body = layout(message, self._registry.message, CDR).maximum
        return None if body is None else body + _CDR_HEADER

    def _collect(self, interface: Interface, fast: bool) -> None:
        key = str(interface.name) + "#" + type(interface).__name__
        if key in self._interfaces:
            return
        self._interfaces[key] = interface
        if isinstance(interface, Message):
            if fast:
                self._fast.add(key)
            for field in interface.fields:
                if field.type.message is not None:
                    self._collect(self._registry.message(field.type.message), not self._exact)
            return
        for attribute in ("Request", "Response"):
            self._collect(self._registry.message(python.parts(interface)[attribute]), fast)

    def texts(self) -> dict[str, str]:
        """Module -> text."""
        found: dict[str, str] = {}
        table: list[str] = []
        imports = []
        for key, interface in self._interfaces.items():
            name = interface.name
            if not isinstance(interface, Message):
                found[self._module(name)] = self._service(interface)
            elif key in self._fast:
                found[self._module(name)] = _short(
                    interface_module(self._registry, interface), self._exact, key in self._sent
                )
            else:
                found[self._module(name)] = self._compact(interface)
            line = "from %s import %s" % (self._module(name), name.name)
            here = "T%d" % len(table)
            imports.append("%s as %s" % (line, here))
            table.append('"%s/%s/%s": %s' % (name.package, name.kind, name.name, here))
            # Programs may import a class from where CPython has it.
            kind = "roslet.msgs.%s.%s.%s" % (self.dialect, name.package, name.kind)
            found[kind] = found.get(kind, "") + line + "\n"
        found["roslet.msgs"] = "\n".join(imports) + "\nTYPES = {%s}\n" % ", ".join(table)
        return found

    def _module(self, name: TypeName) -> str:
        return "roslet.msgs.%s.%s.%s._%s" % (self.dialect, name.package, name.kind, name.name)

    def _import(self, name: TypeName) -> str:
        return "from %s import %s as %s" % (self._module(name), name.name, class_reference(name))

    def _service(self, interface: Any) -> str:
        parts = {key: part for key, part in python.parts(interface).items() if key in ("Request", "Response")}
        lines: list[str | Block] = ["from roslet.wire.message import Service"]
        lines += [self._import(part) for part in sorted(set(parts.values()))]
        body: list[str | Block] = ['_type = "%s"' % interface.name.text(self.dialect)]
        if self.dialect == "ros1":
            body.append('_md5sum = "%s"' % md5sum(self._registry, interface.name))
        else:
            body.append('_type_hash = "%s"' % type_hash(self._registry, interface.name))
        body += ["%s = %s" % (attribute, class_reference(part)) for attribute, part in parts.items()]
        return render([*lines, "class %s(Service):" % interface.name.name, body])

    def _compact(self, message: Message) -> str:
        """A class without code of its own."""
        registry = self._registry
        references: dict[str, Any] = {}
        spec = list(python.spec_source(message, references))
        initializer = python.initializer(message)
        references.update(initializer.references)
        lines: list[str | Block] = ["from roslet.node.micropython.types import Compact"]
        base = "Compact"
        if python.base(message) != "Message":
            base = "Compact, " + python.base(message)
            lines.append("from roslet.wire.message import " + python.base(message))
        text = render([*initializer.block])
        used = [
            "%s as %s" % (there, here) for here, there in sorted(python.PRELUDE.items()) if here + "(" in text
        ]
        if used:
            lines.append("from roslet.wire.primitives import " + ", ".join(used))
        times = [kind for kind in ("Duration", "Time") if "_" + kind in references]
        if times:
            lines.append(
                "from roslet.wire.time import " + ", ".join(["%s as _%s" % (kind, kind) for kind in times])
            )
        for _, target in sorted(references.items()):
            if not isinstance(target, str):
                lines.append(self._import(target))
        lines += ["%s = %s" % item for item in sorted(initializer.globals_.items())]
        laid_out = layout(message, registry.message, ROS1 if self.dialect == "ros1" else CDR)
        fixed = laid_out.fixed
        body: list[str | Block] = [
            '_type = "%s"' % message.name.text(self.dialect),
            '_encoding = "%s"' % ("ros1" if self.dialect == "ros1" else "cdr"),
            "_fixed_size = %r"
            % (None if fixed is None else fixed + (0 if self.dialect == "ros1" else _CDR_HEADER)),
        ]
        if self.dialect == "ros1":
            body.append('_md5sum = "%s"' % md5sum(registry, message.name))
            body.append("_full_text = %r" % without_comments(full_text(registry, message.name)))
            body.append("_has_header = %r" % python.has_header(message))
        else:
            body.append('_type_hash = "%s"' % type_hash(registry, message.name))
        body += spec
        body += ["%s = %r" % (constant.name, constant.value) for constant in message.constants]
        body += [*initializer.block]
        return render([*lines, "class %s(%s):" % (message.name.name, base), body])


def without_comments(definition: str) -> str:
    """A definition that has the same MD5 and is shorter: without comments and empty lines, but for those in constants."""
    lines = []
    for line in definition.split("\n"):
        if not line.lstrip().startswith("string ") or "=" not in line:
            line = line.partition("#")[0].rstrip()
        if line.strip():
            lines.append(line)
    return "\n".join(lines) + "\n"


def _short(module: str, exact: bool, sent: bool) -> str:
    """A generated module whose definition text is without comments, and which falls back on less unless `exact`."""
    tree = ast.parse(module)
    for node in list(ast.walk(tree)):
        if not exact and isinstance(node, ast.ImportFrom) and node.module == "roslet.wire.message":
            rescue = [alias for alias in node.names if alias.name.startswith("rescue_")]
            node.names = [alias for alias in node.names if alias not in rescue]
            tree.body.insert(0, ast.ImportFrom("roslet.node.micropython.lean", rescue, 0))
        if (
            isinstance(node, ast.Assign)
            and isinstance(node.targets[0], ast.Name)
            and node.targets[0].id == "_full_text"
        ):
            assert isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
            node.value.value = without_comments(node.value.value)
    if sent:
        tree.body = [
            one for one in tree.body if not (isinstance(one, ast.FunctionDef) and one.name == "_read")
        ]
        for node in tree.body:
            if isinstance(node, ast.ClassDef):
                node.body = [
                    one for one in node.body if not (isinstance(one, ast.Assign) and len(one.targets) == 2)
                ]
    return ast.unparse(ast.fix_missing_locations(_direct(tree)))


def _direct(tree: ast.Module) -> ast.Module:
    """Call `struct` itself where CPython has prepared functions: MicroPython would make a tuple of what they are given. Not
    where there is padding, which it does not write."""
    functions = {"_packer": "pack_into", "_unpacker": "unpack_from"}
    found: dict[str, tuple[str, ast.Constant]] = {}
    for statement in tree.body:
        if isinstance(statement, ast.Assign) and isinstance(statement.value, ast.Call):
            target, made = statement.targets[0], statement.value
            form = made.args[0] if made.args else None
            if (
                isinstance(target, ast.Name)
                and isinstance(made.func, ast.Name)
                and made.func.id in functions
                and isinstance(form, ast.Constant)
                and "x" not in str(form.value)
            ):
                found[target.id] = functions[made.func.id], form
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in found:
            name, form = found[node.func.id]
            node.func = ast.Name(name, ast.Load())
            node.args.insert(0, form)
    left = {
        node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)
    }
    tree.body = [
        one
        for one in tree.body
        if not (
            isinstance(one, ast.Assign)
            and isinstance(one.targets[0], ast.Name)
            and one.targets[0].id in found
            and one.targets[0].id not in left
        )
    ]
    used = sorted({name for name, _ in found.values()})
    if used:
        tree.body.insert(0, ast.ImportFrom("struct", [ast.alias(name) for name in used], 0))
    return tree
