"""`roslet interface` and `roslet gen`."""

from __future__ import annotations

import json
import pathlib
import subprocess
from collections.abc import Callable
from typing import Any

import pytest

import peers

Run = Callable[..., Any]
MSGS = pathlib.Path(__file__).resolve().parents[2] / "examples" / "msgs"


def test_a_definition_is_shown_without_comments_with_constants_and_full_type_names(
    run: Run, tmp_path: pathlib.Path
) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Foo.msg").write_text(
        "# a comment\nint8 A=-3   # another\nstring S= kept  text\nHeader header\nfloat32[3] few\nBar[2] bars\n"
    )
    (tmp_path / "my_msgs" / "msg" / "Bar.msg").write_text("bool b\n")
    outcome = run("interface", "show", "--types", tmp_path, "my_msgs/Foo")
    assert outcome.code == 0
    assert outcome.out.splitlines() == [
        "# my_msgs/Foo (msg, ROS 1)",
        "int8 A=-3",
        "string S=kept  text",
        "std_msgs/Header header",
        "float32[3] few",
        "my_msgs/Bar[2] bars",
    ]


def test_recursive_shows_what_nested_types_are_made_of(run: Run) -> None:
    lines = run("interface", "show", "-r", "geometry_msgs/Pose").out.splitlines()
    assert lines[1:6] == [
        "geometry_msgs/Point position",
        "  float64 x",
        "  float64 y",
        "  float64 z",
        "geometry_msgs/Quaternion orientation",
    ]


def test_defaults_and_bounds_are_shown_as_they_are_spelled(run: Run, tmp_path: pathlib.Path) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Foo.msg").write_text(
        'string<=5 name "a b"\nint32[<=4] few [1, 2]\nbool on true\nfloat64 ratio 0.5\n'
    )
    outcome = run("interface", "show", "--types", tmp_path, "my_msgs/msg/Foo")
    assert outcome.out.splitlines()[1:] == [
        'string<=5 name "a b"',
        "int32[<=4] few [1, 2]",
        "bool on true",
        "float64 ratio 0.5",
    ]


def test_a_service_has_its_two_parts(run: Run) -> None:
    outcome = run("interface", "show", "std_srvs/SetBool")
    assert outcome.out == "# std_srvs/SetBool (srv, ROS 1)\nbool data\n---\nbool success\nstring message\n"


def test_a_name_with_three_parts_means_ros2_first(run: Run) -> None:
    assert "(msg, ROS 2)" in run("interface", "show", "std_msgs/msg/Header").out
    assert "(msg, ROS 1)" in run("interface", "show", "std_msgs/Header").out
    assert "(msg, ROS 1)" in run("interface", "show", "--dialect", "ros1", "std_msgs/msg/Header").out


def test_show_as_json_holds_fields_and_constants(run: Run) -> None:
    shown = json.loads(run("interface", "show", "--json", "-r", "sensor_msgs/PointField").out)
    assert shown["type"] == "sensor_msgs/PointField"
    assert {"name": "FLOAT32", "type": "uint8", "value": 7} in shown["constants"]
    assert shown["fields"][0] == {"name": "name", "type": "string"}
    assert shown["nested"] == {}


def test_hash_prints_both_systems_where_both_have_the_type(run: Run) -> None:
    assert run("interface", "hash", "std_msgs/String").out.splitlines() == [
        "ROS 1  992ce8a1687cec8c8bd883ec73ca41d1",
        "ROS 2  RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    ]
    assert (
        run("interface", "hash", "--dialect", "ros1", "std_msgs/String").out
        == "992ce8a1687cec8c8bd883ec73ca41d1\n"
    )


@pytest.mark.parametrize("kind, name", [("msg", "sensor_msgs/Imu"), ("srv", "nav_msgs/GetPlan")])
def test_hash_is_what_ros_itself_prints(kind: str, name: str, run: Run) -> None:
    peers.require("genpy")
    program = (
        "import importlib\n"
        f"package, name = {name!r}.split('/')\n"
        f"print(getattr(importlib.import_module(package + '.{kind}'), name)._md5sum)\n"
    )
    done = subprocess.run(
        [str(peers.DEBIAN_PYTHON), "-c", program],
        capture_output=True,
        text=True,
        env={"PATH": "/usr/bin"},
        check=True,
    )
    assert run("interface", "hash", "--dialect", "ros1", name).out == done.stdout


def test_size_is_given_for_each_encoding_and_part(run: Run) -> None:
    rows = json.loads(run("interface", "size", "--json", "geometry_msgs/Pose").out)
    assert [(row["encoding"], row["fixed"]) for row in rows] == [("ros1", 56), ("cdr", 60)]
    rows = json.loads(run("interface", "size", "--json", "std_srvs/SetBool").out)
    assert [(row["type"], row["minimum"], row["maximum"]) for row in rows] == [
        ("std_srvs/SetBoolRequest", 1, 1),
        ("std_srvs/SetBoolResponse", 5, None),
        ("std_srvs/srv/SetBool_Request", 5, 5),
        ("std_srvs/srv/SetBool_Response", 13, None),
    ]


def test_sizes_are_those_of_serialised_messages(run: Run) -> None:
    from roslet.gen.runtime import message_class

    for row in json.loads(run("interface", "size", "--json", "sensor_msgs/Imu").out):
        dialect: Any = "ros1" if row["encoding"] == "ros1" else "ros2"
        assert len(message_class(dialect, row["type"])().serialize()) == row["minimum"]


def test_list_says_for_which_systems_a_type_is_defined(run: Run) -> None:
    lines = run("interface", "list", "std_srvs").out.splitlines()
    assert lines[0].split("  ")[0] == "TYPE"
    assert "std_srvs/srv/Trigger  ROS 1, ROS 2" in lines
    assert run("interface", "list", "std_srvs", "--names").out.splitlines() == [
        "std_srvs/srv/Empty",
        "std_srvs/srv/SetBool",
        "std_srvs/srv/Trigger",
    ]


def test_an_unknown_type_is_one_line_and_exit_code_1(run: Run) -> None:
    outcome = run("interface", "show", "no_such/Type")
    assert (outcome.code, outcome.err) == (1, "roslet: no definition of no_such/Type found\n")


def test_an_error_in_a_definition_names_file_and_line(run: Run, tmp_path: pathlib.Path) -> None:
    (tmp_path / "my_msgs" / "msg").mkdir(parents=True)
    (tmp_path / "my_msgs" / "msg" / "Foo.msg").write_text("int8 a\nint8\n")
    outcome = run("interface", "show", "--types", tmp_path, "my_msgs/Foo")
    assert outcome.code == 1
    assert "my_msgs/msg/Foo.msg:2:" in outcome.err
    assert outcome.err.count("\n") == 1


def test_a_package_that_only_one_system_allows_can_be_looked_at(run: Run, tmp_path: pathlib.Path) -> None:
    (tmp_path / "MyMsgs" / "msg").mkdir(parents=True)
    (tmp_path / "MyMsgs" / "msg" / "Foo.msg").write_text("time t\n")
    assert run("interface", "show", "--types", tmp_path, "MyMsgs/Foo").out.endswith("time t\n")
    assert "ROS 1" not in run("interface", "hash", "--types", tmp_path, "MyMsgs/Foo").err


def test_gen_python_writes_a_package_that_works_and_then_leaves_it_alone(
    run: Run, tmp_path: pathlib.Path
) -> None:
    import importlib
    import sys

    folder = tmp_path / "cli_generated"
    first = run("gen", "python", folder, "--types", MSGS)
    assert first.code == 0
    assert str(folder / "mros_comm_measure" / "msg" / "_Coordinate.py") in first.out.splitlines()
    second = run("gen", "python", folder, "--types", MSGS)
    assert (second.code, second.out) == (0, "")
    sys.path.insert(0, str(tmp_path))
    try:
        made = importlib.import_module("cli_generated.mros_comm_measure.msg").Coordinate
        assert made(x=1.0).serialize()[:4] == b"\x00\x00\x80\x3f"
    finally:
        sys.path.remove(str(tmp_path))


def test_gen_python_takes_packages_and_types(run: Run, tmp_path: pathlib.Path) -> None:
    outcome = run("gen", "python", tmp_path / "out", "geometry_msgs/Pose", "std_srvs")
    assert outcome.code == 0
    assert (tmp_path / "out" / "geometry_msgs" / "msg" / "_Point.py").is_file()
    assert (tmp_path / "out" / "std_srvs" / "srv" / "_Trigger.py").is_file()
    assert not (tmp_path / "out" / "geometry_msgs" / "msg" / "_Twist.py").exists()


def test_gen_python_without_names_is_wrong_usage(run: Run, tmp_path: pathlib.Path) -> None:
    assert run("gen", "python", tmp_path / "out").code == 2


def test_gen_cpp_writes_headers_and_then_leaves_them_alone(run: Run, tmp_path: pathlib.Path) -> None:
    folder = tmp_path / "include"
    first = run("gen", "cpp", folder, "--types", MSGS)
    assert first.code == 0
    assert str(folder / "mros_comm_measure" / "Coordinate.hpp") in first.out.splitlines()
    assert str(folder / "roslet" / "message.hpp") in first.out.splitlines()
    second = run("gen", "cpp", folder, "--types", MSGS)
    assert (second.code, second.out) == (0, "")
    assert "nothing has changed" in second.err
    other = run(
        "gen", "cpp", folder, "--types", MSGS, "--dialect", "ros2", "mros_comm_measure/Coordinate", "--json"
    )
    assert str(folder / "mros_comm_measure" / "msg" / "Coordinate.hpp") in json.loads(other.out)
    assert str(folder / "roslet" / "message.hpp") not in json.loads(other.out)


def test_gen_cpp_takes_bounds_from_options_and_a_file(run: Run, tmp_path: pathlib.Path) -> None:
    bounds = tmp_path / "bounds.txt"
    bounds.write_text("sensor_msgs/JointState.name[] 12\nstd_msgs/Header.frame_id 8\n")
    options = ["--string-bound", "20", "--sequence-bound", "5", "--bounds", bounds]
    assert run("gen", "cpp", tmp_path / "out", "sensor_msgs/JointState", *options).code == 0
    text = (tmp_path / "out" / "sensor_msgs" / "JointState.hpp").read_text()
    assert "roslet::Sequence<roslet::String<12>, 5> name{};" in text
    assert "roslet::Sequence<double, 5> position{};" in text
    assert "roslet::String<8> frame_id{};" in (tmp_path / "out" / "std_msgs" / "Header.hpp").read_text()


def test_gen_cpp_tells_what_is_wrong(run: Run, tmp_path: pathlib.Path) -> None:
    assert run("gen", "cpp", tmp_path / "out").code == 2
    assert run("gen", "cpp", tmp_path / "out", "std_msgs", "--string-bound", "0").code == 2
    absent = run("gen", "cpp", tmp_path / "out", "std_msgs", "--bounds", tmp_path / "none")
    assert absent.code == 1 and "cannot read" in absent.err
    bounds = tmp_path / "bounds.txt"
    bounds.write_text("std_msgs/Header.seq 4\n")
    wrong = run("gen", "cpp", tmp_path / "out", "std_msgs", "--bounds", bounds)
    assert wrong.code == 1 and "bounds.txt:1" in wrong.err
    large = run("gen", "cpp", tmp_path / "out", "sensor_msgs/PointCloud2", "--sequence-bound", "400000000")
    assert large.code == 1 and "lower its bounds" in large.err
    assert not (tmp_path / "out").exists()
