"""How much there is of each: what is installed, the sections of a compiled program, the memory of a process."""

from __future__ import annotations

import json
import os
import pathlib
import shutil
import subprocess
from typing import TYPE_CHECKING, Any

import roslet
from roslet.cli.bench import compiled
from roslet.cli.bench.stacks import DEBIAN_PYTHON, rclpy_python
from roslet.cli.demo.programs import cyclone_python
from roslet.cli.process import environment

if TYPE_CHECKING:
    from collections.abc import Iterable

# Asks an interpreter what of its distributions a package needs, and how many bytes their files have.
ASK = """
import importlib.metadata, json, os, re, sys
names, waiting, total = set(), sys.argv[1:], 0
while waiting:
    name = re.match(r"[\\w.-]+", waiting.pop()).group().lower().replace("_", "-")
    if name in names:
        continue
    try:
        found = importlib.metadata.distribution(name)
    except importlib.metadata.PackageNotFoundError:
        continue
    names.add(name)
    waiting += [one for one in found.requires or [] if "extra ==" not in one]
    for file in found.files or []:
        path = found.locate_file(file)
        if os.path.isfile(path) and not str(path).endswith(".pyc"):
            total += os.path.getsize(path)
print(json.dumps([total, sorted(names)]))
"""
DEBIAN = ("libroscpp-dev", "python3-rospy")


def folder_bytes(folder: pathlib.Path, without: Iterable[str] = ("__pycache__",)) -> int:
    """Of the files below a folder."""
    left_out = set(without)
    total = 0
    for where, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if name not in left_out]
        total += sum(os.path.getsize(os.path.join(where, name)) for name in files)
    return total


def rooms(package: pathlib.Path) -> dict[str, int]:
    """Of roslet: all of it, and what a node needs, which is all but gates, simulation, command, master, rospy, rclpy."""
    return {
        "roslet, all of it": folder_bytes(package),
        "roslet, what a node needs": folder_bytes(
            package, ("__pycache__", "gateware", "sim", "cli", "compat", "examples", "master")
        ),
    }


def distribution(python: str, *names: str) -> tuple[int, list[str]] | None:
    """Bytes of distributions and what they need, and their names; None where that cannot be told."""
    done = subprocess.run(
        [python, "-c", ASK, *names],
        stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False, env=environment(),
    )  # fmt: skip
    if done.returncode:
        return None
    total, found = json.loads(done.stdout)
    return (total, found) if found else None


def debian(package: str) -> tuple[int, list[str]] | None:
    """Bytes of a Debian package with those of ROS that it needs, and their names; None where it is not installed."""
    if shutil.which("dpkg-query") is None:
        return None
    form = "${Package}\\t${Installed-Size}\\t${Depends}\\t${Homepage}\\n"
    done = subprocess.run(["dpkg-query", "-W", "-f", form], capture_output=True, text=True, check=False)
    known: dict[str, tuple[int, list[str], str]] = {}
    for line in done.stdout.splitlines():
        fields = line.split("\t")
        if len(fields) == 4 and fields[1].isdigit():
            needs = [
                one.split("|")[0].split()[0].split(":")[0] for one in fields[2].split(",") if one.strip()
            ]
            known[fields[0]] = (int(fields[1]) * 1024, needs, fields[3])
    if package not in known:
        return None
    names: set[str] = set()
    waiting = [package]
    while waiting:
        name = waiting.pop()
        if name in names or name not in known:
            continue
        if "ros.org" in known[name][2] or "/ros" in known[name][2]:
            names.add(name)
            waiting += known[name][1]
    return sum(known[name][0] for name in names), sorted(names)


def sections(program: pathlib.Path) -> tuple[int, int, int] | None:
    """text, data and bss of a compiled program; None where `size` is missing."""
    if shutil.which("size") is None:
        return None
    done = subprocess.run(["size", str(program)], capture_output=True, text=True, check=False)
    words = done.stdout.splitlines()[1].split() if done.returncode == 0 else []
    return (int(words[0]), int(words[1]), int(words[2])) if words else None


def given(found: dict[str, Any]) -> dict[str, Any]:
    """What `measure` takes, of what somebody else measured: that itself, or what `roslet gateware build --json` printed."""
    if "luts" not in found:
        return found
    return {"gates": {f"{found['design']} in gates, {found['device']}": found["luts"]["total"]}}


def measure(memory: dict[str, int], *given: dict[str, Any]) -> dict[str, Any]:
    """The tables. Each of `given` are sizes that others measured: {"sections": {NAME: [TEXT, DATA, BSS]}, "installed":
    {NAME: {"bytes": N, "what": TEXT}}, "gates": {NAME: LUTS}}, each of which may be absent."""
    installed: dict[str, dict[str, Any]] = {}
    for name, count in rooms(pathlib.Path(roslet.__file__).resolve().parent).items():
        installed[name] = {"bytes": count, "what": "without byte code; nothing else is needed but Python"}
    for name, python, packages in (
        (
            "rclpy with Fast DDS",
            rclpy_python(),
            ("ros-rclpy", "ros-rmw-fastrtps-cpp", "ros-common-interfaces"),
        ),
        ("cyclonedds", cyclone_python(), ("cyclonedds",)),
    ):
        if python is not None and python != DEBIAN_PYTHON:
            found = distribution(python, *packages)
            if found is not None:
                installed[name] = {
                    "bytes": found[0],
                    "what": f"{len(found[1])} wheels: {', '.join(packages)} and what they need",
                }
    for package in DEBIAN:
        found = debian(package)
        if found is not None:
            what = f"Debian: it and {len(found[1]) - 1} others of ROS; not Boost, Python and the like"
            installed[package] = {"bytes": found[0], "what": what}
    compiled_sections: dict[str, list[int]] = {}
    try:
        roscpp = sections(compiled.program("roscpp_node", lambda text: None))
        if roscpp is not None:
            compiled_sections["roscpp"] = list(roscpp)
    except compiled.Absent:
        pass
    gates: dict[str, int] = {}
    for one in given:
        gates.update(one.get("gates", {}))
        installed.update(one.get("installed", {}))
        compiled_sections.update(one.get("sections", {}))
    return {"installed": installed, "sections": compiled_sections, "memory": memory, "gates": gates}
