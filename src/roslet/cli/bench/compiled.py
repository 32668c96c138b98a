"""What has to be generated and compiled for the peers, kept in a cache outside the tree."""

from __future__ import annotations

import hashlib
import os
import pathlib
import shutil
import subprocess
from typing import TYPE_CHECKING

from roslet.cli.demo.programs import folder

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

GENCPP, GENPY = "/usr/lib/gencpp/gen_cpp.py", "/usr/lib/genpy/genmsg_py.py"
DEBIAN_PYTHON = "/usr/bin/python3"
PROGRAMS = pathlib.Path(__file__).with_name("programs")
# Seconds for the compiler, on a machine that others use.
PATIENCE = 600.0


class Absent(Exception):
    """The peer is not installed; the text says what is missing."""


def peers_folder() -> pathlib.Path:
    """Where `make peers` puts what it makes."""
    return pathlib.Path(os.environ.get("ROSLET_PEERS") or pathlib.Path.home() / ".cache/roslet/peers")


def cache() -> pathlib.Path:
    """A folder of our own in there, which is made."""
    path = peers_folder() / "bench"
    path.mkdir(parents=True, exist_ok=True)
    return path


def _need(*paths: str) -> None:
    for path in paths:
        if not os.path.exists(path):
            raise Absent(f"{path} is missing")


def _run(command: Sequence[str], what: str) -> str:
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    if done.returncode:
        raise Absent(f"{what}: {(done.stderr.strip().splitlines() or ['failed'])[-1]}")
    return done.stdout


def _generate(generator: str, output: pathlib.Path, *more: str) -> None:
    definitions = folder() / "msgs" / "mros_comm_measure" / "msg"
    output.mkdir(parents=True, exist_ok=True)
    words = ["-Imros_comm_measure:" + str(definitions), "-Istd_msgs:/usr/share/std_msgs/msg"]
    command = [
        DEBIAN_PYTHON,
        generator,
        str(definitions / "Coordinate.msg"),
        *words,
        "-p",
        "mros_comm_measure",
    ]
    _run([*command, "-o", str(output), *more], generator)


def genpy() -> pathlib.Path:
    """A folder for the path of rospy programs, with the package mros_comm_measure. Raises Absent."""
    _need(DEBIAN_PYTHON, "/usr/lib/python3/dist-packages/rospy", GENPY)
    path = cache() / "genpy"
    package = path / "mros_comm_measure"
    if not (package / "msg" / "__init__.py").exists():
        _generate(GENPY, package / "msg")
        output = str(package / "msg")
        _run([DEBIAN_PYTHON, GENPY, "--initpy", "-p", "mros_comm_measure", "-o", output], GENPY)
        (package / "__init__.py").touch()
    return path


def rclpy_coordinate(python: str, say: Callable[[str], None]) -> pathlib.Path:
    """A folder for the path of rclpy programs, with the type support of Coordinate, for an environment of wheels, in which
    `python` is. Compiles it where it is not there yet. Raises Absent."""
    inside = pathlib.Path(python).parent.parent
    asked = "import sysconfig; print(sysconfig.get_path('include')); print(sysconfig.get_config_var('EXT_SUFFIX'))"
    headers, suffix = _run([python, "-c", asked], python).split()
    _need(
        f"{inside}/include/fastcdr/Cdr.h",
        f"{inside}/include/rosidl_typesupport_fastrtps_cpp",
        f"{headers}/Python.h",
    )
    if shutil.which("g++") is None:
        raise Absent("g++ is missing")
    source = PROGRAMS / "rclpy_coordinate.cpp"
    stamp = hashlib.sha256(source.read_bytes() + python.encode()).hexdigest()[:16]
    path = cache() / stamp / ("rclpy_coordinate" + suffix)
    if not path.exists():
        say(f"compiling {source.name}")
        path.parent.mkdir(exist_ok=True)
        made = path.with_suffix(f".{os.getpid()}")
        include = [
            f"-I{inside}/include",
            f"-I{headers}",
            *(f"-I{one}" for one in sorted(inside.glob("include/*/"))),
        ]
        link = [f"-L{inside}/lib", "-lfastcdr", f"-Wl,-rpath,{inside}/lib"]
        flags = ["-O2", "-std=c++17", "-w", "-shared", "-fPIC", *include]
        _run(["g++", *flags, "-o", str(made), str(source), *link], str(source))
        made.rename(path)
    return path.parent


def program(name: str, say: Callable[[str], None]) -> pathlib.Path:
    """The compiled program of programs/NAME.cpp; compiles it where it is not there yet. Raises Absent."""
    _need(DEBIAN_PYTHON, GENCPP, "/usr/include/ros/ros.h")
    for tool in ("g++", "pkg-config"):
        if shutil.which(tool) is None:
            raise Absent(f"{tool} is missing")
    source = PROGRAMS / f"{name}.cpp"
    stamp = hashlib.sha256(source.read_bytes()).hexdigest()[:16]
    path = cache() / stamp / name
    if path.exists():
        return path
    say(f"compiling {source.name}")
    _generate(GENCPP, cache() / "include" / "mros_comm_measure", "-e", "/usr/share/gencpp")
    path.parent.mkdir(exist_ok=True)
    flags = _run(["pkg-config", "--cflags", "--libs", "roscpp"], "pkg-config roscpp").split()
    level = "-O2" if name == "roscpp_node" else "-O0"
    made = path.with_suffix(f".{os.getpid()}")
    _run(
        [
            "g++",
            level,
            "-std=c++17",
            "-w",
            f"-I{cache() / 'include'}",
            "-o",
            str(made),
            str(source),
            *flags,
            "-lpthread",
        ],
        str(source),
    )
    made.rename(path)
    return path
