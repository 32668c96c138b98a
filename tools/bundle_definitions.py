"""Writes src/roslet/idl/definitions: the standard packages of both dialects as bare field facts.

    bundle_definitions.py [--check] --ros1 DIR... --ros1-python PYTHON --ros2 DIR...

DIR is a share directory of an installation (Debian's /usr/share, what tools/ros1_definitions.sh unpacks, the
share/ of a virtual environment with the ROS 2 wheels) or a checkout of sources; the first that holds a
package wins. Packages of which only generated Python is installed (Debian's roscpp) come from that Python's
classes. What is not found is kept as it stands in the tree and named. Only names, types, values and their
order are written: comments and spare blanks are dropped, the .msg files that an .action implies are left out.
"""

from __future__ import annotations

import argparse
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "src"))

from roslet.idl import Action, Constant, Dialect, Field, Interface, Kind, Message, Service, TypeName, parse  # noqa: E402
from roslet.idl.sources import Packages, crawl  # noqa: E402
from roslet.idl.spelling import KINDS  # noqa: E402

DEFINITIONS = ROOT / "src/roslet/idl/definitions"

PACKAGES: dict[Dialect, tuple[str, ...]] = {
    "ros1": (
        "actionlib",
        "actionlib_msgs",
        "actionlib_tutorials",
        "bond",
        "diagnostic_msgs",
        "dynamic_reconfigure",
        "geometry_msgs",
        "map_msgs",
        "move_base_msgs",
        "nav_msgs",
        "nodelet",
        "pcl_msgs",
        "roscpp",
        "roscpp_tutorials",
        "rosgraph_msgs",
        "rospy_tutorials",
        "sensor_msgs",
        "shape_msgs",
        "std_msgs",
        "std_srvs",
        "stereo_msgs",
        "tf",
        "tf2_msgs",
        "topic_tools",
        "trajectory_msgs",
        "turtlesim",
        "visualization_msgs",
    ),
    "ros2": (
        "action_msgs",
        "actionlib_msgs",
        "builtin_interfaces",
        "composition_interfaces",
        "diagnostic_msgs",
        "example_interfaces",
        "geometry_msgs",
        "lifecycle_msgs",
        "nav_msgs",
        "rcl_interfaces",
        "rmw_dds_common",
        "rosgraph_msgs",
        "sensor_msgs",
        "service_msgs",
        "shape_msgs",
        "statistics_msgs",
        "std_msgs",
        "std_srvs",
        "stereo_msgs",
        "tf2_msgs",
        "trajectory_msgs",
        "type_description_interfaces",
        "unique_identifier_msgs",
        "visualization_msgs",
    ),
}

# Prints {"pkg/kind/Name": text} from the classes that genpy generated; their full text begins with the file's
# own.
_FROM_PYTHON = """
import importlib, json, pkgutil, sys
texts = {}
for package in sys.argv[1:]:
    for kind in ("msg", "srv"):
        try:
            module = importlib.import_module(package + "." + kind)
        except ImportError:
            continue
        for entry in vars(module).values():
            name = getattr(entry, "_type", "").partition("/")[2]
            if kind == "srv" and hasattr(entry, "_request_class"):
                parts = [entry._request_class._full_text, entry._response_class._full_text]
                own = [part.partition("=" * 80)[0] for part in parts]
                texts[package + "/srv/" + name] = "\\n---\\n".join(own)
            elif kind == "msg" and hasattr(entry, "_full_text"):
                texts[package + "/msg/" + name] = entry._full_text.partition("=" * 80)[0]
print(json.dumps(texts))
"""


def read_directories(dialect: Dialect, directories: list[pathlib.Path]) -> dict[TypeName, str]:
    """Every definition text in the directories of the packages wanted."""
    texts: dict[TypeName, str] = {}
    done: set[str] = set()
    for directory in directories:
        source = Packages(crawl(str(directory), True)[0])
        for package in PACKAGES[dialect]:
            if package in done:
                continue
            for kind in KINDS:
                for name in source.names(package, kind):
                    path = source.find(package, kind, name)
                    if path is not None:
                        texts[TypeName(package, kind, name)] = pathlib.Path(path).read_text("utf-8")
                        done.add(package)
    return texts


def read_generated(python: str, packages: list[str]) -> dict[TypeName, str]:
    """The texts that genpy's classes carry."""
    command = [python, "-c", _FROM_PYTHON, *packages]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    texts: dict[TypeName, str] = {}
    for full, text in found.items():
        package, kind, name = full.split("/")
        texts[TypeName(package, _kind(kind), name)] = text
    return texts


def _kind(text: str) -> Kind:
    return KINDS[KINDS.index(text)]


def bare(interface: Interface) -> str:
    """The text of the interface reduced to what it says."""
    lines = interface.text.split("\n")
    if isinstance(interface, Message):
        parts = [interface]
    elif isinstance(interface, Service):
        parts = [interface.request, interface.response]
    else:
        parts = [interface.goal, interface.result, interface.feedback]
    texts = []
    for part in parts:
        entries: list[Field | Constant] = [*part.fields, *part.constants]
        entries.sort(key=lambda entry: entry.line)
        texts.append(
            "".join([_entry(entry, lines[entry.line - 1], interface.dialect) + "\n" for entry in entries])
        )
    return "---\n".join(texts)


def _entry(entry: Field | Constant, line: str, dialect: Dialect) -> str:
    spelled = line.split(None, 1)[0]
    if isinstance(entry, Constant):
        return f"{spelled} {entry.name}={entry.text}"
    if entry.default is None:
        return f"{spelled} {entry.name}"
    # A default keeps its own spelling, which is all that stands after the name.
    default = line.partition("#")[0].split(None, 2)[2].strip()
    return f"{spelled} {entry.name} {default}"


def bundle(dialect: Dialect, texts: dict[TypeName, str]) -> dict[pathlib.Path, str]:
    """The files to write, by path."""
    interfaces = {name: parse(text, name, dialect, str(name)) for name, text in texts.items()}
    implied: set[TypeName] = set()
    for interface in interfaces.values():
        if isinstance(interface, Action) and dialect == "ros1":
            implied.update([message.name for message in interface.messages])
    folder = DEFINITIONS / dialect
    return {
        folder / name.package / name.kind / f"{name.name}.{name.kind}": bare(interface)
        for name, interface in sorted(interfaces.items())
        if name not in implied
    }


def write(dialect: Dialect, files: dict[pathlib.Path, str], check: bool) -> int:
    """Writes what changed and removes what is gone from the packages found; returns how many files
    differed."""
    found = {path.parts[len(DEFINITIONS.parts) + 1] for path in files}
    for package in PACKAGES[dialect]:
        if package not in found:
            print(f"{dialect} {package}: not found, kept as it is")
    stale = [
        path
        for package in found
        for path in (DEFINITIONS / dialect / package).rglob("*.*")
        if path.is_file() and path not in files
    ]
    changed = [path for path, text in files.items() if not path.exists() or path.read_text("utf-8") != text]
    for path in [*stale, *changed]:
        print(f"{'differs' if check else 'writes'}: {path.relative_to(ROOT)}")
        if check:
            continue
        if path in files:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(files[path], "utf-8", newline="\n")
        else:
            path.unlink()
    return len(stale) + len(changed)


def main() -> int:
    """The command; exit code 1 if `--check` found a difference."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--ros1", nargs="+", type=pathlib.Path, default=[], metavar="DIR")
    parser.add_argument("--ros1-python", metavar="PYTHON")
    parser.add_argument("--ros2", nargs="+", type=pathlib.Path, default=[], metavar="DIR")
    parser.add_argument(
        "--check", action="store_true", help="write nothing; exit 1 if something would change"
    )
    options = parser.parse_args()
    ros1 = read_directories("ros1", options.ros1)
    if options.ros1_python:
        missing = sorted(set(PACKAGES["ros1"]) - {name.package for name in ros1})
        ros1.update(read_generated(options.ros1_python, missing))
    differing = write("ros1", bundle("ros1", ros1), options.check)
    differing += write("ros2", bundle("ros2", read_directories("ros2", options.ros2)), options.check)
    print(f"{differing} files {'differ' if options.check else 'written or removed'}")
    return 1 if options.check and differing else 0


if __name__ == "__main__":
    sys.exit(main())
