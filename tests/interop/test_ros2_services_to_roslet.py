"""Clients of rclpy and of Cyclone's dialect call our server."""

from __future__ import annotations

import pathlib

import pytest

from interop import ros2


@pytest.mark.parametrize("peer", ["kilted", "jazzy", "cyclone"])
def test_every_call_is_answered(tmp_path: pathlib.Path, peer: str) -> None:
    ros2.check_server(tmp_path, peer)


def test_clients_of_both_dialects_are_answered_at_once(tmp_path: pathlib.Path) -> None:
    ros2.check_server(tmp_path, "kilted", "cyclone", "jazzy")
