"""`roslet.load`: the dialect of what was loaded, and what is said of definitions that are wrong."""

from __future__ import annotations

import pathlib
from typing import Any

import pytest

import roslet
from roslet.errors import DefinitionError
from roslet.gen.runtime import message_class, message_class_of


def package(folder: pathlib.Path, name: str, build_tool: str = "", **messages: str) -> pathlib.Path:
    root = folder / name
    (root / "msg").mkdir(parents=True)
    for message, text in messages.items():
        (root / "msg" / f"{message}.msg").write_text(text)
    if build_tool:
        text = f"<package><name>{name}</name><buildtool_depend>{build_tool}</buildtool_depend></package>"
        (root / "package.xml").write_text(text)
    return root


@pytest.mark.parametrize(
    ("name", "build_tool", "text", "dialect"),
    [
        ("load_a", "catkin", "int32 x", "ros1"),
        ("load_b", "ament_cmake", "int32 x", "ros2"),
        ("load_c", "", "int32 x", "ros2"),
        ("load_d", "", "Header header", "ros1"),
        ("load_e", "", "time stamp", "ros1"),
        ("load_f", "", "std_msgs/Header header", "ros2"),
        ("load_g", "", "int32 x 3", "ros2"),
    ],
)
def test_the_dialect_is_that_of_the_build_tool_or_of_the_definitions(
    tmp_path: pathlib.Path, name: str, build_tool: str, text: str, dialect: str
) -> None:
    types = roslet.load(package(tmp_path, name, build_tool, Thing=text))
    assert types.dialect == dialect
    assert getattr(types, name).msg.Thing is types.message(f"{name}/Thing")


def test_a_field_of_an_unknown_type_is_named_by_the_import(tmp_path: pathlib.Path) -> None:
    types = roslet.load(package(tmp_path, "load_h", "catkin", Thing="\n  Nothing field"))
    with pytest.raises(ImportError, match=r"Thing\.msg:2:3: unknown type load_h/Nothing"):
        _ = types.load_h.msg.Thing


def test_a_type_that_is_not_there_is_no_attribute(tmp_path: pathlib.Path) -> None:
    types = roslet.load(package(tmp_path, "load_i", "catkin", Thing="int32 x"))
    with pytest.raises(AttributeError, match=r"load_i\.msg' has no attribute 'Other'"):
        _ = types.load_i.msg.Other
    with pytest.raises(AttributeError, match="no package other was loaded"):
        _ = types.other


def test_what_a_peer_says_of_a_name_changes_nothing_for_others() -> None:
    kind: Any = message_class("ros1", "geometry_msgs/PointStamped")
    text = f"Point point\nstring note\n{'=' * 80}\nMSG: geometry_msgs/Point\nint16 x\n"
    theirs: Any = message_class_of("geometry_msgs/PointStamped", text)
    assert theirs(note="n").point.x == 0 and theirs._spec[0][1]._spec[0][1] == "int16"
    assert theirs.deserialize(theirs(note="n").serialize()).note == "n"
    assert theirs._md5sum != kind._md5sum and theirs._full_text == text
    other: Any = message_class_of("geometry_msgs/PointStamped", "int8 other\n")
    assert other(other=1).serialize() == b"\1"
    assert message_class("ros1", "geometry_msgs/PointStamped") is kind
    assert message_class("ros1", "geometry_msgs/Point")._spec[0][1] == "float64"
    assert kind._md5sum == "c63aecb41bfdfd6b7e1fac37c7cbe7bf"


@pytest.mark.parametrize("text", ["Thing thing\n", "int32\n", f"int32 x\n{'=' * 80}\nno name\n"])
def test_a_wrong_definition_of_a_peer_is_refused(text: str) -> None:
    with pytest.raises(DefinitionError):
        message_class_of("load_peer/Robot", text)
