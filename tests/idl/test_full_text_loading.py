"""`Registry.load_full_text`: definitions that a connection header brought."""

from __future__ import annotations

import pytest

from roslet.errors import DefinitionError, InvalidName, UnknownType
from roslet.idl import ROS1, Registry, full_text, md5sum

RULE = "=" * 80

# As genpy writes it: a nested type of the same package is named with its package in the MSG line.
TEXT = f"""# what a robot is
Header header
Wheel[2] wheels   # both
uint8 MOST=2
{RULE}
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
{RULE}
MSG: robot_msgs/Wheel
float32 speed
"""


def test_a_full_text_defines_the_message_and_all_it_is_made_of() -> None:
    registry = Registry(ROS1, None)
    names = registry.load_full_text("robot_msgs/Robot", TEXT)
    assert [str(name) for name in names] == [
        "robot_msgs/msg/Robot",
        "robot_msgs/msg/Wheel",
        "std_msgs/msg/Header",
    ]
    robot = registry.message("robot_msgs/Robot")
    assert [field.name for field in robot.fields] == ["header", "wheels"]
    assert [field.name for field in registry.message("robot_msgs/Wheel").fields] == ["speed"]


@pytest.mark.parametrize(
    "name", ["sensor_msgs/Imu", "nav_msgs/Odometry", "std_msgs/Empty", "tf2_msgs/TFMessage"]
)
def test_a_full_text_read_back_has_the_hash_and_the_text_it_came_from(name: str) -> None:
    bundled = Registry(ROS1, None)
    renamed = "other_msgs/" + name.partition("/")[2]
    registry = Registry(ROS1, None)
    registry.load_full_text(renamed, full_text(bundled, name))
    assert md5sum(registry, renamed) == md5sum(bundled, name)
    assert full_text(registry, renamed) == full_text(bundled, name)


def test_what_is_loaded_comes_before_what_is_bundled() -> None:
    registry = Registry(ROS1, None)
    assert [field.name for field in registry.message("std_msgs/String").fields] == ["data"]
    registry.load_full_text("std_msgs/String", "string text\n")
    assert [field.name for field in registry.message("std_msgs/String").fields] == ["text"]


def test_a_section_without_a_name_is_refused_with_its_line() -> None:
    with pytest.raises(DefinitionError, match="expected MSG: package/Name") as caught:
        Registry(ROS1, None).load_full_text("a/B", f"int8 x\n{RULE}\nint8 y\n")
    assert caught.value.line == 3


def test_a_section_with_an_impossible_name_is_refused() -> None:
    with pytest.raises(InvalidName):
        Registry(ROS1, None).load_full_text("a/B", f"int8 x\n{RULE}\nMSG: ../../etc\nint8 y\n")


def test_a_missing_nested_definition_is_named() -> None:
    registry = Registry(ROS1, None)
    registry.load_full_text("a/B", "c/D d\n")
    with pytest.raises(UnknownType, match=r"message_definition of a/B.*unknown type c/D"):
        registry.message("a/B")


def test_an_error_in_a_loaded_text_names_where_it_came_from() -> None:
    registry = Registry(ROS1, None)
    registry.load_full_text("a/B", "int8 x\nint8\n")
    with pytest.raises(DefinitionError, match="message_definition of a/B"):
        registry.message("a/B")
