"""Message classes at run time: from a type's name to a class, with nothing compiled before it is used.

A class is made from its definition at once, which is cheap. Its methods are descriptors that compile the real
method on first use and put it in their place: a publisher never pays for a deserialiser, and a nested class,
whose code is inlined in the classes that hold it, mostly pays for none.
"""

from __future__ import annotations

from roslet.errors import DefinitionError
from roslet.gen import python
from roslet.layout import CDR, ROS1, layout
from roslet.layout.operations import Layout
from roslet.wire import primitives
from roslet.wire.arrays import numbers, octets, place
from roslet.wire.cdr import HEADER_SIZE
from roslet.wire.message import (
    Action,
    Message,
    Service,
    Stamp,
    deserialize_any,
    rescue_read,
    rescue_write,
    serialize_any,
)
from roslet.wire.time import Duration, Time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from os import PathLike
    from typing import Any

    from roslet.idl import Registry, records
    from roslet.idl.records import Dialect, TypeName


class _Scope:
    """Definitions and the classes made of them, by name: the process's of a dialect, or what one peer's text brought."""

    def __init__(self, registry: Registry) -> None:
        self.registry = registry
        self.classes: dict[str, Any] = {}

    def message(self, name: TypeName | str) -> type[Message]:
        key = str(name)
        made = self.classes.get(key)
        if made is None:
            made = self.classes[key] = _message_class(self.registry.message(name), self)
        return made


_scopes: dict[str, _Scope] = {}


def _scope(dialect: Dialect) -> _Scope:
    made = _scopes.get(dialect)
    if made is None:
        from roslet.idl import Registry

        made = _scopes[dialect] = _Scope(Registry(dialect))
    return made


def registry(dialect: Dialect) -> Registry:
    """The process's registry of a dialect's definitions, made on first use from the environment."""
    return _scope(dialect).registry


def message_class(dialect: Dialect, name: TypeName | str) -> type[Message]:
    """The class of a message; the same object every time. Raises UnknownType, DefinitionError,
    RecursiveType."""
    return _scope(dialect).message(name)


def service_class(dialect: Dialect, name: TypeName | str) -> type[Service]:
    """The class of a service, with `Request` and `Response`. Raises as `message_class`."""
    key = str(name) + "#srv"
    scope = _scope(dialect)
    made = scope.classes.get(key)
    if made is None:
        service = scope.registry.service(name)
        made = scope.classes[key] = _named(dialect, service.name, "#srv", lambda: _service_class(service))
    return made  # type: ignore[no-any-return]


def action_class(dialect: Dialect, name: TypeName | str) -> type[Action]:
    """The class of an action, with `Goal`, `Result`, `Feedback` and what is derived. Raises as
    `message_class`."""
    key = str(name) + "#action"
    scope = _scope(dialect)
    made = scope.classes.get(key)
    if made is None:
        action = scope.registry.action(name)
        made = scope.classes[key] = _named(dialect, action.name, "#action", lambda: _action_class(action))
    return made  # type: ignore[no-any-return]


def interface_class(dialect: Dialect, name: TypeName | str) -> Any:
    """The class of a message, service or action, whichever `name` is. Raises as `message_class`."""
    found = registry(dialect).interface(name)
    kind = type(found).__name__
    if kind == "Message":
        return message_class(dialect, found.name)
    return service_class(dialect, found.name) if kind == "Service" else action_class(dialect, found.name)


def for_dialect(dialect: Dialect, kind: Any) -> Any:
    """The class of the same name in `dialect`: `kind` itself, or its counterpart where it is the other
    dialect's.

    Raises UnknownType where the dialect has none.
    """
    package, _, rest = kind._type.partition("/")
    part, _, name = rest.rpartition("/")
    if dialect == ("ros2" if part else "ros1"):
        return kind
    if not part:
        part = "srv" if issubclass(kind, Service) else "action" if issubclass(kind, Action) else "msg"
    return interface_class(dialect, "%s/%s/%s" % (package, part, name))


def load(path: str | PathLike[str], dialect: Dialect | None = None) -> Types:
    """Load the definitions at `path` (a package, a workspace or its `src`, a directory of definition files).

    They come before all others of their names in this process, for both networks; each is parsed when it is asked for.
    One definition serves on both: `time`, `duration` and the bare word `Header` of ROS 1 are, on ROS 2, the messages that
    took their place. What is returned has the packages as attributes (`types.my_msgs.msg.Foo`), with the classes of
    `dialect`: by default that of the package's build tool (catkin: ROS 1); where no package.xml names one, ROS 2 unless
    a definition is right in ROS 1 only. A node takes either's class and uses that of its own network. Raises
    DefinitionError where there is no definition, or none that `dialect`, where it is given, allows.
    """
    names: list[TypeName] = []
    faults: list[DefinitionError] = []
    both: tuple[Dialect, ...] = ("ros1", "ros2")
    for one in both:
        try:
            found = registry(one).load(path)
        except DefinitionError as error:
            # A package's or a file's name is not legal there, or nothing is there at all.
            if one == dialect:
                raise
            faults.append(error)
            continue
        names += found
        _forget(one, found)
    if not names:
        raise faults[0]
    names = sorted(set(names))
    return Types(dialect or _guess(str(path), names), names)


def message_class_of(name: str, definition: str) -> type[Message]:
    """The ROS 1 class of a message whose definition a peer sent (`message_definition` in a connection
    header).

    The class is a new one each time, and so are those of its nested types: what a peer says of a name changes nothing for
    others in this process. Raises DefinitionError where the text is wrong, or lacks a type that is not bundled.
    """
    return _told_class("ros1", name, definition)


def described_class(name: str, description: dict[str, Any]) -> type[Message]:
    """The ROS 2 class of a message that a peer described (`definition_text` says how); as `message_class_of`."""
    from roslet.idl.described import definition_text

    return _told_class("ros2", name, definition_text(description))


def _told_class(dialect: Dialect, name: str, text: str) -> type[Message]:
    from roslet.idl import Registry

    own = Registry(dialect, None)
    own.load_full_text(name, text)
    return _Scope(own).message(name)


def _guess(path: str, names: list[TypeName]) -> Dialect:
    import os

    for folder, folders, files in os.walk(path):
        folders.sort()
        if "package.xml" in files:
            with open(os.path.join(folder, "package.xml"), encoding="utf-8", errors="replace") as file:
                return "ros1" if "catkin" in file.read() else "ros2"
    only_ros1 = any(not _is_right("ros2", name) and _is_right("ros1", name) for name in names)
    return "ros1" if only_ros1 else "ros2"


def _is_right(dialect: Dialect, name: TypeName) -> bool:
    try:
        registry(dialect).interface(name)
    except DefinitionError:
        return False
    return True


def _forget(dialect: Dialect, names: list[TypeName]) -> None:
    """Drop the classes of `names`, and those made of them: a new definition has come before theirs."""
    classes = _scope(dialect).classes
    gone = {str(name) for name in names}
    while True:
        stale = []
        for key, made in classes.items():
            if key not in gone and any(part in gone for part in _parts_of(made)):
                stale.append(key)
        if not stale:
            break
        gone.update(stale)
    for name in gone:
        for suffix in ("", "#srv", "#action"):
            classes.pop(name + suffix, None)
    short = [key for key in classes if key.split("#")[0].count("/") == 1]
    for key in short:
        del classes[key]


def _parts_of(made: Any) -> list[str]:
    """The full names of what a class is made of."""
    if issubclass(made, Message):
        inner = [row[1] for row in made._spec if not isinstance(row[1], str)]
    else:
        inner = [value for value in vars(made).values() if isinstance(value, type)]
    return [_full_name(part) for part in inner]


def _full_name(made: Any) -> str:
    return "%s/%s/%s" % (*made.__module__.split(".")[-2:], made.__name__)


class Types:
    """What `load` found: packages as attributes, each with `msg`, `srv` and `action`."""

    def __init__(self, dialect: Dialect, names: list[TypeName]) -> None:
        self.dialect: Dialect = dialect
        self.names = names

    def message(self, name: TypeName | str) -> type[Message]:
        """The class of a message: `pkg/Name`."""
        return message_class(self.dialect, name)

    def service(self, name: TypeName | str) -> type[Service]:
        """The class of a service."""
        return service_class(self.dialect, name)

    def action(self, name: TypeName | str) -> type[Action]:
        """The class of an action."""
        return action_class(self.dialect, name)

    def __getattr__(self, package: str) -> Any:
        if package.startswith("_") or package not in [name.package for name in self.names]:
            raise AttributeError("no package %s was loaded" % package)
        from importlib import import_module

        return import_module("roslet.msgs.%s.%s" % (self.dialect, package))

    def __dir__(self) -> list[str]:
        packages = {name.package for name in self.names}
        return sorted(["action", "dialect", "message", "names", "service", *packages])


def _named(dialect: Dialect, name: TypeName, suffix: str, make: Callable[[], Any]) -> Any:
    classes = _scope(dialect).classes
    key = str(name) + suffix
    made = classes.get(key)
    if made is None:
        made = classes[key] = make()
    return made


class _Method:
    """Stands for a method until it is used."""

    def __init__(self, name: str, make: Callable[[], Any]) -> None:
        self.name = name
        self.make = make
        self.owner: Any = None

    def __get__(self, instance: Any, owner: Any) -> Any:
        setattr(self.owner, self.name, self.make())
        return getattr(owner if instance is None else instance, self.name)


class _Fact:
    """Stands for a class attribute until it is read."""

    def __init__(self, name: str, make: Callable[[], Any]) -> None:
        self.name = name
        self.make = make
        self.owner: Any = None

    def __get__(self, _instance: Any, _owner: Any) -> Any:
        value = self.make()
        setattr(self.owner, self.name, value)
        return value


class _Builder:
    """What is needed to compile the methods of one class later."""

    def __init__(self, message: records.Message, scope: _Scope) -> None:
        self.message = message
        self.scope = scope
        self.dialect = message.dialect
        self.made: Layout | None = None
        self.reader: Any = None

    def layout(self) -> Layout:
        if self.made is None:
            self.made = layout(
                self.message, self.scope.registry.message, ROS1 if self.dialect == "ros1" else CDR
            )
        return self.made

    def compile(self, method: python.Method, name: str) -> Any:
        namespace = dict(_PRELUDE)
        for reference, target in method.references.items():
            namespace[reference] = self.reference(target)
        if "_ndarray" not in namespace and method.globals_:
            for text in method.globals_.values():
                if text.startswith("_numbers"):
                    namespace["_ndarray"] = numbers("uint8").type
                    break
        source = method.text()
        exec(compile(source, "<%s %s>" % (self.dialect, self.message.name), "exec"), namespace)
        return namespace[name]

    def reference(self, target: Any) -> Any:
        if target == "time":
            return Time
        if target == "duration":
            return Duration
        return self.scope.message(target)

    def initialize(self) -> Any:
        return self.compile(python.initializer(self.message), "__init__")

    def serialize(self) -> Any:
        return self.compile(python.serializer(self.layout()), "serialize_into")

    def serialize_whole(self) -> Any:
        method = python.bytes_serializer(self.layout())
        return serialize_any if method is None else self.compile(method, "serialize")

    def deserialize(self) -> Any:
        if self.reader is None:
            self.reader = classmethod(self.compile(python.deserializer(self.layout()), "_read"))
        return self.reader

    def header(self) -> int:
        return HEADER_SIZE if self.dialect == "ros2" else 0

    def fixed_size(self) -> int | None:
        size = self.layout().fixed
        return None if size is None else size + self.header()

    def minimum_size(self) -> int:
        return self.layout().minimum + self.header()

    def maximum_size(self) -> int | None:
        size = self.layout().maximum
        return None if size is None else size + self.header()

    def views(self) -> bool:
        from roslet.gen.python_codec import has_views

        return has_views(self.layout().operations)

    def md5sum(self) -> str:
        from roslet.idl import md5sum

        return md5sum(self.scope.registry, self.message.name)

    def full_text(self) -> str:
        from roslet.idl import full_text

        return full_text(self.scope.registry, self.message.name)

    def type_hash(self) -> str:
        from roslet.idl import type_hash

        return type_hash(self.scope.registry, self.message.name)


_PRELUDE: dict[str, Any] = {
    "_FAILURES": primitives.FAILURES,
    "_numbers": numbers,
    "_octets": octets,
    "_place": place,
    "_deserialize": deserialize_any,
    "_serialize": serialize_any,
    "_rescue_read": rescue_read,
    "_rescue_write": rescue_write,
}
for _name, _there in python.PRELUDE.items():
    _PRELUDE[_name] = getattr(primitives, _there)


def module_name(dialect: Dialect, name: TypeName) -> str:
    """Where the class of a type can be imported from."""
    return "roslet.msgs.%s.%s.%s" % (dialect, name.package, name.kind)


def _message_class(message: records.Message, scope: _Scope) -> type[Message]:
    dialect = message.dialect
    name = message.name
    known = scope.classes.get(str(name))
    if known is not None:
        return known  # type: ignore[no-any-return]
    builder = _Builder(message, scope)
    rows = []
    for field in message.fields:
        attribute, base, kind, size, bound = python.field_entry(field)
        if not isinstance(base, str):
            base = scope.message(base)  # type: ignore[assignment]
        rows.append((attribute, base, kind, size, bound))
    lazy: list[Any] = [
        _Method("__init__", builder.initialize),
        _Method("serialize_into", builder.serialize),
        _Method("serialize", builder.serialize_whole),
        _Method("deserialize_from", builder.deserialize),
        _Method("deserialize", builder.deserialize),
        _Fact("_fixed_size", builder.fixed_size),
        _Fact("_minimum_size", builder.minimum_size),
        _Fact("_maximum_size", builder.maximum_size),
        _Fact("_views", builder.views),
    ]
    body: dict[str, Any] = {
        "__slots__": python.slots(message),
        "__module__": module_name(dialect, name),
        "__qualname__": name.name,
        "__doc__": "%s of %s" % (name.text(dialect), "ROS 1" if dialect == "ros1" else "ROS 2"),
        "_type": name.text(dialect),
        "_encoding": "ros1" if dialect == "ros1" else "cdr",
        "_spec": tuple(rows),
        "_fields_and_types": python.fields_and_types(message),
    }
    if dialect == "ros1":
        lazy.append(_Fact("_md5sum", builder.md5sum))
        lazy.append(_Fact("_full_text", builder.full_text))
        body["_has_header"] = python.has_header(message)
    else:
        lazy.append(_Fact("_type_hash", builder.type_hash))
    for constant in message.constants:
        body[constant.name] = constant.value
    for part in lazy:
        body[part.name] = part
    made = type(name.name, (Stamp if python.base(message) == "Stamp" else Message,), body)
    for part in lazy:
        part.owner = made
    scope.classes[str(name)] = made
    return made


def _service_class(service: records.Service) -> type[Service]:
    dialect = service.dialect
    name = service.name
    body: dict[str, Any] = {
        "__module__": module_name(dialect, name),
        "__qualname__": name.name,
        "__doc__": "The service %s of %s" % (name.text(dialect), "ROS 1" if dialect == "ros1" else "ROS 2"),
        "_type": name.text(dialect),
    }
    for attribute, part in python.parts(service).items():
        body[attribute] = message_class(dialect, part)
    return _with_hashes(dialect, name, Service, body)  # type: ignore[no-any-return]


def _with_hashes(dialect: Dialect, name: TypeName, base: type, body: dict[str, Any]) -> Any:
    def md5() -> str:
        from roslet.idl import md5sum

        return md5sum(registry(dialect), name)

    def rihs() -> str:
        from roslet.idl import type_hash

        return type_hash(registry(dialect), name)

    fact = _Fact("_md5sum", md5) if dialect == "ros1" else _Fact("_type_hash", rihs)
    body[fact.name] = fact
    made = type(name.name, (base,), body)
    fact.owner = made
    return made


def _action_class(action: records.Action) -> type[Action]:
    dialect = action.dialect
    name = action.name
    body: dict[str, Any] = {
        "__module__": module_name(dialect, name),
        "__qualname__": name.name,
        "__doc__": "The action %s of %s" % (name.text(dialect), "ROS 1" if dialect == "ros1" else "ROS 2"),
        "_type": name.text(dialect),
    }
    services = {service.name for service in action.services}
    for attribute, part in python.parts(action).items():
        make = service_class if part in services else message_class
        body[attribute] = make(dialect, part)
    if dialect == "ros1":
        return type(name.name, (Action,), body)
    return _with_hashes(dialect, name, Action, body)  # type: ignore[no-any-return]


__all__ = [
    "Types",
    "action_class",
    "for_dialect",
    "interface_class",
    "load",
    "message_class",
    "message_class_of",
    "module_name",
    "registry",
    "service_class",
]
