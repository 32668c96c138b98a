"""What a type costs on a board: code, data and static memory of a program that serializes and deserializes it.

python benchmarks/cpp_sizes.py                                       the types of docs/cpp.md
python benchmarks/cpp_sizes.py --dialect ros1 sensor_msgs --json     of a package, in JSON

Each type is compiled alone: the text has what of the support header it uses, which several types share; the last line says
what all take together. Nothing is linked: memcpy and memset come to it.
"""

from __future__ import annotations

import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
from typing import Any

from roslet.errors import RosletError
from roslet.gen.cpp import headers
from roslet.gen.cpp_bounds import SEQUENCE_BOUND, STRING_BOUND, Bounds, read_bounds
from roslet.gen.cpp_names import full_name, header_path
from roslet.idl import Message, Registry, TypeName

COMPILER = "arm-none-eabi-g++"
OPTIONS = "-Os -mcpu=cortex-m4 -mthumb"
STRICT = (
    "-std=c++17",
    "-fno-exceptions",
    "-fno-rtti",
    "-ffunction-sections",
    "-fdata-sections",
    "-ffreestanding",
)
COLUMNS = ("text", "data", "bss", "message", "buffer")
TYPES = {
    "ros1": [
        "std_msgs/String",
        "geometry_msgs/Twist",
        "sensor_msgs/Imu",
        "nav_msgs/Odometry",
        "sensor_msgs/LaserScan",
    ],
    "ros2": [
        "std_msgs/msg/String",
        "geometry_msgs/msg/Twist",
        "sensor_msgs/msg/Imu",
        "nav_msgs/msg/Odometry",
        "sensor_msgs/msg/LaserScan",
        "sensor_msgs/msg/JointState",
        "tf2_msgs/msg/TFMessage",
        "rcl_interfaces/msg/ParameterEvent",
    ],
}


def source(dialect: Any, number: int, name: TypeName) -> str:
    """A unit that has one message, one buffer, and a function for each direction."""
    kind = full_name(name, dialect)
    return (
        f'#include "{header_path(name, dialect)}"\n'
        f"{kind} message{number};\n"
        f"std::uint8_t buffer{number}[{kind}::max_serialized_size + ({kind}::max_serialized_size == 0)];\n"
        f"std::size_t publish{number}() {{ return message{number}.serialize(buffer{number}).size; }}\n"
        f"bool receive{number}(std::size_t size) {{ return bool(message{number}.deserialize({{buffer{number}, size}})); }}\n"
    )


class Measure:
    """Compiles in a folder that has the headers."""

    def __init__(self, folder: pathlib.Path, compiler: str, options: str) -> None:
        self.folder = folder
        self.command = [compiler, *options.split(), *STRICT, f"-I{folder}", "-c", "unit.cpp", "-o", "unit.o"]
        self.prefix = compiler.removesuffix("clang++").removesuffix("g++")

    def sizes(self, text: str) -> tuple[int, int, int]:
        """Text (with constants), data and bss."""
        (self.folder / "unit.cpp").write_text(text)
        subprocess.run(self.command, cwd=self.folder, check=True)
        command = [self.prefix + "size", "unit.o"]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=True)
        made, data, bss = map(int, done.stdout.splitlines()[1].split()[:3])
        return made, data, bss

    def symbols(self) -> dict[str, int]:
        """The sizes of what was compiled last, by name."""
        command = [self.prefix + "nm", "-S", "unit.o"]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=True)
        rows = [line.split() for line in done.stdout.splitlines()]
        return {row[3]: int(row[1], 16) for row in rows if len(row) == 4}


def rows(arguments: argparse.Namespace, folder: pathlib.Path) -> list[dict[str, Any]]:
    """A row for each type, and one for all together."""
    dialect = arguments.dialect
    registry = Registry(dialect)
    for path in arguments.types:
        registry.load(path)
    names: list[TypeName] = []
    for given in arguments.names or TYPES[dialect]:
        if "/" in given:
            names.append(registry.interface(given).name)
        else:
            names += registry.names("msg", given)
    at = {}
    if arguments.bounds is not None:
        at = read_bounds(
            pathlib.Path(arguments.bounds).read_text(encoding="utf-8"), registry, arguments.bounds
        )
    bounds = Bounds(arguments.string_bound, arguments.sequence_bound, at)
    for path, text in headers(registry, names, bounds).items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
    measure = Measure(folder, arguments.compiler, arguments.options)
    found: list[dict[str, Any]] = []
    together = ""
    for number, name in enumerate(names):
        if not isinstance(registry.interface(name), Message):
            raise RosletError(f"{name} is no message; name its parts")
        unit = source(dialect, number, name)
        together += unit
        sections = measure.sizes(unit)
        symbols = measure.symbols()
        static = (symbols[f"message{number}"], symbols[f"buffer{number}"])
        found.append(dict(zip(COLUMNS, (*sections, *static), strict=True), type=name.text(dialect)))
    totals = (sum(row["message"] for row in found), sum(row["buffer"] for row in found))
    found.append(dict(zip(COLUMNS, (*measure.sizes(together), *totals), strict=True), type="all of these"))
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description="Code and static memory of types in C++.")
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="a message, or a package; default: those of docs/cpp.md"
    )
    parser.add_argument("--dialect", choices=("ros1", "ros2"), default="ros2")
    parser.add_argument("--types", metavar="DIR", action="append", default=[], help="load definitions")
    parser.add_argument("--compiler", default=COMPILER, help="default: %(default)s")
    parser.add_argument("--options", default=OPTIONS, help='its options (default "%(default)s")')
    parser.add_argument("--string-bound", metavar="N", type=int, default=STRING_BOUND)
    parser.add_argument("--sequence-bound", metavar="N", type=int, default=SEQUENCE_BOUND)
    parser.add_argument("--bounds", metavar="FILE", help="bounds of single fields")
    parser.add_argument("--json", action="store_true", help="print JSON")
    arguments = parser.parse_args()
    if shutil.which(arguments.compiler) is None:
        print(f"no {arguments.compiler} here: --compiler names another", file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory() as folder:
        found = rows(arguments, pathlib.Path(folder))
    if arguments.json:
        print(json.dumps(found))
        return 0
    print("| type | " + " | ".join(COLUMNS) + " |")
    print("|---|" + "---:|" * len(COLUMNS))
    for row in found:
        print(f"| {row['type']} | " + " | ".join([str(row[column]) for column in COLUMNS]) + " |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
