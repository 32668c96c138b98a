"""Every message of Debian's packages prints as rospy prints it."""

from __future__ import annotations

import json
import os
import pathlib
import subprocess
import sys

import pytest

import peers

SHARE = pathlib.Path("/usr/share")
PACKAGES = (
    "std_msgs",
    "geometry_msgs",
    "sensor_msgs",
    "nav_msgs",
    "diagnostic_msgs",
    "trajectory_msgs",
    "visualization_msgs",
    "actionlib_msgs",
    "tf2_msgs",
    "shape_msgs",
    "stereo_msgs",
    "rosgraph_msgs",
)

# Reads lines `pkg/Name hex`, writes each message's text as JSON.
READER = """
import importlib, json, sys
for line in sys.stdin:
    name, data = line.split(" ")
    package, kind = name.split("/")
    cls = getattr(importlib.import_module(package + ".msg"), kind)
    data = bytes.fromhex(data)
    received = cls().deserialize(data)
    types = {field: type(getattr(received, field)).__name__ for field in cls.__slots__}
    made = {field: type(getattr(cls(), field)).__name__ for field in cls.__slots__}
    print(json.dumps([str(received), str(cls()), cls._slot_types, types, made, cls._md5sum]))
"""

OURS = f"""
from roslet.compat import finder
finder.install()
{READER}
"""


def samples() -> list[str]:
    """Lines for the readers: every type, in several styles of random values."""
    from random_values import STYLES, Values, fill
    from roslet.gen.runtime import message_class
    from roslet.idl import Registry

    registry = Registry("ros1", {})
    lines = []
    for package in PACKAGES:
        for name in registry.names("msg", package):
            record = registry.message(name)
            for seed, style in enumerate(STYLES):
                value = Values(registry.message, seed, style).message(record)
                data = fill(message_class("ros1", f"{package}/{name.name}"), value).serialize()
                lines.append(f"{package}/{name.name} {data.hex()}")
    return lines


def read(python: str | os.PathLike[str], program: str, lines: list[str], path: str) -> list[list[object]]:
    done = subprocess.run(
        [os.fspath(python), "-c", program],
        input="\n".join(lines),
        capture_output=True,
        text=True,
        check=False,
        timeout=100,
        env={"PATH": os.environ["PATH"], "PYTHONPATH": path, "PYTHONIOENCODING": "utf-8:surrogateescape"},
    )
    assert done.returncode == 0, done.stderr[-3000:]
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.timeout(110)
def test_every_type_prints_and_is_typed_as_genpy_has_it() -> None:
    peers.require("genpy")
    lines = samples()
    ours = read(sys.executable, OURS, lines, str(peers.ROOT / "src"))
    theirs = read(peers.DEBIAN_PYTHON, READER, lines, "")
    assert len(ours) == len(theirs) == len(lines) > 500
    for line, mine, judge in zip(lines, ours, theirs, strict=True):
        assert mine == judge, line
