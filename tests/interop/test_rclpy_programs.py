"""Unmodified rclpy programs say what is expected of them with the other end under the other one: rclpy, and `roslet run`."""

from __future__ import annotations

import pathlib

import pytest

from compat.rclpy_scenes import SCENES, file_of, play, rclpy, roslet
from compat.test_rclpy_programs import NOT_JAZZY

pytestmark = pytest.mark.beside

SHARED = [scene for scene, programs in SCENES.items() if len(programs) > 1]


@pytest.mark.parametrize("scene", SHARED)
def test_the_first_under_kilted_the_second_under_roslet(scene: str, tmp_path: pathlib.Path) -> None:
    said = play(scene, tmp_path, rclpy("kilted", scene), roslet())
    assert said == file_of(scene).read_text(encoding="utf-8")


@pytest.mark.parametrize("scene", SHARED)
def test_the_first_under_roslet_the_second_under_kilted(scene: str, tmp_path: pathlib.Path) -> None:
    said = play(scene, tmp_path, roslet(), rclpy("kilted", scene))
    assert said == file_of(scene).read_text(encoding="utf-8")


@pytest.mark.parametrize("scene", [scene for scene in SHARED if scene not in NOT_JAZZY])
def test_the_first_under_jazzy_the_second_under_roslet(scene: str, tmp_path: pathlib.Path) -> None:
    said = play(scene, tmp_path, rclpy("jazzy", scene), roslet())
    assert said == file_of(scene).read_text(encoding="utf-8")


@pytest.mark.parametrize("scene", [scene for scene in SHARED if scene not in NOT_JAZZY])
def test_the_first_under_roslet_the_second_under_jazzy(scene: str, tmp_path: pathlib.Path) -> None:
    said = play(scene, tmp_path, roslet(), rclpy("jazzy", scene))
    assert said == file_of(scene).read_text(encoding="utf-8")
