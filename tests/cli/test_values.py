"""Messages and parameters from command-line text, with PyYAML and without."""

from __future__ import annotations

import sys
from typing import Any

import pytest

from roslet.cli.options import CommandError
from roslet.cli.values import build, read_document, read_value
from roslet.errors import InvalidMessage
from roslet.gen.runtime import message_class
from roslet.wire.time import Duration, Time

NOW = Time(100, 200)


def made(name: str, *arguments: str) -> Any:
    return build(message_class("ros1", name), arguments, lambda: Time(NOW.secs, NOW.nsecs))


@pytest.fixture(params=["with PyYAML", "without PyYAML"])
def yaml_or_not(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> bool:
    if request.param == "with PyYAML":
        return True
    monkeypatch.setitem(sys.modules, "yaml", None)
    return False


@pytest.mark.parametrize(
    "text, value",
    [
        ("5", 5), ("-0.5", -0.5), ("true", True), ("hello", "hello"), ("[1, 2.5]", [1, 2.5]),
        ('{"a": [true, null]}', {"a": [True, None]}), ('"5"', "5"), ("0x10", 16), ("", ""), ("null", None),
    ],
)  # fmt: skip
def test_a_value_means_the_same_with_and_without_pyyaml(text: str, value: Any, yaml_or_not: bool) -> None:
    assert read_value(text) == value


def test_what_looks_like_a_structure_and_is_none_is_refused(yaml_or_not: bool) -> None:
    with pytest.raises(CommandError, match="not YAML" if yaml_or_not else "not JSON"):
        read_value("[1, 2")


@pytest.mark.parametrize("text", ["!!int x", "!!bool x", "!!timestamp x", "2020-13-45", "[" * 3000])
def test_what_pyyaml_stumbles_over_is_refused_too(text: str) -> None:
    """Found by fuzz_values: these come out of PyYAML as ValueError, KeyError, AttributeError and RecursionError."""
    with pytest.raises(CommandError, match="not YAML"):
        read_value(text)
    with pytest.raises(CommandError, match=r"^file\.yaml: "):
        read_document(text, "file.yaml")


def test_deep_nesting_is_refused(yaml_or_not: bool) -> None:
    text = "[" * 100000
    with pytest.raises(CommandError, match="nested too deeply"):
        read_value(text)
    with pytest.raises(CommandError, match="nested too deeply"):
        read_document(text, "file")


def test_a_number_too_large_for_a_float_is_refused_with_its_place(yaml_or_not: bool) -> None:
    with pytest.raises(InvalidMessage, match=r"x: too large for a float"):
        made("geometry_msgs/Point", "x:=1" + "0" * 400)


def test_without_pyyaml_the_way_to_get_yaml_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "yaml", None)
    with pytest.raises(CommandError, match=r"pip install 'roslet\[cli\]'"):
        read_value("{a: 1}")
    with pytest.raises(CommandError, match=r"file\.yaml: .*pip install 'roslet\[cli\]'"):
        read_document("a: 1\n", "file.yaml")
    assert read_document('{"a": 1}', "file.json") == {"a": 1}


def test_an_error_in_a_yaml_file_names_its_line() -> None:
    with pytest.raises(CommandError, match=r"file\.yaml: line 3, column 1: "):
        read_document("a: 1\nb: [\n", "file.yaml")


def test_fields_are_assigned_by_path(yaml_or_not: bool) -> None:
    twist = made("geometry_msgs/Twist", "linear.x:=0.5", "angular.z:=-1")
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == (0.5, 0.0, -1.0)


def test_a_string_field_takes_its_text_as_it_stands(yaml_or_not: bool) -> None:
    assert made("std_msgs/String", "data:=42").data == "42"
    assert made("std_msgs/String", "data:=a: b").data == "a: b"
    assert made("std_msgs/String", "data:='quoted'").data == ("quoted" if yaml_or_not else "'quoted'")
    assert made("std_msgs/String", "42").data == "42"


def test_a_mapping_sets_some_fields_and_an_assignment_comes_after_it(yaml_or_not: bool) -> None:
    point = made("geometry_msgs/Point", '{"x": 1, "y": 2}', "y:=3")
    assert (point.x, point.y, point.z) == (1.0, 3.0, 0.0)


def test_values_in_order_fill_all_fields(yaml_or_not: bool) -> None:
    point = made("geometry_msgs/Point", "1", "2", "3")
    assert (point.x, point.y, point.z) == (1.0, 2.0, 3.0)
    assert made("geometry_msgs/Point", "[1, 2, 3]") == point


def test_too_few_values_in_order_are_refused_with_the_fields() -> None:
    with pytest.raises(InvalidMessage, match=r"2 values for 3 fields \(x, y, z\)"):
        made("geometry_msgs/Point", "1", "2")


def test_now_and_auto_are_the_present_time(yaml_or_not: bool) -> None:
    message = made("geometry_msgs/PoseStamped", '{"header": "auto"}')
    assert message.header.stamp == NOW
    message = made("std_msgs/Header", "stamp:=now", "frame_id:=map")
    assert (message.stamp, message.frame_id) == (NOW, "map")


@pytest.mark.parametrize("text", ["1.5", "[1, 500000000]", '{"secs": 1, "nsecs": 500000000}'])
def test_a_duration_may_be_given_in_three_ways(text: str, yaml_or_not: bool) -> None:
    assert made("std_msgs/Duration", f"data:={text}").data == Duration(1, 500000000)
    assert made("std_msgs/Duration", "data.secs:=3").data == Duration(3, 0)


def test_nested_arrays_of_messages_are_built() -> None:
    path = made("nav_msgs/Path", '{"poses": [{"pose": {"position": {"x": 1}}}, {}]}')
    assert [pose.pose.position.x for pose in path.poses] == [1.0, 0.0]
    assert type(path).deserialize(path.serialize()).poses[0].pose.position.x == 1.0


def test_scalars_that_yaml_reads_as_text_are_floats_where_a_float_is_wanted(yaml_or_not: bool) -> None:
    assert made("std_msgs/Float64", "data:=1e-3").data == 0.001
    assert made("std_msgs/Float32", "data:=Infinity").data == float("inf")


@pytest.mark.parametrize(
    "name, arguments, complaint",
    [
        ("geometry_msgs/Point", ["w:=1"], "has no field w; it has x, y, z"),
        ("geometry_msgs/Pose", ["position.w:=1"], "position has no field w"),
        ("geometry_msgs/Pose", ["position.x.y:=1"], "position.x has no field y"),
        ("geometry_msgs/Pose", ['{"position": {"w": 1}}'], "position.w: no such field"),
        ("geometry_msgs/Pose", ["position:=1"], "position: expected x, y, z, got 1"),
        ("nav_msgs/Path", ["poses:=1"], "poses: expected a list, got 1"),
        ("nav_msgs/Path", ['{"poses": [{"header": 5}]}'], r"poses[0].header: expected seq, stamp, frame_id"),
        ("std_msgs/Time", ["data:=soon"], "data: expected {secs, nsecs} or seconds"),
        ("std_msgs/Time", ["data:=-1"], "never negative"),
    ],
)
def test_what_does_not_fit_is_refused_with_its_place(name: str, arguments: list[str], complaint: str) -> None:
    with pytest.raises((CommandError, InvalidMessage)) as caught:
        made(name, *arguments)
    assert complaint in str(caught.value)


def test_a_value_out_of_range_is_refused_when_the_message_is_serialised() -> None:
    with pytest.raises(InvalidMessage, match="data"):
        made("std_msgs/UInt8", "data:=256").serialize()
