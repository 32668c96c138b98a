"""Where definitions are found, in which order, and how what is missing or circular is refused."""

from __future__ import annotations

import pathlib

import pytest

from roslet.errors import DefinitionError, InvalidName, RecursiveType, UnknownType
from roslet.idl import Dialect, Message, Registry, Service, TypeName, parse_type_name


def write(root: pathlib.Path, files: dict[str, str]) -> pathlib.Path:
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


def manifest(name: str) -> str:
    return f"<?xml version='1.0'?><package format='2'><!-- <name>no</name> --><name> {name} </name></package>"


def fields(message: Message) -> list[str]:
    return [field.name for field in message.fields]


# Names


def test_a_type_name_is_read_in_both_spellings_and_written_in_either() -> None:
    assert parse_type_name("std_msgs/String") == TypeName("std_msgs", "msg", "String")
    assert parse_type_name("std_srvs/Empty", "srv") == TypeName("std_srvs", "srv", "Empty")
    name = parse_type_name("std_srvs/srv/Empty")
    assert name == TypeName("std_srvs", "srv", "Empty")
    assert (name.text("ros1"), name.text("ros2")) == ("std_srvs/Empty", "std_srvs/srv/Empty")


@pytest.mark.parametrize(
    "text",
    ["", "String", "/String", "std_msgs/", "a/b/c", "a/msg/B/c", "a/B c", "../a", "a/msg/../B", "1/A", "ä/B"],
)
def test_what_is_no_type_name_is_refused(text: str) -> None:
    with pytest.raises(InvalidName, match="is no type name"):
        parse_type_name(text)


def test_a_type_name_made_by_hand_never_becomes_a_path() -> None:
    with pytest.raises(UnknownType):
        Registry("ros1", None).message(TypeName("../ros1/std_msgs", "msg", "String"))


# What is bundled


def test_the_bundled_packages_are_those_that_programs_expect() -> None:
    ros1 = {
        *(
            "std_msgs",
            "geometry_msgs",
            "sensor_msgs",
            "nav_msgs",
            "shape_msgs",
            "stereo_msgs",
            "trajectory_msgs",
        ),
        *("visualization_msgs", "diagnostic_msgs", "actionlib_msgs", "std_srvs", "rosgraph_msgs", "roscpp"),
        *("tf2_msgs", "tf", "actionlib"),
    }
    ros2 = {
        *(
            "std_msgs",
            "geometry_msgs",
            "sensor_msgs",
            "nav_msgs",
            "shape_msgs",
            "stereo_msgs",
            "trajectory_msgs",
        ),
        *("visualization_msgs", "diagnostic_msgs", "actionlib_msgs", "std_srvs", "rosgraph_msgs", "tf2_msgs"),
        *("builtin_interfaces", "action_msgs", "rcl_interfaces", "lifecycle_msgs", "composition_interfaces"),
        *("statistics_msgs", "unique_identifier_msgs", "service_msgs", "type_description_interfaces"),
        *("rmw_dds_common", "example_interfaces"),
    }
    assert ros1 <= set(Registry("ros1", None).packages())
    assert ros2 <= set(Registry("ros2", None).packages())


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_every_bundled_definition_is_whole(dialect: Dialect) -> None:
    registry = Registry(dialect, None)
    names = registry.names()
    assert len(names) > 150
    for name in names:
        assert registry.interface(name).name == name


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_bundled_definitions_hold_field_facts_only(dialect: Dialect) -> None:
    registry = Registry(dialect, None)
    for name in registry.names():
        for line in registry.interface(name).text.splitlines():
            assert "#" not in line
            assert line == "---" or (line == line.strip() and "  " not in line and " " in line)


# Resolution


def test_what_was_loaded_comes_before_the_environment_and_that_before_the_bundled(
    tmp_path: pathlib.Path,
) -> None:
    environment = write(tmp_path / "prefix", {"share/std_msgs/msg/String.msg": "int8 environment\n"})
    first = write(tmp_path / "first/std_msgs", {"msg/String.msg": "int8 first\n"})
    second = write(tmp_path / "second/std_msgs", {"msg/String.msg": "int8 second\n"})
    assert fields(Registry("ros2", {}).message("std_msgs/String")) == ["data"]
    registry = Registry("ros2", {"AMENT_PREFIX_PATH": f"/nowhere:{environment}"})
    assert fields(registry.message("std_msgs/String")) == ["environment"]
    assert registry.load(first) == [TypeName("std_msgs", "msg", "String")]
    assert fields(registry.message("std_msgs/String")) == ["first"]
    registry.load(second)
    assert fields(registry.message("std_msgs/String")) == ["second"]
    assert fields(registry.message("std_msgs/Bool")) == ["data"]


def test_each_dialect_reads_its_own_variable_only(tmp_path: pathlib.Path) -> None:
    write(tmp_path / "share/pkg", {"msg/A.msg": "int8 x\n"})
    environment = {"AMENT_PREFIX_PATH": str(tmp_path), "ROS_PACKAGE_PATH": ""}
    assert fields(Registry("ros2", environment).message("pkg/A")) == ["x"]
    with pytest.raises(
        UnknownType, match=r"pkg/A: not in what was loaded, \$ROS_PACKAGE_PATH and the bundled"
    ):
        Registry("ros1", environment).message("pkg/A")
    with pytest.raises(UnknownType, match="pkg/msg/A: not in what was loaded and the bundled"):
        Registry("ros2", None).message("pkg/A")


def test_the_process_environment_is_the_default(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(tmp_path / "share/pkg", {"msg/A.msg": "int8 x\n"})
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    assert fields(Registry("ros2").message("pkg/msg/A")) == ["x"]


def test_ros_package_path_is_crawled_for_packages_by_their_manifests(tmp_path: pathlib.Path) -> None:
    write(
        tmp_path / "src",
        {
            "stack/deep/directory_name/package.xml": manifest("true_name"),
            "stack/deep/directory_name/msg/A.msg": "int8 x\n",
            "old/manifest.xml": "<package/>",
            "old/msg/B.msg": "int8 x\n",
            "stack/ignored/CATKIN_IGNORE": "",
            "stack/ignored/package.xml": manifest("ignored"),
            "stack/ignored/msg/A.msg": "int8 x\n",
            "true_name_of_another/package.xml": manifest("true_name"),
            "true_name_of_another/msg/A.msg": "int8 shallower\n",
            ".hidden/pkg/package.xml": manifest("hidden"),
            ".hidden/pkg/msg/A.msg": "int8 x\n",
        },
    )
    (tmp_path / "src/stack/loop").symlink_to(tmp_path / "src")
    registry = Registry("ros1", {"ROS_PACKAGE_PATH": str(tmp_path / "src")})
    assert fields(registry.message("true_name/A")) == ["shallower"]
    assert fields(registry.message("old/B")) == ["x"]
    for missing in ("ignored/A", "directory_name/A", "hidden/A"):
        with pytest.raises(UnknownType):
            registry.message(missing)
    mine = {name.package for name in registry.names()} - set(Registry("ros1", None).packages())
    assert mine == {"old", "true_name", "true_name_of_another"}


def test_an_entry_of_ros_package_path_may_be_a_package_or_an_install_space(tmp_path: pathlib.Path) -> None:
    package = write(tmp_path / "one", {"package.xml": manifest("pkg"), "msg/A.msg": "int8 x\n"})
    share = write(tmp_path / "share", {"bare/msg/B.msg": "int8 y\n", "doc/deep/package.xml": manifest("c")})
    registry = Registry("ros1", {"ROS_PACKAGE_PATH": f"{package}:{share}/"})
    assert fields(registry.message("pkg/A")) == ["x"]
    assert fields(registry.message("bare/B")) == ["y"]


# Loading

FILES = {"msg/A.msg": "int8 x\n", "srv/B.srv": "int8 y\n---\n", "action/C.action": "---\n---\n"}
NAMES = [TypeName("pkg", "action", "C"), TypeName("pkg", "msg", "A"), TypeName("pkg", "srv", "B")]


@pytest.mark.parametrize(
    ("files", "path"),
    [
        ({"pkg/" + name: text for name, text in FILES.items()}, "pkg"),
        ({"pkg/" + name: text for name, text in FILES.items()}, "pkg/msg"),
        ({"pkg/" + name: text for name, text in FILES.items()}, "pkg/srv/B.srv"),
        ({"pkg/" + name.split("/")[1]: text for name, text in FILES.items()}, "pkg"),
        ({"pkg/" + name.split("/")[1]: text for name, text in FILES.items()}, "pkg/A.msg"),
        ({"x/package.xml": manifest("pkg"), **{"x/" + name: text for name, text in FILES.items()}}, "x"),
        ({"x/package.xml": manifest("pkg"), **{"x/" + name: text for name, text in FILES.items()}}, "x/msg"),
        ({"x/package.xml": manifest("pkg"), **{"x/" + name: text for name, text in FILES.items()}}, ""),
        ({"w/src/s/pkg/" + name: text for name, text in FILES.items()}, "w"),
    ],
)
def test_a_package_a_workspace_a_directory_or_a_file_can_be_loaded(
    tmp_path: pathlib.Path, files: dict[str, str], path: str
) -> None:
    write(tmp_path, files)
    for dialect in ("ros1", "ros2"):
        registry = Registry(dialect, None)
        assert registry.load(tmp_path / path) == NAMES
        assert fields(registry.message("pkg/A")) == ["x"]
        assert fields(registry.service("pkg/B").request) == ["y"]
        assert registry.action("pkg/C").goal.fields == ()


def test_loading_what_holds_no_definition_says_so(tmp_path: pathlib.Path) -> None:
    registry = Registry("ros2", None)
    with pytest.raises(DefinitionError, match="nowhere: no such file or directory"):
        registry.load(tmp_path / "nowhere")
    with pytest.raises(DefinitionError, match=r"no package and no \.msg, \.srv or \.action file here"):
        registry.load(tmp_path)
    write(tmp_path, {"a/package.xml": manifest("a"), "b/x.txt": ""})
    with pytest.raises(DefinitionError, match=r"no \.msg, \.srv or \.action file in the packages here"):
        registry.load(tmp_path / "a")
    with pytest.raises(DefinitionError, match=r"x\.txt: not a \.msg, \.srv or \.action file"):
        registry.load(tmp_path / "b/x.txt")
    write(tmp_path, {"Caps/msg/A.msg": "int8 x"})
    with pytest.raises(DefinitionError, match="package Caps: package names are made of lower-case letters"):
        registry.load(tmp_path / "Caps")


def test_a_search_that_grows_too_large_is_refused(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("roslet.idl.sources.MAXIMUM_CRAWL_DIRECTORIES", 3)
    for number in range(5):
        (tmp_path / str(number)).mkdir()
    with pytest.raises(DefinitionError, match="more than 3 directories to search: name a package"):
        Registry("ros1", None).load(tmp_path)


def test_an_error_in_a_loaded_file_names_it_when_it_is_asked_for(tmp_path: pathlib.Path) -> None:
    write(tmp_path / "pkg", {"msg/A.msg": "int8 x\nint9\n", "msg/B.msg": "int8 x"})
    registry = Registry("ros1", None)
    assert len(registry.load(tmp_path / "pkg")) == 2
    assert fields(registry.message("pkg/B")) == ["x"]
    with pytest.raises(DefinitionError, match=r"/pkg/msg/A\.msg:2:5: expected a name"):
        registry.message("pkg/A")


def test_a_file_that_cannot_be_read_is_named(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    registry = Registry("ros1", None)
    registry.load(write(tmp_path / "pkg", {"msg/A.msg": "int8 x\n"}))
    monkeypatch.setattr("os.path.isfile", lambda path: True)
    (tmp_path / "pkg/msg/A.msg").unlink()
    with pytest.raises(DefinitionError, match=r"/pkg/msg/A\.msg: cannot be read: No such file or directory"):
        registry.message("pkg/A")


def test_files_with_illegal_names_are_not_listed(tmp_path: pathlib.Path) -> None:
    write(tmp_path / "pkg", {"msg/A.msg": "", "msg/b.msg": "", "msg/C D.msg": "", "msg/E.txt": ""})
    assert Registry("ros2", None).load(tmp_path / "pkg") == [TypeName("pkg", "msg", "A")]
    assert [name.name for name in Registry("ros1", None).load(tmp_path / "pkg")] == ["A", "b"]


def test_a_byte_order_mark_is_no_part_of_a_definition(tmp_path: pathlib.Path) -> None:
    write(tmp_path / "pkg", {"msg/A.msg": "\ufeffint8 x\n"})
    registry = Registry("ros1", None)
    registry.load(tmp_path / "pkg")
    assert registry.message("pkg/A").text == "int8 x\n"


# Asking


def test_names_can_be_asked_by_kind_and_package() -> None:
    registry = Registry("ros2", None)
    assert registry.names("srv", "std_srvs") == [
        TypeName("std_srvs", "srv", "Empty"),
        TypeName("std_srvs", "srv", "SetBool"),
        TypeName("std_srvs", "srv", "Trigger"),
    ]
    assert registry.names("msg", "std_srvs") == []
    assert registry.names(package="no_such") == []
    assert TypeName("example_interfaces", "action", "Fibonacci") in registry.names("action")


def test_an_interface_is_found_by_its_short_name_whatever_its_kind() -> None:
    registry = Registry("ros2", None)
    assert isinstance(registry.interface("std_msgs/String"), Message)
    assert isinstance(registry.interface("std_srvs/Empty"), Service)
    assert registry.interface("example_interfaces/Fibonacci").name.kind == "action"
    assert registry.interface("std_srvs/Empty_Request").name == TypeName("std_srvs", "srv", "Empty_Request")
    with pytest.raises(UnknownType, match="unknown type std_srvs/msg/Nothing"):
        registry.interface("std_srvs/Nothing")


def test_derived_types_of_ros2_are_found_by_name() -> None:
    registry = Registry("ros2", None)
    assert fields(registry.message("example_interfaces/srv/AddTwoInts_Request")) == ["a", "b"]
    assert fields(registry.message("example_interfaces/srv/AddTwoInts_Event")) == [
        "info",
        "request",
        "response",
    ]
    fibonacci = "example_interfaces/action/Fibonacci"
    assert fields(registry.message(fibonacci + "_Goal")) == ["order"]
    assert fields(registry.message(fibonacci + "_FeedbackMessage")) == ["goal_id", "feedback"]
    assert fields(registry.message(fibonacci + "_GetResult_Response")) == ["status", "result"]
    assert fields(registry.service(fibonacci + "_SendGoal").request) == ["goal_id", "goal"]
    for missing in (
        "example_interfaces/srv/AddTwoInts_Goal",
        fibonacci + "_Other",
        "std_msgs/msg/String_Request",
    ):
        with pytest.raises(UnknownType):
            registry.message(missing)


def test_derived_types_of_ros1_are_found_by_name() -> None:
    registry = Registry("ros1", None)
    request = registry.message("rospy_tutorials/AddTwoIntsRequest")
    assert (request.name, fields(request)) == (
        TypeName("rospy_tutorials", "srv", "AddTwoIntsRequest"),
        ["a", "b"],
    )
    assert registry.message("rospy_tutorials/srv/AddTwoIntsRequest") == request
    goal = registry.message("actionlib_tutorials/FibonacciActionGoal")
    assert (goal.name.kind, fields(goal)) == ("msg", ["header", "goal_id", "goal"])
    assert fields(registry.message("actionlib_tutorials/FibonacciGoal")) == ["order"]
    assert fields(registry.message("actionlib_tutorials/FibonacciAction"))[0] == "action_goal"
    with pytest.raises(UnknownType):
        registry.message("actionlib_tutorials/FibonacciRequest")


def test_a_generated_message_file_rules_over_what_its_action_implies(tmp_path: pathlib.Path) -> None:
    files = {"action/Do.action": "int8 x\n---\n---\n", "msg/DoGoal.msg": "# generated\nint8 x\n"}
    for first in ("pkg/DoGoal", "pkg/DoResult"):
        registry = Registry("ros1", None)
        registry.load(write(tmp_path / "pkg", files))
        registry.message(first)
        assert registry.message("pkg/DoGoal").text == "# generated\nint8 x\n"


def test_asking_for_the_wrong_kind_says_what_it_is() -> None:
    registry = Registry("ros2", None)
    with pytest.raises(UnknownType, match="std_srvs/srv/Empty is no message"):
        registry.message("std_srvs/srv/Empty")
    with pytest.raises(UnknownType, match="std_msgs/msg/String is no service"):
        registry.service("std_msgs/msg/String")
    with pytest.raises(UnknownType, match="std_msgs/msg/String is no action"):
        registry.action("std_msgs/msg/String")


def test_a_definition_is_parsed_once() -> None:
    registry = Registry("ros1", None)
    assert registry.message("std_msgs/String") is registry.message(TypeName("std_msgs", "msg", "String"))


def test_dependencies_come_depth_first_each_once() -> None:
    registry = Registry("ros1", None)
    assert [message.name.text("ros1") for message in registry.dependencies("nav_msgs/Odometry")] == [
        "std_msgs/Header",
        "geometry_msgs/PoseWithCovariance",
        "geometry_msgs/Pose",
        "geometry_msgs/Point",
        "geometry_msgs/Quaternion",
        "geometry_msgs/TwistWithCovariance",
        "geometry_msgs/Twist",
        "geometry_msgs/Vector3",
    ]
    assert [message.name.name for message in registry.dependencies("roscpp/GetLoggers")] == ["Logger"]
    ros2 = Registry("ros2", None)
    assert ros2.dependencies("example_interfaces/srv/AddTwoInts") == []
    found = [message.name.name for message in ros2.dependencies("example_interfaces/action/Fibonacci")]
    assert found == ["UUID", "Fibonacci_Feedback", "Fibonacci_Goal", "Time", "Fibonacci_Result"]


# What cannot be


def test_an_unknown_nested_type_is_shown_where_it_stands(tmp_path: pathlib.Path) -> None:
    write(tmp_path / "pkg", {"msg/A.msg": "\nB b\n", "msg/B.msg": "int8 x\n  no_msgs/Such[] y # y\n"})
    registry = Registry("ros1", None)
    registry.load(tmp_path / "pkg")
    with pytest.raises(UnknownType) as caught:
        registry.message("pkg/A")
    assert caught.value.message.startswith("unknown type no_msgs/Such: not in what was loaded")
    assert caught.value.file.endswith("/pkg/msg/B.msg")
    assert (caught.value.line, caught.value.column) == (2, 3)


def test_a_nested_service_part_is_no_message(tmp_path: pathlib.Path) -> None:
    registry = Registry("ros1", None)
    registry.load(write(tmp_path / "pkg", {"srv/Ask.srv": "AskRequest again\n---\nint8 x\n"}))
    with pytest.raises(UnknownType, match=r"Ask\.srv:1:1: unknown type pkg/AskRequest"):
        registry.service("pkg/Ask")


@pytest.mark.parametrize("dialect", ["ros1", "ros2"])
def test_a_message_that_contains_itself_is_refused_with_the_cycle(
    tmp_path: pathlib.Path, dialect: Dialect
) -> None:
    files = {
        "msg/A.msg": "int8 x\nB b\n",
        "msg/B.msg": "# b\nC[] c\n",
        "msg/C.msg": "B[2] b\n",
        "msg/D.msg": "D d\n",
    }
    registry = Registry(dialect, None)
    registry.load(write(tmp_path / "pkg", files))
    spelled = "pkg/" if dialect == "ros1" else "pkg/msg/"
    with pytest.raises(RecursiveType) as caught:
        registry.message("pkg/A")
    assert caught.value.message == f"a message cannot contain itself: {spelled}B -> {spelled}C -> {spelled}B"
    assert caught.value.file.endswith("/pkg/msg/C.msg")
    assert (caught.value.line, caught.value.column) == (1, 1)
    with pytest.raises(RecursiveType, match=f"{spelled}D -> {spelled}D"):
        registry.message("pkg/D")
    with pytest.raises(RecursiveType):
        registry.dependencies("pkg/C")


def test_nesting_may_be_deeper_than_pythons_own_stack(tmp_path: pathlib.Path) -> None:
    depth = 1500
    files = {f"msg/L{level}.msg": f"L{level + 1} x\n" for level in range(depth)}
    registry = Registry("ros1", None)
    registry.load(write(tmp_path / "pkg", {**files, f"msg/L{depth}.msg": "int8 x\n"}))
    assert len(registry.dependencies("pkg/L0")) == depth
