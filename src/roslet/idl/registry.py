"""Every definition by name: finds the file, parses it once, checks that what it is made of exists."""

from __future__ import annotations

import os

from roslet.errors import DefinitionError, RecursiveType, UnknownType
from roslet.idl.parser import parse
from roslet.idl.records import Action, Field, Message, Service, TypeName
from roslet.idl.sources import Texts, bundled, environment_sources, legal_names, load_source
from roslet.idl.spelling import KINDS, is_word, parse_type_name, split_full_text

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import NoReturn

    from roslet.idl.records import Dialect, Interface, Kind
    from roslet.idl.sources import Source

# Longest first where one ends with another.
_ROS1_ACTION_SUFFIXES = (
    "ActionGoal",
    "ActionResult",
    "ActionFeedback",
    "Action",
    "Goal",
    "Result",
    "Feedback",
)
_ROS1_SERVICE_SUFFIXES = ("Request", "Response")


class Registry:
    """The definitions of one dialect.

    They come from, in this order: what `load` was given (the latest first), `$AMENT_PREFIX_PATH` (ROS 2) or
    `$ROS_PACKAGE_PATH` (ROS 1) of `environment`, and the bundled standard packages. `environment=None` leaves
    the environment out. Nothing is read before it is asked for; what has been read stays.

    Where a method takes a name, it is a TypeName or a text that `parse_type_name` accepts. Names of derived
    types are names too: `pkg/srv/Name_Request`, `pkg/action/Name_SendGoal`, and in ROS 1 `pkg/NameRequest`,
    `pkg/NameActionGoal`.
    """

    def __init__(self, dialect: Dialect, environment: Mapping[str, str] | None = os.environ) -> None:
        self.dialect: Dialect = dialect
        self._environment = environment
        self._loaded: list[Source] = []
        self._fixed: list[Source] | None = None
        self._records: dict[TypeName, Interface] = {}
        self._texts: dict[str, str] = {}
        self._checked: set[TypeName] = set()

    def load(self, path: str | os.PathLike[str]) -> list[TypeName]:
        """Put the definitions at `path` before all others and return their names, sorted.

        `path` is a package, a workspace or its `src`, a directory of definition files, or one such file.
        Files are parsed when they are asked for. Raises DefinitionError where there is no definition.
        """
        source = load_source(os.fspath(path), self.dialect)
        names = sorted(self._names_of(source, None, None))
        if not names:
            raise DefinitionError("no .msg, .srv or .action file in the packages here", os.fspath(path))
        self._put_first(source)
        return names

    def load_full_text(self, name: TypeName | str, text: str) -> list[TypeName]:
        """Put a message and all it is made of before all others, from the `message_definition` of a
        connection header.

        `text` is what `full_text` makes: the message's definition, then each nested type's after a line of 80
        `=` and one of `MSG: package/Name`. Returns the names, sorted; a name that is there twice counts once.
        Raises DefinitionError for a section without a name; the definitions themselves are parsed when they
        are asked for.
        """
        first = self._type_name(name, "msg")
        texts = split_full_text(first, text)
        self._put_first(Texts(texts, f"message_definition of {first.text(self.dialect)}"))
        return sorted(texts)

    def _put_first(self, source: Source) -> None:
        self._loaded.insert(0, source)
        self._records.clear()
        self._texts.clear()
        self._checked.clear()

    def message(self, name: TypeName | str) -> Message:
        """The message, given or derived, whose nested types all exist.

        Raises UnknownType, RecursiveType, or DefinitionError for a wrong text.
        """
        found = self._checked_interface(self._type_name(name, "msg"))
        if not isinstance(found, Message):
            raise UnknownType(f"{found.name.text(self.dialect)} is no message", found.file)
        return found

    def service(self, name: TypeName | str) -> Service:
        """The service, given or derived from an action. Raises as `message` does."""
        found = self._checked_interface(self._type_name(name, "srv"))
        if not isinstance(found, Service):
            raise UnknownType(f"{found.name.text(self.dialect)} is no service", found.file)
        return found

    def action(self, name: TypeName | str) -> Action:
        """The action. Raises as `message` does."""
        found = self._checked_interface(self._type_name(name, "action"))
        if not isinstance(found, Action):
            raise UnknownType(f"{found.name.text(self.dialect)} is no action", found.file)
        return found

    def interface(self, name: TypeName | str) -> Interface:
        """The message, service or action of this name; `pkg/Name` is looked for in this order.

        Raises as `message` does.
        """
        if isinstance(name, str) and name.count("/") == 1:
            for kind in KINDS:
                full = parse_type_name(name, kind)
                if self._lookup(full) is not None:
                    return self._checked_interface(full)
            self._fail_unknown(parse_type_name(name), None, None)
        return self._checked_interface(self._type_name(name, "msg"))

    def dependencies(self, name: TypeName | str) -> list[Message]:
        """The messages that the interface is made of, at any depth, each once, without itself.

        The order is that of ROS 1's full text: the first field's type, what that is made of, the second
        field's, ... A service has those of its request and then its response (not of its event); an action
        those of all its parts.
        """
        interface = self.interface(name)
        if isinstance(interface, Message):
            roots = [interface]
        elif isinstance(interface, Service):
            roots = [interface.request, interface.response]
        else:
            roots = list(interface.messages)
            for service in interface.services:
                roots += [service.request, service.response]
        found: list[Message] = []
        seen: set[TypeName] = set()
        for root in roots:
            waiting = _nested_names(root)
            while waiting:
                nested = waiting.pop()
                if nested not in seen:
                    seen.add(nested)
                    message = self.message(nested)
                    found.append(message)
                    waiting += _nested_names(message)
        return found

    def names(self, kind: Kind | None = None, package: str | None = None) -> list[TypeName]:
        """Every name defined, of one kind or package if given, sorted; without derived types."""
        found: set[TypeName] = set()
        for source in self._sources():
            found.update(self._names_of(source, kind, package))
        return sorted(found)

    def packages(self) -> list[str]:
        """The packages that define something, sorted."""
        return sorted({name.package for name in self.names()})

    # Finding

    def _type_name(self, name: TypeName | str, kind: Kind) -> TypeName:
        return parse_type_name(name, kind) if isinstance(name, str) else name

    def _sources(self) -> list[Source]:
        if self._fixed is None:
            self._fixed = [bundled(self.dialect)]
            if self._environment is not None:
                self._fixed[:0] = environment_sources(self.dialect, self._environment)
        return [*self._loaded, *self._fixed]

    def _names_of(self, source: Source, kind: Kind | None, package: str | None) -> list[TypeName]:
        return [
            TypeName(a_package, a_kind, name)
            for a_package in (source.packages() if package is None else [package])
            for a_kind in (KINDS if kind is None else [kind])
            for name in legal_names(source, a_package, a_kind, self.dialect)
        ]

    def _lookup(self, name: TypeName) -> Interface | None:
        """The record, parsed if need be, its nested types unchecked; None if there is none."""
        found = self._records.get(name)
        if found is not None:
            return found
        if not is_word(name.package.replace("-", "_")) or not is_word(name.name):
            return None  # such a name must not become a path
        owners = _owners(name, self.dialect)
        for source in self._sources():
            for owner in owners:
                path = source.find(owner.package, owner.kind, owner.name)
                if path is not None:
                    interface = self._records.get(owner) or self._read(owner, path, source)
                    if owner is name:
                        return interface
                    found = next((part for part in _parts(interface) if part.name.name == name.name), None)
                    if found is not None:
                        self._records[name] = found
                    return found
        return None

    def _read(self, name: TypeName, path: str, source: Source) -> Interface:
        try:
            text = source.read(path)
        except OSError as error:
            raise DefinitionError(f"cannot be read: {error.strerror}", path) from error
        if text[:1] == "\ufeff":
            text = text[1:]
        interface = parse(
            text, name, self.dialect, path, "Header" not in text or self._has_header(name.package)
        )
        self._texts[path] = text
        self._records[name] = interface
        return interface

    def _has_header(self, package: str) -> bool:
        """Whether the package has a message Header of its own."""
        return any(source.find(package, "msg", "Header") is not None for source in self._sources())

    # Checking

    def _checked_interface(self, name: TypeName) -> Interface:
        found = self._lookup(name)
        if found is None:
            self._fail_unknown(name, None, None)
        if name not in self._checked:
            if isinstance(found, Message):
                self._check(found)
            elif isinstance(found, Service):
                self._check(found.request)
                self._check(found.response)
            else:
                for message in found.messages:
                    self._check(message)
                for service in found.services:
                    self._check(service.request)
                    self._check(service.response)
            self._checked.add(name)
        return found

    def _check(self, root: Message) -> None:
        """See that every type inside `root` exists and none contains itself. Not recursive: nesting may be
        deep."""
        if root.name in self._checked:
            return
        path: list[tuple[Message, int]] = [(root, 0)]
        open_: dict[TypeName, None] = {root.name: None}
        while path:
            message, index = path.pop()
            if index == len(message.fields):
                del open_[message.name]
                self._checked.add(message.name)
                continue
            path.append((message, index + 1))
            field = message.fields[index]
            nested = field.type.message
            if nested is None or nested in self._checked:
                continue
            if nested in open_:
                cycle = list(open_)
                cycle = [*cycle[cycle.index(nested) :], nested]
                names = " -> ".join([name.text(self.dialect) for name in cycle])
                self._fail_at(RecursiveType, "a message cannot contain itself: " + names, message, field)
            found = self._lookup(nested)
            # A part of a ROS 1 service can be asked for, but genmsg knows no field of such a type.
            if found is None or found.name != nested:
                self._fail_unknown(nested, message, field)
            if not isinstance(found, Message):
                self._fail_at(UnknownType, f"{nested.text(self.dialect)} is no message", message, field)
            path.append((found, 0))
            open_[found.name] = None

    def _fail_unknown(self, name: TypeName, message: Message | None, field: Field | None) -> NoReturn:
        variable = "$ROS_PACKAGE_PATH" if self.dialect == "ros1" else "$AMENT_PREFIX_PATH"
        searched = f"what was loaded, {variable} and the bundled packages"
        if self._environment is None:
            searched = "what was loaded and the bundled packages"
        text = f"unknown type {name.text(self.dialect)}: not in {searched}"
        if message is None or field is None:
            raise UnknownType(text)
        self._fail_at(UnknownType, text, message, field)

    def _fail_at(
        self, error: type[UnknownType | RecursiveType], text: str, message: Message, field: Field
    ) -> NoReturn:
        column = 0
        if field.line:
            line = self._texts[message.file].split("\n")[field.line - 1]
            column = len(line) - len(line.lstrip()) + 1
        raise error(text, message.file, field.line, column)


def _parts(interface: Interface) -> list[Interface]:
    """What one file defines beside the interface that it is named for."""
    if isinstance(interface, Message):
        return []
    if isinstance(interface, Service):
        parts: list[Interface] = [interface.request, interface.response]
        return parts if interface.event is None else [*parts, interface.event]
    parts = [*interface.messages, *interface.services]
    for service in interface.services:
        parts += _parts(service)
    return parts


def _nested_names(message: Message) -> list[TypeName]:
    """The types of the message's fields, last first, as a stack wants them."""
    return [field.type.message for field in reversed(message.fields) if field.type.message is not None]


def _owners(name: TypeName, dialect: Dialect) -> list[TypeName]:
    """The names under which a file may define `name`: its own, or those it may be derived from."""
    owners = [name]
    if dialect == "ros2":
        # A name itself has no underscore, so that what stands before the first one is the owner.
        base, underscore, _ = name.name.partition("_")
        return [TypeName(name.package, name.kind, base)] if underscore and name.kind != "msg" else owners
    if name.kind != "action":
        owners += _without(name, "srv", _ROS1_SERVICE_SUFFIXES)
    if name.kind == "msg":
        owners += _without(name, "action", _ROS1_ACTION_SUFFIXES)
    return owners


def _without(name: TypeName, kind: Kind, suffixes: tuple[str, ...]) -> list[TypeName]:
    return [
        TypeName(name.package, kind, name.name[: -len(suffix)])
        for suffix in suffixes
        if name.name.endswith(suffix) and len(name.name) > len(suffix)
    ]
