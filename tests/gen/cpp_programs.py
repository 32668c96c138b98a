"""Test programs in C++, of the headers that `roslet gen cpp` makes of many types: made once a run, beside each other, by
several compilers; and values as the words that such a program reads and prints."""

from __future__ import annotations

import atexit
import os
import pathlib
import shutil
import struct
import subprocess
import tempfile
import threading
from typing import Any

import pytest

from peers import find
from roslet.gen.collect import collect
from roslet.gen.cpp import write_headers
from roslet.gen.cpp_bounds import Bounds
from roslet.gen.cpp_names import full_name, header_path, members, struct_name
from roslet.idl import Interface, Message, Registry, TypeName
from roslet.idl.records import FieldType
from roslet.idl.spelling import KINDS

HERE = pathlib.Path(__file__).resolve().parent
STRICT = ("-std=c++17", "-Wall", "-Wextra", "-Werror", "-fno-exceptions", "-fno-rtti")

COMPILERS: dict[str, tuple[str, ...]] = {
    "g++": ("g++", "-fsyntax-only"),
    "clang++ with sanitizers": (
        "clang++",
        "-O0",
        "-fsanitize=address,undefined",
        "-fno-sanitize=vptr",
        "-fno-sanitize-recover=all",
    ),
    "32-bit ARM Linux": ("arm-linux-gnueabihf-g++", "-O0", "-static"),
    "Cortex-M4": ("arm-none-eabi-g++", "-Os", "-mcpu=cortex-m4", "-mthumb", "-ffreestanding"),
    "Cortex-A9": ("arm-none-eabi-g++", "-O0", "-mcpu=cortex-a9", "-ffreestanding"),
}
"""Name -> program and options. One optimizes, which takes most of the time; of g++ the ARM ones make code."""

JOBS = (
    ("clang++ with sanitizers", "program"),
    ("32-bit ARM Linux", "program"),
    ("Cortex-M4", "table"),
    ("g++", "table"),
    ("Cortex-A9", "table"),
)

# What random_values makes fits: texts of 140 characters, most of four octets, and six elements.
BOUNDS = Bounds(string=600, sequence=6)

ODD = HERE / "cpp_msgs"  # a package of ours for each dialect, with all that is unusual

_SLOTS = threading.Semaphore(os.cpu_count() or 1)


def require(compiler: str) -> None:
    """Skip the test where the compiler is absent."""
    command = COMPILERS[compiler][0]
    if shutil.which(command) is None:
        pytest.skip(f"the compiler {command} is absent; `make peers` installs it")


class Job:
    """A compilation in the background."""

    def __init__(self, command: list[str]) -> None:
        self.command = command
        self.done: subprocess.CompletedProcess[str] | None = None
        self.thread = threading.Thread(target=self._run, daemon=True)
        self.thread.start()

    def _run(self) -> None:
        with _SLOTS:
            self.done = subprocess.run(self.command, capture_output=True, text=True, check=False)

    def wait(self) -> None:
        """Fails with what the compiler said, if it said anything."""
        self.thread.join()
        assert self.done is not None
        assert self.done.returncode == 0 and not self.done.stderr, (self.command, self.done.stderr[:5000])


class Build:
    """The headers of `names` in a folder of their own, and programs that know them all. `messages` are the types in the
    order of their numbers."""

    def __init__(self, registry: Registry, names: list[TypeName], bounds: Bounds = BOUNDS) -> None:
        self.registry = registry
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="roslet-cpp-"))
        atexit.register(shutil.rmtree, self.folder, True)
        write_headers(self.folder, registry, names, bounds)
        found: dict[str, Interface] = {}
        for name in names:
            collect(registry, registry.interface(name), found)
        self.messages = [one for one in found.values() if isinstance(one, Message)]
        self.numbers = {message.name: number for number, message in enumerate(self.messages)}
        paths = sorted(
            str(path.relative_to(self.folder))
            for path in self.folder.rglob("*.hpp")
            if path.parent.name != "roslet"
        )
        includes = "".join([f'#include "{path}"\n' for path in paths])
        (self.folder / "table.cpp").write_text(includes + self._table())
        (self.folder / "program.cpp").write_text(includes + self._program())
        self.jobs: dict[tuple[str, str], Job] = {}

    def _full(self, message: Message) -> str:
        return full_name(message.name, self.registry.dialect)

    def _table(self) -> str:
        """A unit without a main that has the code of all types, for compilers whose programs do not run here."""
        rows = "".join([f"    row<{self._full(message)}>,\n" for message in self.messages])
        return (
            "struct Row {\n"
            "    roslet::Result (*serialize)(const void*, roslet::Span<std::uint8_t>);\n"
            "    roslet::Result (*deserialize)(void*, roslet::Span<const std::uint8_t>);\n"
            "    const char* (*field_name)(std::size_t);\n"
            "};\n"
            "template <class T>\n"
            "constexpr Row row{\n"
            "    [](const void* m, roslet::Span<std::uint8_t> b) { return static_cast<const T*>(m)->serialize(b); },\n"
            "    [](void* m, roslet::Span<const std::uint8_t> b) { return static_cast<T*>(m)->deserialize(b); },\n"
            "    T::field_name};\n"
            f"extern const Row rows[];\nconst Row rows[] = {{\n{rows}}};\n"
        )

    def _program(self) -> str:
        identity = "md5sum" if self.registry.dialect == "ros1" else "type_hash"
        lines = ['#include "cpp_harness.hpp"\n']
        for message in self.messages:
            taken = [field.name for field in message.fields] + [
                constant.name for constant in message.constants
            ]
            names = members(struct_name(message.name), dict.fromkeys(taken))
            calls = " ".join([f"v(m.{names[field.name]});" for field in message.fields])
            visitor, value = ("v", "m") if calls else ("", "")
            lines.append(
                f"template <> struct Fields<{self._full(message)}> {{ "
                f"static void each(Visitor& {visitor}, {self._full(message)}& {value}) {{ {calls} }} }};\n"
            )
        lines.append("static const Row rows[] = {\n")
        lines += [
            f"    row<{self._full(message)}>({self._full(message)}::{identity}),\n"
            for message in self.messages
        ]
        lines.append("};\nint main() { return serve(rows); }\n")
        return "".join(lines)

    def start(self, compiler: str, source: str) -> Job:
        """Begin to compile `source` ("table", an object; "program", a program), unless that was begun before."""
        key = (compiler, source)
        if key not in self.jobs:
            output = self.output(compiler, source)
            options = [*COMPILERS[compiler], *STRICT, f"-I{self.folder}", f"-I{HERE}"]
            command = [*options, str(self.folder / (source + ".cpp")), "-o", str(output)]
            self.jobs[key] = Job([*command, "-c"] if source == "table" else command)
        return self.jobs[key]

    def output(self, compiler: str, source: str) -> pathlib.Path:
        """The file that is made."""
        return self.folder / f"{source}-{list(COMPILERS).index(compiler)}"

    def header(self, name: str) -> str:
        """The text of a message's header."""
        path = header_path(self.registry.interface(name).name, self.registry.dialect)
        return (self.folder / path).read_text(encoding="utf-8")


_SHARED: dict[Any, Build] = {}


def shared(dialect: Any) -> Build:
    """The build of every bundled type of a dialect, of the package `odd_msgs`, and of test_msgs where it is."""
    if dialect not in _SHARED:
        registry = Registry(dialect, None)
        names: list[TypeName] = []
        for kind in KINDS:
            names += registry.names(kind)
        names += registry.load(ODD / dialect)
        test_msgs = find("kilted-test-msgs") if dialect == "ros2" else None
        if test_msgs is not None:
            names += registry.load(test_msgs)
        _SHARED[dialect] = Build(registry, names)
    return _SHARED[dialect]


def begin() -> None:
    """Let all compilers that are there begin with the shared builds: while one test waits for its own, others go on."""
    for compiler, source in JOBS:
        if shutil.which(COMPILERS[compiler][0]) is not None:
            for dialect in ("ros1", "ros2"):
                shared(dialect).start(compiler, source)


class Program:
    """A running test program. `emulator` is the command before it."""

    def __init__(self, build: Build, compiler: str, *emulator: str) -> None:
        build.start(compiler, "program").wait()
        self.build = build
        self.process = subprocess.Popen(
            [*emulator, str(build.output(compiler, "program"))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def ask(self, command: str, message: Message | TypeName, words: str = "") -> str:
        """The answer to one command of `serve` in cpp_harness.hpp."""
        stdin, stdout = self.process.stdin, self.process.stdout
        assert stdin is not None and stdout is not None
        name = message.name if isinstance(message, Message) else message
        stdin.write(f"{command} {self.build.numbers[name]} {words}\n")
        stdin.flush()
        line = stdout.readline()
        assert line.endswith("\n"), (
            f"the program died with code {self.process.wait()}: {command} {name} {words}"
        )
        return line.rstrip("\n")

    def close(self) -> None:
        """End it; it must have had nothing to complain of."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.close()
        assert self.process.wait(20) == 0
        self.process.stdout.close()


def words(registry: Registry, message: Message, value: dict[str, Any]) -> str:
    """The neutral values of random_values as the programs have them."""
    made: list[str] = []
    _message(registry, message, value, made)
    return " ".join(made)


def _message(registry: Registry, message: Message, value: dict[str, Any], made: list[str]) -> None:
    for field in message.fields:
        kind, given = field.type, value[field.name]
        if kind.array is None:
            _one(registry, kind, given, made)
            continue
        if kind.array.kind != "fixed":
            made.append(str(len(given)))
        for one in given:
            _one(registry, kind, one, made)


def _one(registry: Registry, kind: FieldType, value: Any, made: list[str]) -> None:
    if kind.message is not None:
        _message(registry, registry.message(kind.message), value, made)
    elif kind.primitive in ("time", "duration"):
        made += [str(value["secs"]), str(value["nsecs"])]
    elif kind.primitive == "string":
        made.append("x" + value.encode().hex())
    elif kind.primitive == "wstring":
        made.append("x" + value.encode("utf-16-be").hex())
    elif kind.primitive == "float32":
        made.append(str(struct.unpack("<I", struct.pack("<f", value))[0]))
    elif kind.primitive == "float64":
        made.append(str(struct.unpack("<Q", struct.pack("<d", value))[0]))
    else:
        made.append(str(int(value)))
