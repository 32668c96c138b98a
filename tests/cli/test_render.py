"""Messages as plain data and as YAML; the judge of YAML is PyYAML."""

from __future__ import annotations

import json
import math
import struct
from typing import Any

import pytest
import yaml  # type: ignore[import-untyped,unused-ignore]
from hypothesis import given
from hypothesis import strategies as st

from roslet.cli.options import CommandError
from roslet.cli.output import json_text
from roslet.cli.render import Style, float_text, plain, select, shortest32, yaml_lines
from roslet.gen.runtime import message_class
from roslet.wire.time import Time


def ros1(name: str) -> Any:
    return message_class("ros1", name)


def text(value: Any) -> str:
    return "\n".join(yaml_lines(value))


def test_a_message_is_printed_as_people_know_it_from_rostopic() -> None:
    message = ros1("geometry_msgs/PointStamped")()
    message.header.frame_id = "map"
    message.header.stamp = Time(12, 5)
    message.point.x = 1.5
    assert text(plain(message)).splitlines() == [
        "header:",
        "  seq: 0",
        "  stamp:",
        "    secs: 12",
        "    nsecs: 5",
        '  frame_id: "map"',
        "point:",
        "  x: 1.5",
        "  y: 0.0",
        "  z: 0.0",
    ]


def test_arrays_of_numbers_take_a_line_and_arrays_of_messages_are_blocks() -> None:
    message = ros1("sensor_msgs/PointCloud")()
    point = ros1("geometry_msgs/Point32")
    channel = ros1("sensor_msgs/ChannelFloat32")
    message.points = [point(x=0.1), point(y=2.0)]
    message.channels = [channel(name="i", values=[0.5, 1.0])]
    assert text(plain(message)).splitlines()[6:] == [
        "points:",
        "  - x: 0.1",
        "    y: 0.0",
        "    z: 0.0",
        "  - x: 0.0",
        "    y: 2.0",
        "    z: 0.0",
        "channels:",
        '  - name: "i"',
        "    values: [0.5, 1.0]",
    ]


def test_empty_arrays_and_messages_are_valid_yaml() -> None:
    assert text(plain(ros1("std_msgs/Empty")())) == "{}"
    assert text(plain(ros1("nav_msgs/Path")())).splitlines()[-1] == "poses: []"


def test_bytes_are_numbers() -> None:
    message = ros1("sensor_msgs/Image")(data=b"\x00\xff", height=1)
    assert plain(type(message).deserialize(message.serialize()))["data"] == [0, 255]


def test_a_received_message_is_plain_data_that_json_takes() -> None:
    message = ros1("sensor_msgs/LaserScan")(ranges=[0.1, math.inf, math.nan], intensities=[])
    received = type(message).deserialize(message.serialize())
    assert json.loads(json_text(plain(received)))["ranges"] == [0.1, "Infinity", "NaN"]
    assert yaml.safe_load(text(plain(received)))["ranges"][1] == math.inf


@pytest.mark.parametrize(
    "name", ["sensor_msgs/Imu", "sensor_msgs/JointState", "tf2_msgs/TFMessage", "std_msgs/UInt8MultiArray"]
)
def test_yaml_says_the_same_as_the_plain_data(name: str) -> None:
    message = ros1(name)()
    if hasattr(message, "name"):
        message.name = ["a", 'b"c', "näme", "yes", ""]
    assert yaml.safe_load(text(plain(message))) == plain(message)


SCALARS = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(allow_nan=False),
    st.text(),
    st.sampled_from(["yes", "~", "1e3", "- x", "a: b"]),
)
KEYS = st.text(st.characters(categories=["L", "N"]), min_size=1)


@given(
    st.recursive(
        SCALARS,
        lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(KEYS, inner, max_size=4)),
        max_leaves=12,
    )
)
def test_any_value_is_read_back_from_its_yaml(value: Any) -> None:
    assert yaml.safe_load(text(value)) == value


def test_a_string_that_was_no_utf8_is_shown_escaped_instead_of_failing() -> None:
    message = ros1("std_msgs/String").deserialize(b"\x02\x00\x00\x00\xffa")
    line = text(plain(message))
    assert line.encode("ascii") == b'data: "\\udcffa"'


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_a_float32_is_shown_with_few_digits_that_mean_the_same_float32(value: float) -> None:
    short = shortest32(value)
    assert struct.pack("<f", short) == struct.pack("<f", value)
    assert significant(short) <= significant(value)


def significant(value: float) -> int:
    """Digits of a float's text, those apart that only say how large it is."""
    return len(repr(value).partition("e")[0].replace(".", "").strip("-0"))


def test_known_float32_values_are_short() -> None:
    assert [shortest32(struct.unpack("<f", struct.pack("<f", v))[0]) for v in (0.1, 3.003, 1e-7, 16777217.0)] == [
        0.1, 3.003, 1e-7, 16777216.0,
    ]  # fmt: skip


@given(st.floats())
def test_yaml_reads_every_float_back_as_a_float(value: float) -> None:
    read = yaml.safe_load(float_text(value))
    assert isinstance(read, float)
    assert read == value or (math.isnan(read) and math.isnan(value))


def test_arrays_and_strings_can_be_left_out_or_cut() -> None:
    message = ros1("sensor_msgs/LaserScan")(ranges=[0.5] * 360)
    message.header.frame_id = "laser"
    style = Style(no_arrays=True, no_strings=True)
    assert plain(message, style)["ranges"] == "<array of 360 float32>"
    assert plain(message, style)["header"]["frame_id"] == "<string of 5 characters>"
    assert plain(message, Style(most=2))["ranges"] == [0.5, 0.5, "<and 358 more>"]
    assert plain(message, Style(most=360))["ranges"] == [0.5] * 360


def path_message() -> Any:
    path = ros1("nav_msgs/Path")()
    pose = ros1("geometry_msgs/PoseStamped")
    for at in range(3):
        path.poses.append(pose())
        path.poses[at].pose.position.x = float(at)
    path.header.stamp = Time(7, 8)
    return path


@pytest.mark.parametrize(
    "path, value",
    [
        ("header.stamp.secs", 7),
        ("header.stamp", {"secs": 7, "nsecs": 8}),
        ("poses[1].pose.position.x", 1.0),
        ("poses[-1].pose.position", {"x": 2.0, "y": 0.0, "z": 0.0}),
        ("poses[1:].pose.position.x", [1.0, 2.0]),
        ("poses[0:3:2].pose.position.x", [0.0, 2.0]),
        ("/header/frame_id", ""),
    ],
)
def test_a_path_selects_a_value(path: str, value: Any) -> None:
    assert select(path_message(), path) == value


def test_an_element_of_a_numeric_array_is_a_number() -> None:
    message = ros1("sensor_msgs/LaserScan")(ranges=[0.1, 0.2])
    received = type(message).deserialize(message.serialize())
    assert json_text(select(received, "ranges[1]")) == "0.2"


@pytest.mark.parametrize(
    "path, complaint",
    [
        ("nothing", "nav_msgs/Path has no field nothing; it has header, poses"),
        ("header.nothing", "std_msgs/Header has no field nothing"),
        ("header.stamp.nothing", "a time has no field nothing"),
        ("poses.pose", "an array has no field pose"),
        ("poses[7]", "the array has 3 elements"),
        ("header[0]", "something that is no array"),
        ("poses[x]", "is no path"),
        ("poses[1", "is no path"),
    ],
)
def test_a_path_that_leads_nowhere_says_why(path: str, complaint: str) -> None:
    with pytest.raises(CommandError) as caught:
        select(path_message(), path)
    assert complaint in str(caught.value)
