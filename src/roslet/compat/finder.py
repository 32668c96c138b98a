"""What `import` finds in a rospy program: `rospy` and its like are our modules, `pkg.msg` and `pkg.srv` the registry's.

A package's own Python code, where it is installed or on the path, is found as ever; only its `msg` and `srv` are ours, since
generated ones need genpy.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import TYPE_CHECKING, Any

from roslet.errors import DefinitionError, InvalidName, UnknownType
from roslet.gen import runtime

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from roslet.idl.records import Kind

OURS = ("rospy", "genpy", "roslib", "rosgraph")
KINDS: tuple[Kind, ...] = ("msg", "srv")

# Packages that rospy programs often import and whose Python code is no part of roslet: what to say instead of "no module".
NOT_HERE = {
    "actionlib": "its messages are here (actionlib.msg), its clients and servers are not",
    "tf": "its messages are here (tf.msg), its listeners and broadcasters are not",
    "tf2_ros": "publish tf2_msgs/TFMessage on /tf, or subscribe it, instead",
    "dynamic_reconfigure": "its messages are here (dynamic_reconfigure.msg), its client and server are not",
    "cv_bridge": "numpy.frombuffer(image.data, ...) makes an array of an image",
    "message_filters": "it is pure Python: put it on PYTHONPATH",
    "rosbag": "the package rosbags reads and writes bags without ROS",
    "tf_conversions": "it is pure Python: put it on PYTHONPATH",
    "laser_geometry": "it is pure Python: put it on PYTHONPATH",
    "rosparam": "rospy.get_param and rospy.set_param do what its functions do",
    "rosnode": "`roslet node` does what its functions do",
    "rostopic": "`roslet topic` does what its functions do",
    "rosservice": "`roslet service` does what its functions do",
    "roslaunch": "start each program with `roslet run`",
    "rospkg": "it is on PyPI: pip install rospkg",
    "rosmsg": "`roslet interface` does what its functions do",
}


class Finder:
    """Stands before all other finders. See the module."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """For the import system."""
        top, _, rest = fullname.partition(".")
        if top in OURS:
            return self._ours(fullname)
        if not rest:
            return self._package(top)
        kind, _, member = rest.partition(".")
        for known in KINDS:
            if kind == known and "." not in member and _names(top, known):
                if not member:
                    return _spec(fullname, _KindLoader(top, known), True)
                if member.startswith("_") and member[1:] in _names(top, known):
                    return _spec(fullname, _MemberLoader(top, known, member[1:]), False)
        return None

    def _ours(self, fullname: str) -> ModuleSpec | None:
        name = "roslet.compat." + fullname
        try:
            found = importlib.util.find_spec(name)
        except ModuleNotFoundError:
            return None
        if found is None:
            return None
        return _spec(fullname, _Alias(name), found.submodule_search_locations is not None)

    def _package(self, name: str) -> ModuleSpec | None:
        if name in sys.builtin_module_names or name.startswith("_"):
            return None
        has_definitions = any(_names(name, kind) for kind in KINDS)
        if not has_definitions and name not in NOT_HERE:
            return None
        real = PathFinder.find_spec(name)
        if real is not None and real.loader is not None:
            return real
        if not has_definitions:
            raise ModuleNotFoundError(f"{name} is no part of roslet: {NOT_HERE[name]}", name=name)
        return _spec(name, _PackageLoader(name), True)


def _spec(name: str, loader: Any, is_package: bool) -> ModuleSpec:
    return ModuleSpec(name, loader, is_package=is_package)


def _names(package: str, kind: Kind) -> set[str]:
    """What `package.kind` has, by the registry: definitions, and what is derived of services and actions."""
    try:
        registry = runtime.registry("ros1")
        found = {name.name for name in registry.names(kind, package)}
        if kind == "srv":
            found.update([name + part for name in list(found) for part in ("Request", "Response")])
        else:
            for action in registry.names("action", package):
                found.update([message.name.name for message in registry.action(action).messages])
    except InvalidName:
        return set()
    except DefinitionError as error:
        raise ImportError(str(error)) from error
    return found


class _Alias:
    """One of our modules under the name that the program uses."""

    def __init__(self, name: str) -> None:
        self.name = name

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        module = importlib.import_module(self.name)
        self.spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """It has run already; give it its own specification back."""
        module.__spec__ = self.spec


class _PackageLoader:
    """A package that has nothing but definitions here."""

    def __init__(self, package: str) -> None:
        self.package = package

    def create_module(self, spec: ModuleSpec) -> None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        package = self.package
        module.__doc__ = f"The definitions of {package}."
        module.__path__ = []

        def get(name: str) -> Any:
            reason = NOT_HERE.get(package, "only its definitions are here")
            if name.startswith("__"):
                raise AttributeError(name)
            raise AttributeError(f"module {package!r} has no attribute {name!r}: {reason}")

        module.__getattr__ = get  # type: ignore[method-assign]


class _KindLoader:
    """`package.msg` or `package.srv`: classes are made when they are asked for."""

    def __init__(self, package: str, kind: Kind) -> None:
        self.package = package
        self.kind = kind

    def create_module(self, spec: ModuleSpec) -> None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        module.__doc__ = f"The {self.kind} definitions of {self.package}."
        module.__path__ = []
        module.__getattr__ = self._getter(module)  # type: ignore[method-assign]
        module.__dir__ = lambda: sorted(_names(self.package, self.kind))  # type: ignore[method-assign]

    def _getter(self, module: ModuleType) -> Callable[[str], Any]:
        def get(name: str) -> Any:
            if name == "__all__":
                return sorted(_names(self.package, self.kind))
            made = None if name.startswith("_") else class_of(self.package, self.kind, name)
            if made is None:
                raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")
            setattr(module, name, made)
            return made

        return get


class _MemberLoader:
    """`package.msg._Name`, which genpy's generated packages have."""

    def __init__(self, package: str, kind: Kind, name: str) -> None:
        self.package = package
        self.kind = kind
        self.name = name

    def create_module(self, spec: ModuleSpec) -> None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        parts = ("", "Request", "Response") if self.kind == "srv" else ("",)
        for part in parts:
            made = class_of(self.package, self.kind, self.name + part)
            if made is not None:
                setattr(module, self.name + part, made)


def class_of(package: str, kind: Kind, name: str) -> Any:
    """The class of a definition, as rospy programs know it; None where there is none. Raises ImportError for a definition
    that is wrong."""
    from roslet.compat.messages import adapt

    try:
        return adapt(runtime.interface_class("ros1", f"{package}/{kind}/{name}"))
    except (UnknownType, InvalidName):
        return None
    except DefinitionError as error:
        raise ImportError(str(error)) from error


def install() -> Finder:
    """Put the finder before all others, once; returns it, for `uninstall`."""
    for present in sys.meta_path:
        if isinstance(present, Finder):
            return present
    finder = Finder()
    sys.meta_path.insert(0, finder)
    return finder


def uninstall(finder: Finder) -> None:
    """Take the finder out; modules that were imported stay."""
    if finder in sys.meta_path:
        sys.meta_path.remove(finder)


__all__ = ["NOT_HERE", "OURS", "Finder", "class_of", "install", "uninstall"]
