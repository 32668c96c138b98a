"""Programs in the idiom of rclpy's examples say under `roslet run` what they say under rclpy: not a line is changed."""

from __future__ import annotations

import pathlib

import pytest

from compat.rclpy_scenes import PROGRAMS, SCENES, file_of, under_rclpy, under_roslet

# What Jazzy's rclpy does not have yet, or does otherwise: these scenes are Kilted's alone.
NOT_JAZZY = {
    "corners": "a call that is not answered in time gives None",
    "annotations": "rclpy.subscription has no MessageInfo",
    "late goals": "a goal that is executed without an executor raises",
    "member talker, member listener": "init is no context manager",
    "function talker, lambda listener": "the message info has no publisher_gid",
    "publishers": "publishers are no context managers",
    "timers": "there is no TimerInfo",
    "times": "durations have no arithmetic",
    "services": "tasks of one turn run in no order",
    "parameters": "types are printed by their names",
    "parameter clients": "files are read otherwise",
    "quality of service": "errors are printed otherwise",
    "executors": "tasks of one turn run in no order",
    "futures": "executors have no create_future",
    "logging": "rclpy.qos has no qos_profile_rosout_default",
    "contexts": "init is no context manager",
    "life of a node": "nodes are no context managers",
    "lifecycle nodes": "a transition that is not allowed raises",
    "managed node": "a transition that is not allowed raises",
    "no arguments": "types are printed by their names",
    "arguments": "types are printed by their names",
    "a file of parameters": "types are printed by their names",
}


@pytest.mark.beside
@pytest.mark.parametrize("scene", SCENES)
def test_roslet_says_what_is_expected(scene: str, tmp_path: pathlib.Path) -> None:
    assert under_roslet(scene, tmp_path) == file_of(scene).read_text(encoding="utf-8")


@pytest.mark.beside
@pytest.mark.parametrize("scene", SCENES)
def test_kilted_says_what_is_expected(scene: str, tmp_path: pathlib.Path) -> None:
    assert under_rclpy("kilted", scene, tmp_path) == file_of(scene).read_text(encoding="utf-8")


@pytest.mark.beside
@pytest.mark.parametrize("scene", [scene for scene in SCENES if scene not in NOT_JAZZY])
def test_jazzy_says_what_is_expected(scene: str, tmp_path: pathlib.Path) -> None:
    assert under_rclpy("jazzy", scene, tmp_path) == file_of(scene).read_text(encoding="utf-8")


def test_every_program_is_run() -> None:
    run = {command[0] for commands in SCENES.values() for command in commands}
    assert run == {path.name for path in PROGRAMS.glob("*.py")}
