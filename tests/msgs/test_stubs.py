"""The stubs under src/roslet/msgs are what the definitions say today."""

from __future__ import annotations

import pathlib

from roslet.gen.stubs import write_bundled_stubs

MSGS = pathlib.Path(__file__).resolve().parents[2] / "src" / "roslet" / "msgs"


def test_regenerating_the_stubs_changes_nothing(tmp_path: pathlib.Path) -> None:
    write_bundled_stubs(tmp_path)
    made = {str(path.relative_to(tmp_path)): path.read_text() for path in tmp_path.rglob("*.pyi")}
    there = {str(path.relative_to(MSGS)): path.read_text() for path in MSGS.rglob("*.pyi")}
    assert sorted(made) == sorted(there)
    for path, text in made.items():
        assert text == there[path], f"{path}: run `python -m roslet.gen.stubs src/roslet/msgs`"


def test_every_bundled_package_has_stubs() -> None:
    assert (MSGS / "ros1" / "std_msgs" / "msg.pyi").exists()
    assert (MSGS / "ros2" / "example_interfaces" / "action.pyi").exists()
    assert len(list(MSGS.rglob("*.pyi"))) > 100
