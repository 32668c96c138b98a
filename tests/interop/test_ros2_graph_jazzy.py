"""Our graph and that of rclpy Jazzy, each as the other sees it."""

from __future__ import annotations

import pathlib

from interop import ros2


def test_each_lists_the_other_until_it_ends(tmp_path: pathlib.Path) -> None:
    ros2.check_graph(tmp_path, "jazzy")
