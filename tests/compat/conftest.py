"""Fixtures of the rospy tests: a master, and the definitions of the programs as Debian's genpy generates them."""

from __future__ import annotations

import pathlib
import subprocess
from collections.abc import Iterator

import pytest

import peers
from compat.both import WORKSPACE, Both
from interop.ros1 import Master

GENPY = pathlib.Path("/usr/lib/genpy")


@pytest.fixture(scope="session", params=["debian", "roslet"])
def master(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Master]:
    """Debian's rosmaster, then ours."""
    started = Master(request.param, tmp_path_factory.mktemp(f"{request.param}-master"))
    yield started
    started.stop()


@pytest.fixture(scope="session")
def generated(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A folder with the Python package that genpy makes of our definitions, for $PYTHONPATH."""
    peers.require("genpy")
    folder = tmp_path_factory.mktemp("generated")
    package = folder / "beginner_tutorials"
    package.mkdir()
    (package / "__init__.py").touch()
    source = WORKSPACE / "beginner_tutorials"
    for kind in ("msg", "srv"):
        files = sorted((source / kind).glob(f"*.{kind}"))
        program = [str(peers.DEBIAN_PYTHON), str(GENPY / f"gen{kind}_py.py")]
        where = ["-p", "beginner_tutorials", "-o", str(package / kind)]
        includes = [f"-Ibeginner_tutorials:{source / 'msg'}", "-Istd_msgs:/usr/share/std_msgs/msg"]
        subprocess.run([*program, *map(str, files), *includes, *where], check=True, timeout=60)
        subprocess.run([*program, "--initpy", *where], check=True, timeout=60)
    # Of Debian's ROS, roslet gets this one library, which is plain Python, and nothing else.
    (folder / "libraries").mkdir()
    (folder / "libraries/actionlib").symlink_to("/usr/lib/python3/dist-packages/actionlib")
    return folder


@pytest.fixture(scope="session")
def judge(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Master]:
    """The master of what runs under rospy itself."""
    started = Master("debian", tmp_path_factory.mktemp("judge"))
    yield started
    started.stop()


@pytest.fixture(scope="session")
def both(judge: Master, master: Master, generated: pathlib.Path) -> Both:
    return Both(judge, master, generated)
