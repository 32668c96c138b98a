"""Where definition files lie: share directories, crawled workspaces, what a user loads. Reads directories,
parses nothing."""

from __future__ import annotations

import os

from roslet.errors import DefinitionError
from roslet.idl.spelling import KINDS, interface_problem, package_problem

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import TypeAlias

    from roslet.idl.records import Dialect, Kind, TypeName

# A crawl for packages goes no deeper and reads no more directories than this, so that a mistaken path such as
# / ends within a second. Real workspaces nest four or five deep and have hundreds.
MAXIMUM_CRAWL_DEPTH = 12
MAXIMUM_CRAWL_DIRECTORIES = 20_000

_MANIFESTS = ("package.xml", "manifest.xml")
_IGNORE_MARKS = frozenset(("CATKIN_IGNORE", "COLCON_IGNORE", "AMENT_IGNORE"))


class Share:
    """A directory whose children are packages: `<root>/<package>/<kind>/<Name>.<kind>`. Nothing is read
    ahead."""

    def __init__(self, root: str) -> None:
        self.root = root

    def find(self, package: str, kind: Kind, name: str) -> str | None:
        """The path of the file, or None."""
        path = f"{self.root}/{package}/{kind}/{name}.{kind}"
        return path if os.path.isfile(path) else None

    def read(self, path: str) -> str:
        """The text of the file that `find` found. Raises OSError."""
        return _read_file(path)

    def packages(self) -> list[str]:
        """The packages that have a directory for definitions."""
        found = []
        for package in _names(self.root):
            if any(os.path.isdir(f"{self.root}/{package}/{kind}") for kind in KINDS):
                found.append(package)
        return found

    def names(self, package: str, kind: Kind) -> list[str]:
        """The names that the package defines."""
        return _definitions(f"{self.root}/{package}/{kind}", kind)


class Packages:
    """Packages at known places: package, kind -> directory that holds its files."""

    def __init__(self, directories: Mapping[str, Mapping[Kind, str]]) -> None:
        self.directories = directories

    def find(self, package: str, kind: Kind, name: str) -> str | None:
        """The path of the file, or None."""
        directories = self.directories.get(package)
        if directories is None:
            return None
        path = f"{directories[kind]}/{name}.{kind}"
        return path if os.path.isfile(path) else None

    def read(self, path: str) -> str:
        """The text of the file that `find` found. Raises OSError."""
        return _read_file(path)

    def packages(self) -> list[str]:
        """The packages known."""
        return list(self.directories)

    def names(self, package: str, kind: Kind) -> list[str]:
        """The names that the package defines."""
        directories = self.directories.get(package)
        return [] if directories is None else _definitions(directories[kind], kind)


class Texts:
    """Definitions that came as text, such as a connection header's; their paths only serve error messages."""

    def __init__(self, texts: Mapping[TypeName, str], origin: str) -> None:
        self.texts = {f"<{origin}>/{name}": text for name, text in texts.items()}
        self.defined = list(texts)
        self.origin = origin

    def find(self, package: str, kind: Kind, name: str) -> str | None:
        """What stands for the path of a file, or None."""
        path = f"<{self.origin}>/{package}/{kind}/{name}"
        return path if path in self.texts else None

    def read(self, path: str) -> str:
        """The text that `find` found."""
        return self.texts[path]

    def packages(self) -> list[str]:
        """The packages known."""
        return sorted({name.package for name in self.defined})

    def names(self, package: str, kind: Kind) -> list[str]:
        """The names that the package defines."""
        return sorted([name.name for name in self.defined if (name.package, name.kind) == (package, kind)])


class Workspace(Packages):
    """A directory in $ROS_PACKAGE_PATH: its children first, and only when they lack a package a crawl for
    package.xml.

    A directory named `share` is an install space (REP 122), whose packages are its children: it is not
    crawled.
    """

    def __init__(self, root: str) -> None:
        super().__init__({})
        self.root = root
        self.children = Share(root)
        self.crawled = os.path.basename(root) == "share"

    def find(self, package: str, kind: Kind, name: str) -> str | None:
        """The path of the file, or None."""
        path = self.children.find(package, kind, name)
        if path is None:
            self._crawl()
            path = super().find(package, kind, name)
        return path

    def packages(self) -> list[str]:
        """The packages known, after a crawl."""
        self._crawl()
        return sorted({*self.children.packages(), *self.directories})

    def names(self, package: str, kind: Kind) -> list[str]:
        """The names that the package defines."""
        self._crawl()
        return self.children.names(package, kind) or super().names(package, kind)

    def _crawl(self) -> None:
        if not self.crawled:
            self.crawled = True
            self.directories, _ = crawl(self.root)


if TYPE_CHECKING:
    Source: TypeAlias = Share | Packages | Texts


def bundled(dialect: Dialect) -> Share:
    """The definitions that come with roslet."""
    return Share(f"{os.path.dirname(os.path.abspath(__file__))}/definitions/{dialect}")


def environment_sources(dialect: Dialect, environment: Mapping[str, str]) -> list[Source]:
    """The sources that the environment names: $AMENT_PREFIX_PATH for ROS 2, $ROS_PACKAGE_PATH for ROS 1.

    Each variable serves its own dialect only, because the files of the other would be read wrongly.
    """
    if dialect == "ros2":
        prefixes = environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
        return [Share(prefix + "/share") for prefix in prefixes if prefix]
    entries = environment.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    return [Workspace(entry.rstrip("/") or "/") for entry in entries if entry]


def load_source(path: str, dialect: Dialect) -> Packages:
    """The packages at `path`: a package, a workspace, a directory of definitions or one definition file.

    A package is named by its package.xml, else by its directory. Raises DefinitionError where there is none.
    """
    path = os.path.abspath(path)
    if os.path.isfile(path):
        stem, extension = os.path.splitext(os.path.basename(path))
        if extension[1:] not in KINDS or not stem:
            raise DefinitionError("not a .msg, .srv or .action file", path)
        path = os.path.dirname(path)
    if not os.path.isdir(path):
        raise DefinitionError("no such file or directory", path)
    names = _names(path)
    directories: dict[str, dict[Kind, str]] = {}
    if _is_package(path, names, True):
        directories[_package_name(path, names)] = _kind_directories(path)
    elif any(_definitions(path, kind) for kind in KINDS):
        package_directory = os.path.dirname(path) if os.path.basename(path) in KINDS else path
        package = _package_name(package_directory, _names(package_directory))
        # A plain directory holds all kinds side by side; msg/ of a package has its brothers.
        directories[package] = (
            _kind_directories(package_directory) if package_directory != path else dict.fromkeys(KINDS, path)
        )
    else:
        directories, complete = crawl(path, True)
        if not complete:
            limit = MAXIMUM_CRAWL_DIRECTORIES
            raise DefinitionError(f"more than {limit} directories to search: name a package", path)
    if not directories:
        raise DefinitionError("no package and no .msg, .srv or .action file here", path)
    for package in directories:
        problem = package_problem(package, dialect)
        if problem:
            raise DefinitionError(f"package {package}: {problem}", path)
    return Packages(directories)


def legal_names(source: Source, package: str, kind: Kind, dialect: Dialect) -> list[str]:
    """The names that the source's package defines and the dialect allows."""
    return [name for name in source.names(package, kind) if not interface_problem(name, dialect)]


def crawl(root: str, bare: bool = False) -> tuple[dict[str, dict[Kind, str]], bool]:
    """The packages under `root`, and whether the search stayed within its bounds.

    The first package of a name wins, in breadth-first alphabetical order; a package's own subdirectories and
    those marked to be ignored are not searched. `bare`: a directory with definitions but no package.xml
    counts too.
    """
    found: dict[str, dict[Kind, str]] = {}
    seen: set[tuple[int, int]] = set()
    level = [root]
    count = 0
    for _ in range(MAXIMUM_CRAWL_DEPTH):
        following: list[str] = []
        for directory in level:
            count += 1
            if count > MAXIMUM_CRAWL_DIRECTORIES:
                return found, False
            try:
                status = os.stat(directory)
                entries = sorted(os.scandir(directory), key=lambda entry: entry.name)
            except OSError:
                continue  # unreadable or just deleted: as good as absent
            if (status.st_dev, status.st_ino) in seen:
                continue  # a link back to where we were
            seen.add((status.st_dev, status.st_ino))
            names = [entry.name for entry in entries]
            if not _IGNORE_MARKS.isdisjoint(names):
                continue
            if _is_package(directory, names, bare):
                found.setdefault(_package_name(directory, names), _kind_directories(directory))
            elif "rospack_nosubdirs" not in names:
                following += [entry.path for entry in entries if entry.name[0] != "." and entry.is_dir()]
        level = following
    return found, not level


def _read_file(path: str) -> str:
    # Universal newlines, as genmsg reads; bytes that are no UTF-8 are kept, since a comment may hold
    # anything.
    with open(path, encoding="utf-8", errors="surrogateescape") as file:
        return file.read()


def _names(directory: str) -> list[str]:
    try:
        return sorted(os.listdir(directory))
    except OSError:
        return []


def _definitions(directory: str, kind: Kind) -> list[str]:
    extension = "." + kind
    return [name[: -len(extension)] for name in _names(directory) if name.endswith(extension)]


def _is_package(directory: str, names: list[str], bare: bool) -> bool:
    if any(manifest in names for manifest in _MANIFESTS):
        return True
    return bare and any(kind in names and bool(_definitions(directory + "/" + kind, kind)) for kind in KINDS)


def _kind_directories(directory: str) -> dict[Kind, str]:
    return {kind: directory + "/" + kind for kind in KINDS}


def _package_name(directory: str, names: list[str]) -> str:
    if "package.xml" in names:
        try:
            with open(directory + "/package.xml", encoding="utf-8", errors="replace") as file:
                text = file.read()
        except OSError:
            text = ""
        while "<!--" in text:
            before, _, rest = text.partition("<!--")
            text = before + rest.partition("-->")[2]
        name = text.partition("<name")[2].partition(">")[2].partition("</name>")[0].strip()
        if name:
            return name
    return os.path.basename(directory)
