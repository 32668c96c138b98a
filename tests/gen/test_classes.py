"""What a message class is to its user."""

from __future__ import annotations

import copy
import pathlib
import pickle
from typing import Any

import numpy
import pytest

from definitions import classes
from roslet.errors import UnknownType
from roslet.gen import runtime
from roslet.wire.time import Time


def cls(name: str, dialect: Any = "ros1") -> Any:
    return runtime.message_class(dialect, name)


def test_a_class_is_one_object_whatever_its_name_is_spelled_like() -> None:
    assert cls("std_msgs/String") is cls("std_msgs/msg/String")
    assert cls("std_msgs/String") is not cls("std_msgs/String", "ros2")


def test_fields_are_given_by_position_or_name() -> None:
    point = cls("geometry_msgs/Point")
    assert point(1.0, 2.0, 3.0) == point(z=3.0, y=2.0, x=1.0)
    with pytest.raises(TypeError):
        point(1.0, 2.0, 3.0, 4.0)
    with pytest.raises(TypeError):
        point(w=1.0)


def test_a_message_has_no_other_attributes() -> None:
    with pytest.raises(AttributeError):
        cls("std_msgs/String")().date = "typo"


def test_defaults_are_zero_and_not_shared() -> None:
    one, other = cls("sensor_msgs/JointState")(), cls("sensor_msgs/JointState")()
    one.position.append(1.0)
    one.header.frame_id = "x"
    assert list(other.position) == [] and other.header.frame_id == ""
    odometry = cls("nav_msgs/Odometry")()
    assert odometry.pose.covariance.tolist() == [0.0] * 36
    assert cls("std_msgs/Header")().stamp == Time(0, 0)
    assert cls("unique_identifier_msgs/UUID", "ros2")().uuid == bytes(16)


def test_defaults_of_a_definition_are_those_of_the_class() -> None:
    text = "int32 a 5\nstring s 'hi'\nfloat64[] f [1.0, 2.0]\nuint8[3] u [1, 2, 3]\nbool b true\nstring[] w ['x']\n"
    with classes("ros2", {"pkg/Defaults": text}) as (kind,):
        made = kind()
        assert (made.a, made.s, list(made.f), bytes(made.u), made.b, made.w) == (
            5,
            "hi",
            [1, 2],
            b"\1\2\3",
            True,
            ["x"],
        )
        assert kind.deserialize(made.serialize()) == made


def test_constants_are_class_attributes() -> None:
    assert cls("sensor_msgs/PointField").FLOAT32 == 7
    assert cls("diagnostic_msgs/DiagnosticStatus", "ros2").STALE in (3, b"\x03")


def test_facts_of_ros1_types_are_there() -> None:
    string = cls("std_msgs/String")
    assert (string._type, string._md5sum) == ("std_msgs/String", "992ce8a1687cec8c8bd883ec73ca41d1")
    assert string._full_text == "string data\n" or string._full_text == "string data"
    assert not string._has_header
    assert cls("sensor_msgs/Image")._has_header
    assert string._fields_and_types == (("data", "string"),)
    assert cls("geometry_msgs/Point")._fixed_size == 24
    assert (string._fixed_size, string._minimum_size, string._maximum_size) == (None, 4, None)


def test_facts_of_ros2_types_are_there() -> None:
    string = cls("std_msgs/String", "ros2")
    assert string._type == "std_msgs/msg/String"
    assert string._type_hash == "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
    assert cls("geometry_msgs/Point", "ros2")._fixed_size == 28


def test_services_and_actions_have_their_parts() -> None:
    service = runtime.service_class("ros1", "std_srvs/SetBool")
    assert service._type == "std_srvs/SetBool" and service._md5sum == "09fb03525b03e7ea1fd3992bafd87e16"
    assert service.Request(True).serialize() == b"\1"  # type: ignore[call-arg]
    assert service is runtime.service_class("ros1", "std_srvs/srv/SetBool")
    action = runtime.action_class("ros2", "example_interfaces/Fibonacci")
    assert action.Goal._type == "example_interfaces/action/Fibonacci_Goal"
    assert action.SendGoal.Request().goal == action.Goal()  # type: ignore[attr-defined]
    legacy: Any = runtime.action_class("ros1", "actionlib/Test")
    assert legacy.ActionGoal().goal == legacy.Goal()


def test_equality_is_by_value() -> None:
    state = cls("sensor_msgs/JointState")
    assert state(position=[1.0]) == state(position=numpy.array([1.0])) == state(position=(1,))
    assert state(position=[1.0]) != state(position=[2.0])
    assert state(name=["a"]) != state(name=["a", "b"])
    assert state() != cls("std_msgs/String")()
    assert cls("sensor_msgs/Image")(data=b"a") == cls("sensor_msgs/Image")(data=bytearray(b"a"))
    with pytest.raises(TypeError):
        hash(state())


def test_a_message_prints_as_it_is_written() -> None:
    assert repr(cls("geometry_msgs/Point")(1.0)) == "Point(x=1.0, y=0.0, z=0.0)"


def test_a_copy_is_deep() -> None:
    one = cls("tf2_msgs/TFMessage")([cls("geometry_msgs/TransformStamped")()])
    for other in (one.copy(), copy.deepcopy(one), pickle.loads(pickle.dumps(one))):
        assert other == one
        other.transforms[0].header.frame_id = "changed"
        assert other != one


def test_field_names_that_python_keeps_for_itself_get_an_underscore() -> None:
    with classes(
        "ros1", {"pkg/Odd": "int32 from\nint32 self\nint32 copy\nint32 len\nstring data\nint32 n\n"}
    ) as (odd,):
        made = odd(from_=1, self_=2, copy_=3, len=4, data="x", n=5)
        assert odd.deserialize(made.serialize()) == made.copy()
        assert [name for name, _ in odd._fields_and_types][:3] == ["from", "self", "copy"]


def test_names_of_nested_fields_never_clash_with_the_codes_own() -> None:
    names = [
        "buffer",
        "offset",
        "parts",
        "o",
        "e",
        "n",
        "p",
        "base",
        "items",
        "element",
        "len",
        "range",
        "type",
        "str",
    ]
    text = "".join(
        f"In {name}\nIn[] {name}_a\nstring[] {name}_s\n" for name in [*names, "message", "kind", "start"]
    )
    with classes("ros1", {"pkg/In": "int32 data\nstring n\n", "pkg/Clash": text}) as (inner, clash):
        values = {name: inner(at, str(at)) for at, name in enumerate(names)}
        values.update({name + "_a": [inner(at, "x")] * 2 for at, name in enumerate(names)})
        values.update({name + "_s": ["a", "b"] for name in names})
        assert clash.deserialize(clash(**values).serialize()) == clash(**values)


def test_what_was_loaded_later_replaces_what_was_made_before(tmp_path: pathlib.Path) -> None:
    with classes("ros1", {"pkg/In": "int32 a\n", "pkg/Out": "In i\n"}) as (inner, outer):
        path = tmp_path / "pkg" / "msg" / "In.msg"
        path.parent.mkdir(parents=True)
        path.write_text("int32 b\n")
        types = runtime.load(tmp_path, "ros1")
        assert runtime.message_class("ros1", "pkg/In") is types.message("pkg/In") is not inner
        fresh: Any = runtime.message_class("ros1", "pkg/Out")
        assert fresh is not outer and fresh().i.b == 0
        assert types.pkg.msg.In().b == 0
        assert "pkg" in dir(types)


def test_a_class_has_a_counterpart_in_the_other_dialect() -> None:
    assert runtime.for_dialect("ros2", cls("std_msgs/String")) is cls("std_msgs/String", "ros2")
    assert runtime.for_dialect("ros1", cls("std_msgs/String")) is cls("std_msgs/String")
    with pytest.raises(UnknownType):
        runtime.for_dialect("ros1", cls("rcl_interfaces/Log", "ros2"))


def test_an_unknown_type_is_named() -> None:
    with pytest.raises(UnknownType, match="no_such_pkg/Thing"):
        cls("no_such_pkg/Thing")
