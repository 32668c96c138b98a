"""Builds fuzz_cpp.cpp with clang++ and runs it; the invariant is told there. An empty corpus gets good messages as seeds.

python fuzz/fuzz_cpp.py [libFuzzer options] [corpus]     every bundled type of both dialects
python fuzz/fuzz_cpp.py --smoke N                        N runs with a few types, which compile in seconds
"""

from __future__ import annotations

import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "src"))

from random_values import STYLES, Values, fill
from roslet.gen import runtime
from roslet.gen.collect import collect
from roslet.gen.cpp import write_headers
from roslet.gen.cpp_bounds import Bounds
from roslet.gen.cpp_names import full_name, header_path
from roslet.idl import Message, Registry

HERE = pathlib.Path(__file__).resolve().parent
SANITIZERS = "-fsanitize=fuzzer,address,undefined"
# As small as still nests: with these the largest messages stay in a fuzzer's memory.
BOUNDS = Bounds(string=20, sequence=3)
FEW = {
    "ros1": ["std_msgs/String", "nav_msgs/Odometry", "tf2_msgs/TFMessage", "diagnostic_msgs/DiagnosticArray"],
    "ros2": [
        "example_interfaces/msg/WString",
        "sensor_msgs/msg/JointState",
        "visualization_msgs/msg/Marker",
        "rcl_interfaces/msg/ParameterEvent",
        "rmw_dds_common/msg/ParticipantEntitiesInfo",
    ],
}


def write(folder: pathlib.Path, few: bool) -> list[tuple[str, str]]:
    """Write headers and the table of types; the dialect and name of each, in the order of their numbers."""
    types: list[tuple[str, str]] = []
    includes, rows = [], []
    for dialect in ("ros1", "ros2"):
        registry = Registry(dialect, None)
        names = (
            list(FEW[dialect])
            if few
            else [n for kind in ("msg", "srv", "action") for n in registry.names(kind)]
        )
        write_headers(folder, registry, names, BOUNDS)
        found = {}
        for name in names:
            collect(registry, registry.interface(name), found)
        for one in found.values():
            if isinstance(one, Message):
                types.append((dialect, one.name.text(dialect)))
                includes.append(f'#include "{header_path(one.name, dialect)}"\n')
                rows.append(f"    judge<{full_name(one.name, dialect)}>,\n")
    (folder / "types.inc").write_text(
        "".join(includes) + "static const Judge judges[] = {\n" + "".join(rows) + "};\n"
    )
    return types


def seed(corpus: pathlib.Path, types: list[tuple[str, str]]) -> None:
    """Good messages of every type, where there is nothing yet."""
    if any(corpus.iterdir()):
        return
    for number, (dialect, name) in enumerate(types):
        registry = Registry(dialect, None)
        kind = runtime.message_class(dialect, name)
        for style in ("random", "maximal"):
            value = Values(registry.message, STYLES.index(style), style).message(registry.message(name))
            data = bytes((number >> 8, number & 255)) + bytes(fill(kind, value).serialize())
            (corpus / f"{number}-{style}").write_bytes(data)


def main() -> int:
    arguments = sys.argv[1:]
    if shutil.which("clang++") is None:
        print("fuzz_cpp.py: no clang++ here; `make peers` installs it", file=sys.stderr)
        return 1
    smoke = arguments[:1] == ["--smoke"]
    if smoke:
        arguments = [f"-runs={arguments[1]}", "-seed=1"]
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        types = write(folder, smoke)
        if smoke:
            (folder / "corpus").mkdir()
            arguments.append(str(folder / "corpus"))
        for argument in arguments:
            if not argument.startswith("-"):
                seed(pathlib.Path(argument), types)
        program = folder / "fuzz_cpp"
        options = [
            "-std=c++17",
            "-O1" if smoke else "-O0",
            "-gline-tables-only",
            SANITIZERS,
            "-fno-sanitize=vptr",
            "-fno-sanitize-recover=all",
        ]
        more = ["-fno-exceptions", "-fno-rtti", f"-I{folder}", str(HERE / "fuzz_cpp.cpp"), "-o", str(program)]
        subprocess.run(["clang++", *options, *more], check=True)
        return subprocess.run([str(program), "-max_len=4096", *arguments], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
