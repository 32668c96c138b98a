"""Our client calls servers of rclpy and of Cyclone's dialect."""

from __future__ import annotations

import pathlib

import pytest

from interop import ros2


@pytest.mark.parametrize("peer", ["kilted", "jazzy", "cyclone"])
def test_every_call_is_answered(tmp_path: pathlib.Path, peer: str) -> None:
    ros2.check_client(tmp_path, peer)
