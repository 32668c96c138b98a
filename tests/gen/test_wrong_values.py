"""What the generated serialiser refuses, and what it accepts."""

from __future__ import annotations

import array
from typing import Any

import numpy
import pytest

from definitions import classes
from roslet.errors import InvalidMessage
from roslet.gen import runtime
from roslet.wire.message import BufferTooSmall

POSES = {
    "pkg/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    "pkg/Pose": "Quaternion orientation\n",
    "pkg/Poses": "Pose[] poses\nfloat32[4] fixed\nint16[] numbers\nuint8[] data\nbool flag\nstring text\nbool[] flags\n"
    "uint8[4] id\nstring[] words\nuint64 large\n",
}
ROS2_POSES = {
    name: text.replace("Quaternion o", "pkg/Quaternion o").replace("Pose[", "pkg/Pose[")
    for name, text in POSES.items()
}


@pytest.fixture(params=["ros1", "ros2"])
def poses(request: pytest.FixtureRequest) -> Any:
    with classes(request.param, POSES if request.param == "ros1" else ROS2_POSES) as (_, pose, made):
        message = made()
        message.poses = [pose() for _ in range(4)]
        message.serialize()
        yield message


def path_of(message: Any) -> tuple[str, str]:
    with pytest.raises(InvalidMessage) as caught:
        message.serialize()
    with pytest.raises(InvalidMessage) as again:
        message.serialized_size()
    assert str(again.value) == str(caught.value)
    return caught.value.path, caught.value.message


def test_a_wrong_number_deep_inside_is_named_by_its_value_path(poses: Any) -> None:
    poses.poses[3].orientation.w = "up"
    assert path_of(poses) == ("poses[3].orientation.w", "expected a float64, got str 'up'")


def test_a_wrong_element_is_named(poses: Any) -> None:
    poses.poses[2] = None
    assert path_of(poses)[0] == "poses[2]"


@pytest.mark.parametrize(
    ("field", "value", "path"),
    [
        ("fixed", [1.0, 2.0, 3.0], "fixed"),
        ("fixed", numpy.zeros(5, "float32"), "fixed"),
        ("fixed", [1.0, 2.0, 3.0, 1e39], "fixed[3]"),
        ("fixed", numpy.array([0, 0, 0, 1e39]), "fixed[3]"),
        ("fixed", ["a", 0.0, 0.0, 0.0], "fixed[0]"),
        ("fixed", 5, "fixed"),
        ("numbers", [1, 2, 40000], "numbers[2]"),
        ("numbers", numpy.array([1, 40000]), "numbers[1]"),
        ("numbers", numpy.array([1.0, 2.0]), "numbers[0]"),
        ("numbers", b"ab", "numbers"),
        ("numbers", [1, 2.5], "numbers[1]"),
        ("numbers", None, "numbers"),
        ("data", "text", "data"),
        ("data", [1, 2, 300], "data[2]"),
        ("data", 7, "data"),
        ("flag", 2, "flag"),
        ("flag", "yes", "flag"),
        ("text", 5, "text"),
        ("text", None, "text"),
        ("text", "\ud800", "text"),
        ("flags", [True, 3], "flags[1]"),
        ("id", b"abc", "id"),
        ("id", [1, 2, 3, -4], "id[3]"),
        ("words", "abc", "words"),
        ("words", ["a", 5], "words[1]"),
        ("large", 1 << 64, "large"),
        ("large", -1, "large"),
        ("large", 1.0, "large"),
    ],
)
def test_a_value_that_the_field_cannot_hold_is_refused(
    poses: Any, field: str, value: object, path: str
) -> None:
    setattr(poses, field, value)
    assert path_of(poses)[0] == path


@pytest.mark.parametrize(
    ("field", "value", "like"),
    [
        ("fixed", (1, 2, 3, 4), [1.0, 2.0, 3.0, 4.0]),
        ("fixed", numpy.arange(4, dtype="float64"), [0.0, 1.0, 2.0, 3.0]),
        ("fixed", numpy.arange(4, dtype="int64"), [0.0, 1.0, 2.0, 3.0]),
        ("fixed", numpy.arange(8, dtype="float32")[::2], [0.0, 2.0, 4.0, 6.0]),
        ("fixed", numpy.arange(4, dtype=">f4"), [0.0, 1.0, 2.0, 3.0]),
        ("fixed", numpy.arange(4, dtype="float32").reshape(2, 2), [0.0, 1.0, 2.0, 3.0]),
        ("fixed", array.array("f", [1, 2, 3, 4]), [1.0, 2.0, 3.0, 4.0]),
        ("fixed", memoryview(array.array("f", [1, 2, 3, 4])), [1.0, 2.0, 3.0, 4.0]),
        ("fixed", array.array("d", [1, 2, 3, 4]), [1.0, 2.0, 3.0, 4.0]),
        ("numbers", range(3), [0, 1, 2]),
        ("numbers", numpy.array([], "float64"), []),
        ("numbers", (), []),
        ("numbers", array.array("l", [1, -2]), [1, -2]),
        ("data", [1, 2, 3], b"\1\2\3"),
        ("data", bytearray(b"abc"), b"abc"),
        ("data", memoryview(b"abcd")[::2], b"ac"),
        ("data", numpy.frombuffer(b"abc", "uint8"), b"abc"),
        ("data", numpy.array([[1, 2], [3, 4]]), b"\1\2\3\4"),
        ("data", array.array("B", b"abc"), b"abc"),
        ("data", range(3), b"\0\1\2"),
        ("flag", 1, True),
        ("flag", numpy.bool_(True), True),
        ("text", b"bytes", "bytes"),
        ("text", "\udcff", "\udcff"),
        ("flags", numpy.array([True, False]), [True, False]),
        ("flags", (1, 0), [True, False]),
        ("id", [1, 2, 3, 4], b"\1\2\3\4"),
        ("id", numpy.arange(4, dtype="uint8"), b"\0\1\2\3"),
        ("words", ("a", "b"), ["a", "b"]),
        ("large", numpy.uint64(5), 5),
    ],
)
def test_any_sensible_spelling_of_a_value_is_accepted(
    poses: Any, field: str, value: object, like: object
) -> None:
    setattr(poses, field, value)
    kind = type(poses)
    data = poses.serialize()
    assert len(data) == poses.serialized_size()
    setattr(poses, field, like)
    assert data == poses.serialize()
    assert kind.deserialize(data) == poses


def test_a_field_that_was_never_set_is_named(poses: Any) -> None:
    del poses.text
    assert path_of(poses) == ("text", "the field was never set")


def test_overlong_bounded_values_are_refused() -> None:
    text = "string<=3 s\nint32[<=2] a\nstring<=2[<=2] w\nuint8[<=2] b\n"
    with classes("ros2", {"pkg/Bounded": text}) as (kind,):
        for field, value, path in [
            ("s", "abcd", "s"),
            ("s", "ää", "s"),
            ("a", [1, 2, 3], "a"),
            ("w", ["a", "abc"], "w[1]"),
            ("w", ["a", "b", "c"], "w"),
            ("b", b"abc", "b"),
        ]:
            assert path_of(kind(**{field: value}))[0] == path
        assert kind.deserialize(kind("abc", [1, 2], ["ab", "cd"], b"ab").serialize()).s == "abc"


@pytest.mark.parametrize("view", [True, False])
@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_every_buffer_that_is_too_small_says_what_is_needed(dialect: Any, view: bool) -> None:
    name = "sensor_msgs/msg/JointState" if dialect == "ros2" else "sensor_msgs/JointState"
    message = runtime.message_class(dialect, name)()
    message.header.frame_id = "base"  # type: ignore[attr-defined]
    message.name = ["a", "bcd"]  # type: ignore[attr-defined]
    message.position = [1.0, 2.0]  # type: ignore[attr-defined]
    whole = message.serialize()
    for offset in (0, 3):
        for size in range(len(whole) + offset):
            own = bytearray(size)
            buffer = memoryview(own) if view else own
            try:
                end = message.serialize_into(buffer, offset)
            except BufferTooSmall as error:
                assert error.size == len(whole)
            else:  # a bytearray of one's own may have grown
                assert not view and bytes(own[offset:end]) == whole
        exact = bytearray(b"\xee" * (len(whole) + offset + 2))
        assert message.serialize_into(exact, offset) == len(whole) + offset
        assert bytes(exact) == b"\xee" * offset + whole + b"\xee\xee"


@pytest.mark.parametrize("raw", [bytes(range(1, 256)), b"a\xff\x80b"], ids=["long", "short"])
@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_a_string_of_any_bytes_survives(dialect: Any, raw: bytes) -> None:
    kind: Any = runtime.message_class(dialect, "std_msgs/String")
    data = kind(data=raw).serialize()
    message = kind.deserialize(data)
    assert message.data.encode("utf-8", "surrogateescape") == raw
    assert message.serialize() == data
