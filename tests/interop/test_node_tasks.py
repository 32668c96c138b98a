"""Actions and parameters between roslet's nodes and rclpy's, both directions: both say the same of each other."""

from __future__ import annotations

import json
import pathlib
import sys

import pytest

import peers
from interop.namespace import Namespace

PROGRAMS = peers.ROOT / "tests/interop/peers"
TYPES = peers.ROOT / "tests/compat/programs/rclpy/ws/test_msgs"
SAID = [
    "server True",
    "SUCCEEDED [0, 1, 1, 2, 3, 5] [0, 1, 1, 2, 3, 5]",
    "accepted False",
    "ABORTED [0, 1]",
    "canceling 1",
    "CANCELED True",
    "[2, 3, 4, 5, 6]",
    "parameters True",
    "1.0 ['a', 'b']",
    "[True, False, False] 1.5",
    "3 metres a second 2.0",
    "['names', 'speed']",
]


def command(peer: str, role: str) -> list[str]:
    if peer == "roslet":
        return [sys.executable, str(PROGRAMS / "roslet_tasks.py"), role, str(TYPES)]
    peers.require(f"{peer}-test-msgs")
    return [str(peers.require(peer)), str(PROGRAMS / "rclpy_tasks.py"), role]


@pytest.mark.parametrize(
    ("server", "client"),
    [
        ("roslet", "kilted"),
        ("kilted", "roslet"),
        ("roslet", "jazzy"),
        ("jazzy", "roslet"),
        ("roslet", "roslet"),
    ],
)
def test_goals_and_parameters_of_a_peer_are_as_good_as_ones_own(
    tmp_path: pathlib.Path, server: str, client: str
) -> None:
    with Namespace(tmp_path) as namespace:
        namespace.start(*command(server, "serve"), name="server").wait_for("serving")
        said = namespace.start(*command(client, "ask"), name="client").finish(90.0)
    assert said[:-1] == SAID[:-1]
    assert sorted(json.loads(said[-1].replace("'", '"'))) == ["names", "speed"]
