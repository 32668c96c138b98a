"""Where the real peers are: `tools/peers.sh` makes them, the tests ask for them here.

An absent peer is a loud skip on a developer's machine; where CI is set every skip is a failure (conftest.py).
"""

from __future__ import annotations

import os
import pathlib
import shutil

import pytest

CACHE = pathlib.Path(os.environ.get("ROSLET_PEERS") or pathlib.Path.home() / ".cache/roslet/peers")
DEBIAN_PYTHON = pathlib.Path("/usr/bin/python3")
ROOT = pathlib.Path(__file__).resolve().parent.parent
WORKSPACE = (
    ROOT / "tests" / "interop" / "peers" / "ws"
)  # the message packages that the ROS 1 peers are generated from

_LOCATIONS = {
    "kilted": CACHE / "kilted/bin/python",
    "kilted-test-msgs": CACHE / "kilted/share/test_msgs",
    "jazzy": CACHE / "jazzy/bin/python",
    "jazzy-test-msgs": CACHE / "jazzy/share/test_msgs",
    "cyclone": CACHE / "cyclone/bin/python",
    "roscpp": CACHE / "ros1/bin/roscpp_peer",
    "ros1-definitions": CACHE / "ros1-definitions/usr/share",
    "ros1-messages": CACHE / "ros1/python",
    "rospy": pathlib.Path("/usr/lib/python3/dist-packages/rospy"),
    "genpy": pathlib.Path("/usr/lib/python3/dist-packages/genpy"),
    "tshark": pathlib.Path("/usr/bin/tshark"),
    "ping": pathlib.Path("/usr/bin/ping"),
    "arping": pathlib.Path("/usr/bin/arping"),
    "rosmaster": pathlib.Path("/usr/bin/rosmaster"),
    "rostopic": pathlib.Path("/usr/bin/rostopic"),
    "rosnode": pathlib.Path("/usr/bin/rosnode"),
    "rosservice": pathlib.Path("/usr/bin/rosservice"),
    "rosparam": pathlib.Path("/usr/bin/rosparam"),
    "rosbag": pathlib.Path("/usr/bin/rosbag"),
    "roslaunch": pathlib.Path("/usr/bin/roslaunch"),
}


def find(peer: str) -> pathlib.Path | None:
    """Path of a peer's interpreter, program or folder; None when it is absent."""
    if peer == "micropython":
        beside = ROOT / ".venv" / "bin" / "micropython"
        found = str(beside) if beside.exists() else shutil.which("micropython")
        return pathlib.Path(found) if found else None
    path = _LOCATIONS[peer]
    return path if path.exists() else None


def require(peer: str) -> pathlib.Path:
    """As `find`, but an absent peer skips the test."""
    path = find(peer)
    if path is None:
        pytest.skip(f"the peer {peer!r} is absent; `make peers` installs it")
    return path
