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
        ("load_d", "", "Header header\ntime stamp", "ros2"),
        ("load_e", "", "int32 Capital", "ros1"),
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


def test_one_definition_is_read_for_both_networks(tmp_path: pathlib.Path) -> None:
    text = "Header header\ntime[] stamps\nduration[2] spans\nPart[] parts"
    roslet.load(package(tmp_path, "load_both", "catkin", Thing=text, Part="time at\nduration takes"))
    same = "std_msgs/Header header\nbuiltin_interfaces/Time[] stamps\nbuiltin_interfaces/Duration[2] spans\nPart[] parts"
    part = "builtin_interfaces/Time at\nbuiltin_interfaces/Duration takes"
    there: Any = message_class("ros2", "load_both/msg/Thing")
    assert there.__slots__ == message_class("ros1", "load_both/Thing").__slots__
    hashes = there._type_hash, message_class("ros2", "load_both/msg/Part")._type_hash
    # As a peer has it that read the definition in ROS 2's own words.
    roslet.load(package(tmp_path / "again", "load_both", "ament_cmake", Thing=same, Part=part))
    theirs = message_class("ros2", "load_both/msg/Thing"), message_class("ros2", "load_both/msg/Part")
    assert theirs[0] is not there and hashes == (theirs[0]._type_hash, theirs[1]._type_hash)
    value = there(stamps=[roslet.Time(1, 2)], spans=[roslet.Duration(-0.5), roslet.Duration(3)])
    assert theirs[0].deserialize(value.serialize()).serialize() == value.serialize()


def test_a_package_with_a_header_of_its_own_keeps_it_on_ros_2(tmp_path: pathlib.Path) -> None:
    texts = {"Header": "int8 own", "Thing": "Header header\nHeader[] more"}
    types = roslet.load(package(tmp_path, "load_header", "ament_cmake", **texts))
    thing: Any = types.load_header.msg.Thing()
    assert type(thing.header) is types.load_header.msg.Header
    # ROS 1 means std_msgs/Header by the bare word, and so does roslet there.
    theirs: Any = message_class("ros1", "load_header/Thing")
    assert theirs().header._type == "std_msgs/Header"


def test_what_one_network_refuses_serves_on_the_other(tmp_path: pathlib.Path) -> None:
    root = package(tmp_path, "load-hyphen", "catkin", Thing="int32 x")
    types: Any = roslet.load(root)
    assert types.dialect == "ros1" and types.message("load-hyphen/Thing")(x=1).serialize() == b"\1\0\0\0"
    with pytest.raises(DefinitionError, match="package load-hyphen"):
        roslet.load(root, "ros2")
    assert roslet.load(root, "ros1").dialect == "ros1"
    with pytest.raises(DefinitionError, match="no such file or directory"):
        roslet.load(tmp_path / "nothing")


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
