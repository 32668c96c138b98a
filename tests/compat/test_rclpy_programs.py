"""Programs in the idiom of rclpy's examples: what they say is what real rclpy makes them say, and what roslet makes them say."""

from __future__ import annotations

import pathlib

import pytest

from compat.rclpy_scenes import PROGRAMS, SCENES, file_of, under_rclpy

# What Jazzy's rclpy does not have yet, or does otherwise.
NOT_JAZZY: tuple[str, ...] = ()


@pytest.mark.parametrize("scene", SCENES)
def test_kilted_says_what_is_expected(scene: str, tmp_path: pathlib.Path) -> None:
    assert under_rclpy("kilted", scene, tmp_path) == file_of(scene).read_text(encoding="utf-8")


@pytest.mark.parametrize("scene", [scene for scene in SCENES if scene not in NOT_JAZZY])
def test_jazzy_says_what_is_expected(scene: str, tmp_path: pathlib.Path) -> None:
    assert under_rclpy("jazzy", scene, tmp_path) == file_of(scene).read_text(encoding="utf-8")


def test_every_program_is_run() -> None:
    run = {command[0] for commands in SCENES.values() for command in commands}
    assert run == {path.name for path in PROGRAMS.glob("*.py")}
