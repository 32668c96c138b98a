"""What `import` finds in a rospy or rclpy program: `rospy`, `rclpy` and their like are our modules, `pkg.msg` and its like
the registry's.

A package's own Python code, where it is installed or on the path, is found as ever; only its `msg` and `srv` are ours, since
generated ones need genpy.
"""

from __future__ import annotations

import importlib
import importlib.util
import re
import sys
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType
from typing import TYPE_CHECKING, Any

from roslet.errors import DefinitionError, InvalidName, UnknownType
from roslet.gen import runtime

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from roslet.idl.records import Dialect, Kind

OURS = {"ros1": ("rospy", "genpy", "roslib", "rosgraph"), "ros2": ("rclpy",)}
KINDS: dict[str, tuple[Kind, ...]] = {"ros1": ("msg", "srv"), "ros2": ("msg", "srv", "action")}

# Packages that such programs often import and whose Python code is no part of roslet: what to say instead of "no module".
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
    "ament_index_python": "packages are not installed here: name files by their paths",
    "launch": "start each program with `roslet run`",
    "launch_ros": "start each program with `roslet run`",
    "rosbag2_py": "the package rosbags reads and writes bags without ROS",
    "rosidl_runtime_py": "`roslet interface` and `roslet topic` do what its functions do",
    "ros2cli": "`roslet` does what its commands do",
}


class Finder:
    """Stands before all other finders, for programs of one dialect. See the module."""

    def __init__(self, dialect: Dialect = "ros1") -> None:
        self.dialect: Dialect = dialect

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """For the import system."""
        top, _, rest = fullname.partition(".")
        if top in OURS[self.dialect]:
            return self._ours(fullname)
        if not rest:
            return self._package(top)
        kind, _, member = rest.partition(".")
        for known in KINDS[self.dialect]:
            if kind == known and "." not in member and _names(self.dialect, top, known):
                if not member:
                    return _spec(fullname, _KindLoader(self.dialect, top, known), True)
                name = self._member(top, known, member)
                if name:
                    return _spec(fullname, _MemberLoader(self.dialect, top, known, name), False)
        return None

    def _member(self, package: str, kind: Kind, module: str) -> str:
        """The definition that a generated module holds: `_Name` as genpy calls it, `_some_name` as rosidl does."""
        if not module.startswith("_"):
            return ""
        for name in _names(self.dialect, package, kind):
            if module[1:] == (name if self.dialect == "ros1" else _snake(name)):
                return name
        return ""

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
        has_definitions = any(_names(self.dialect, name, kind) for kind in KINDS[self.dialect])
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


def _snake(name: str) -> str:
    """A type's name as rosidl names its files: `PointCloud2` is in `point_cloud2`."""
    name = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", name).lower()


def _names(dialect: Dialect, package: str, kind: Kind) -> set[str]:
    """What `package.kind` has, by the registry: definitions, and what ROS 1 derives of services and actions."""
    try:
        registry = runtime.registry(dialect)
        found = {name.name for name in registry.names(kind, package)}
        if dialect == "ros2":
            return found
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
        if self.name.startswith("roslet.compat.rclpy."):
            from roslet.compat.rclpy._found import complete

            complete(module)
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
    """`package.msg` and its like: classes are made when they are asked for."""

    def __init__(self, dialect: Dialect, package: str, kind: Kind) -> None:
        self.dialect: Dialect = dialect
        self.package = package
        self.kind = kind

    def create_module(self, spec: ModuleSpec) -> None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        module.__doc__ = f"The {self.kind} definitions of {self.package}."
        module.__path__ = []
        module.__getattr__ = self._getter(module)  # type: ignore[method-assign]
        module.__dir__ = lambda: sorted(_names(self.dialect, self.package, self.kind))  # type: ignore[method-assign]

    def _getter(self, module: ModuleType) -> Callable[[str], Any]:
        def get(name: str) -> Any:
            if name == "__all__":
                return sorted(_names(self.dialect, self.package, self.kind))
            made = None if name.startswith("_") else class_of(self.package, self.kind, name, self.dialect)
            if made is None:
                raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")
            setattr(module, name, made)
            return made

        return get


class _MemberLoader:
    """`package.msg._Name`, which generated packages have."""

    def __init__(self, dialect: Dialect, package: str, kind: Kind, name: str) -> None:
        self.dialect: Dialect = dialect
        self.package = package
        self.kind = kind
        self.name = name

    def create_module(self, spec: ModuleSpec) -> None:
        return None

    def exec_module(self, module: ModuleType) -> None:
        parts = ("", "Request", "Response") if self.kind == "srv" and self.dialect == "ros1" else ("",)
        for part in parts:
            made = class_of(self.package, self.kind, self.name + part, self.dialect)
            if made is not None:
                setattr(module, self.name + part, made)
        if self.kind == "srv" and self.dialect == "ros2":
            made = class_of(self.package, self.kind, self.name, self.dialect)
            for part in (made.Request, made.Response):
                setattr(module, part.__name__, part)


def class_of(package: str, kind: Kind, name: str, dialect: Dialect = "ros1") -> Any:
    """The class of a definition, as rospy or rclpy programs know it; None where there is none. Raises ImportError for a
    definition that is wrong."""
    if dialect == "ros1":
        from roslet.compat.messages import adapt
    else:
        from roslet.compat.interfaces import adapt

    try:
        return adapt(runtime.interface_class(dialect, f"{package}/{kind}/{name}"))
    except (UnknownType, InvalidName):
        return None
    except DefinitionError as error:
        raise ImportError(str(error)) from error


def install(dialect: Dialect = "ros1") -> Finder:
    """Put the finder for programs of a dialect before all others, once; returns it, for `uninstall`."""
    for present in sys.meta_path:
        if isinstance(present, Finder) and present.dialect == dialect:
            return present
    finder = Finder(dialect)
    sys.meta_path.insert(0, finder)
    return finder


def dialect_of(source: bytes) -> Dialect:
    """The dialect of a program, by what it imports: rospy and its like, or rclpy; else packages that only ROS 2 has."""
    import ast

    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError):
        return "ros1"  # the program will say what is wrong with it
    tops: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            tops.update(name.name.partition(".")[0] for name in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            tops.add(node.module.partition(".")[0])
    for dialect in ("ros1", "ros2"):
        if tops.intersection(OURS[dialect]):
            return "ros1" if dialect == "ros1" else "ros2"
    packages = {
        dialect: {name for name in tops if any(_names(dialect, name, kind) for kind in KINDS[dialect])}
        for dialect in _DIALECTS
    }
    return (
        "ros2" if packages["ros2"] - packages["ros1"] and not packages["ros1"] - packages["ros2"] else "ros1"
    )


_DIALECTS: tuple[Dialect, ...] = ("ros1", "ros2")


def uninstall(finder: Finder) -> None:
    """Take the finder out; modules that were imported stay."""
    if finder in sys.meta_path:
        sys.meta_path.remove(finder)


__all__ = ["NOT_HERE", "OURS", "Finder", "class_of", "dialect_of", "install", "uninstall"]
