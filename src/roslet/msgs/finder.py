"""An import hook: packages with `msg`, `srv` and `action` modules whose classes are made on first use."""

from __future__ import annotations

import sys
from importlib.machinery import ModuleSpec

from roslet.errors import DefinitionError, InvalidName, UnknownType
from roslet.gen import runtime

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from types import ModuleType
    from typing import Any

    from roslet.idl.records import Dialect

KINDS = ("msg", "srv", "action")


class Finder:
    """Finds `prefix.package` and `prefix.package.msg|srv|action` for the packages of one dialect's registry.

    With an empty prefix the packages stand at the top, as rospy and rclpy programs import them.
    """

    def __init__(self, prefix: str, dialect: Dialect) -> None:
        self.prefix = prefix
        self.dialect: Dialect = dialect

    def find_spec(
        self, name: str, _path: Sequence[str] | None = None, _target: object = None
    ) -> ModuleSpec | None:
        """For the import system."""
        if self.prefix:
            if not name.startswith(self.prefix + "."):
                return None
            parts = name[len(self.prefix) + 1 :].split(".")
        else:
            parts = name.split(".")
        if len(parts) > 2 or (len(parts) == 2 and parts[1] not in KINDS):
            return None
        kind: Any = parts[1] if len(parts) == 2 else None
        try:
            names = runtime.registry(self.dialect).names(kind, parts[0])
            if not names and kind == "msg" and self.dialect == "ros1":
                # ROS 1 derives messages from the actions of a package.
                names = runtime.registry(self.dialect).names("action", parts[0])
        except InvalidName:
            return None
        if not names:
            return None
        loader: Any = _Loader(self.dialect, parts[0], kind)
        return ModuleSpec(name, loader, is_package=kind is None)


class _Loader:
    """Makes the module of a package or of one of its kinds."""

    def __init__(self, dialect: Dialect, package: str, kind: str | None) -> None:
        self.dialect: Dialect = dialect
        self.package = package
        self.kind = kind

    def create_module(self, _spec: ModuleSpec) -> None:
        """The default module object will do."""

    def exec_module(self, module: ModuleType) -> None:
        """Give the module a lazy namespace."""
        kind = self.kind
        if kind is None:
            module.__doc__ = "The interfaces of %s." % self.package
            module.__getattr__ = self.part(module.__name__)  # type: ignore[method-assign]
            return
        module.__doc__ = "The %s interfaces of %s." % (kind, self.package)
        module.__getattr__ = self.member(module, kind)  # type: ignore[method-assign]
        module.__dir__ = lambda: self.names(kind)  # type: ignore[method-assign]

    def names(self, kind: Any) -> list[str]:
        registry = runtime.registry(self.dialect)
        found = [name.name for name in registry.names(kind, self.package)]
        if kind == "srv":
            joint = "" if self.dialect == "ros1" else "_"
            found += [name + joint + part for name in list(found) for part in ("Request", "Response")]
        elif kind == "msg" and self.dialect == "ros1":
            for action in registry.names("action", self.package):
                found += [message.name.name for message in registry.action(action).messages]
        return sorted(found)

    def part(self, module_name: str) -> Callable[[str], Any]:
        """`import roslet.msgs.ros1.std_msgs` and then `std_msgs.msg` works without importing `msg` first."""

        def get(name: str) -> Any:
            if name in KINDS:
                from importlib import import_module

                try:
                    return import_module(module_name + "." + name)
                except ImportError:
                    pass
            raise AttributeError("module %r has no attribute %r" % (module_name, name))

        return get

    def member(self, module: ModuleType, kind: str) -> Callable[[str], Any]:
        def get(name: str) -> Any:
            if name == "__all__":
                return self.names(kind)
            if not name.startswith("_"):
                try:
                    made = runtime.interface_class(self.dialect, "%s/%s/%s" % (self.package, kind, name))
                except InvalidName:
                    made = None
                except DefinitionError as error:
                    # An unknown type that a file names is that file's fault, not a wrong import.
                    if error.file or not isinstance(error, UnknownType):
                        raise ImportError(str(error)) from error
                    made = None
                if made is not None:
                    setattr(module, name, made)
                    return made
            raise AttributeError("module %r has no attribute %r" % (module.__name__, name))

        return get


def install(prefix: str, dialect: Dialect, first: bool = True) -> Finder:
    """Add a finder to the import system, before all others or after them; returns it, for `uninstall`.

    Installing the same prefix again returns the finder that is there.
    """
    for present in sys.meta_path:
        if isinstance(present, Finder) and present.prefix == prefix and present.dialect == dialect:
            return present
    finder = Finder(prefix, dialect)
    if first:
        sys.meta_path.insert(0, finder)
    else:
        sys.meta_path.append(finder)
    return finder


def uninstall(finder: Finder) -> None:
    """Take a finder out of the import system; modules that are imported stay."""
    if finder in sys.meta_path:
        sys.meta_path.remove(finder)
