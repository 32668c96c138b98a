"""ROS 2 names: DDS mangling, legality, resolution, remapping, arguments. Expected values are written by hand from the design
documents."""

import pytest

from roslet.errors import InvalidName
from roslet.names import (
    MAX_NODE_NAME,
    MAX_ROS2_NAME,
    REPLY,
    REQUEST,
    TOPIC,
    ParameterOverride,
    Remapping,
    Ros2Arguments,
    check_full_name,
    check_namespace,
    check_node_name,
    check_ros2_name,
    dds_service_types,
    dds_topic,
    dds_type,
    expand,
    resolve_ros2,
    ros_service_type,
    ros_topic,
    ros_type,
)

pytestmark = pytest.mark.micropython


@pytest.mark.parametrize(
    ("kind", "name", "topic"),
    [
        (TOPIC, "/a", "rt/a"),
        (TOPIC, "/a/b", "rt/a/b"),
        (REQUEST, "/s", "rq/sRequest"),
        (REPLY, "/n/s", "rr/n/sReply"),
        (REQUEST, "/Request", "rq/RequestRequest"),
        (TOPIC, "/Reply", "rt/Reply"),
    ],
)
def test_a_name_in_dds_and_back(kind: str, name: str, topic: str) -> None:
    assert dds_topic(kind, name) == topic
    assert ros_topic(topic) == (kind, name)


@pytest.mark.parametrize(
    "topic", ["", "a", "rt", "rt/", "rx/a", "rq/a", "rq/Request", "rr/aRequest", "ros_discovery_info"]
)
def test_a_topic_that_is_not_of_ros_is_none(topic: str) -> None:
    assert ros_topic(topic) is None


def test_a_type_in_dds_and_back() -> None:
    assert dds_type("std_msgs/msg/String") == "std_msgs::msg::dds_::String_"
    assert ros_type("std_msgs::msg::dds_::String_") == "std_msgs/msg/String"
    request, response = dds_service_types("example_interfaces/srv/AddTwoInts")
    assert request == "example_interfaces::srv::dds_::AddTwoInts_Request_"
    assert response == "example_interfaces::srv::dds_::AddTwoInts_Response_"
    for one in (request, response):
        assert ros_service_type(one) == "example_interfaces/srv/AddTwoInts"
    assert ros_type(request) == "example_interfaces/srv/AddTwoInts_Request"


@pytest.mark.parametrize(
    "name", ["", "String_", "std_msgs::String_", "a::msg::dds_::_", "a::msg::dds::S_", "a::msg::dds_::S"]
)
def test_a_type_that_is_not_of_ros_is_none(name: str) -> None:
    assert ros_type(name) is None
    assert ros_service_type(name) is None


def test_a_type_that_is_no_service_is_none() -> None:
    assert ros_service_type("std_msgs::msg::dds_::String_") is None
    assert ros_service_type("a::srv::dds_::_Request_") is None


@pytest.mark.parametrize("name", ["", "std_msgs/String", "String", "a/b/c/d", "a//b"])
def test_a_type_has_three_parts(name: str) -> None:
    with pytest.raises(InvalidName):
        dds_type(name)


@pytest.mark.parametrize(
    "name",
    ["a", "/a/b", "~", "~/a", "_hidden", "/a/_b", "a1", "{node}", "{ns}/a", "/x{node}/b", "a__b", "~/{node}"],
)
def test_a_legal_name_is_itself(name: str) -> None:
    assert check_ros2_name(name) == name


@pytest.mark.parametrize(
    ("name", "where"),
    [
        ("", "empty"),
        ("1a", "character 1"),
        ("/a/1b", "character 4"),
        ("a b", "character 2"),
        ("a~", "character 2"),
        ("~a", "'~' is followed"),
        ("/~/a", "character 2"),
        ("a-b", "character 2"),
        ("a//b", "between two slashes, at character 3"),
        ("a/", "character 2"),
        ("/", "character 1"),
        ("a{b", "character 2, '{', is never closed"),
        ("a}b", "character 2"),
        ("a{}", "character 2"),
        ("a{1}", "character 2"),
        ("{a/b}", "character 3"),
        ("{a{b}}", "character 3"),
        ("\u00e4", "character 1"),
    ],
)
def test_an_illegal_name_says_where_it_is_wrong(name: str, where: str) -> None:
    with pytest.raises(InvalidName, match=where):
        check_ros2_name(name)


def test_names_have_bounds() -> None:
    assert check_full_name("/" + "a" * (MAX_ROS2_NAME - 1))
    with pytest.raises(InvalidName, match="at most 247"):
        check_full_name("/" + "a" * MAX_ROS2_NAME)
    assert check_node_name("a" * MAX_NODE_NAME)
    with pytest.raises(InvalidName, match="at most 255"):
        check_node_name("a" * (MAX_NODE_NAME + 1))


@pytest.mark.parametrize("name", ["", "a/b", "/a", "1a", "a-b", "~", "a{b}"])
def test_a_node_name_is_one_word(name: str) -> None:
    with pytest.raises(InvalidName):
        check_node_name(name)
    assert check_node_name("_talker_1") == "_talker_1"


def test_a_namespace_is_a_full_name() -> None:
    assert check_namespace("/") == "/"
    assert check_namespace("/a/b") == "/a/b"
    for name in ("", "a", "/a/", "//", "/1", "/{node}"):
        with pytest.raises(InvalidName):
            check_namespace(name)


@pytest.mark.parametrize(
    ("name", "namespace", "full"),
    [
        ("a", "/", "/a"),
        ("a", "/n", "/n/a"),
        ("/a", "/n", "/a"),
        ("~", "/", "/node"),
        ("~/a", "/n", "/n/node/a"),
        ("{node}/a", "/n", "/n/node/a"),
        ("/{node}", "/n", "/node"),
        ("{ns}/a", "/n", "/n/a"),
        ("{namespace}/{node}", "/n", "/n/node"),
        ("a/b", "/n/m", "/n/m/a/b"),
    ],
)
def test_a_name_is_resolved_in_its_node(name: str, namespace: str, full: str) -> None:
    assert expand(name, "node", namespace) == full
    assert resolve_ros2(name, "node", namespace) == full


def test_an_unknown_substitution_is_refused() -> None:
    with pytest.raises(InvalidName, match="nose} is no substitution"):
        expand("{nose}", "node")
    with pytest.raises(InvalidName, match="between two slashes"):
        expand("{ns}/a", "node", "/")


def rules(*texts: str) -> "list[Remapping]":
    arguments = ["--ros-args"]
    for text in texts:
        arguments += ["-r", text]
    return Ros2Arguments(arguments).remappings


def test_the_first_rule_that_fits_is_taken_once() -> None:
    assert resolve_ros2("a", "node", "/n", rules("a:=b", "b:=c", "a:=d")) == "/n/b"
    assert resolve_ros2("/n/a", "node", "/n", rules("a:=/b")) == "/b"
    assert resolve_ros2("a", "node", "/n", rules("/a:=b")) == "/n/a"
    assert resolve_ros2("~/a", "node", "/n", rules("~/a:=~/b")) == "/n/node/b"
    assert resolve_ros2("a", "node", "/", rules("other:a:=b", "node:a:=c")) == "/c"


def test_a_rule_may_be_for_topics_or_for_services() -> None:
    both = rules("rostopic://a:=topic", "node:rosservice://a:=service")
    assert both == [Remapping("", "a", "topic", TOPIC), Remapping("node", "a", "service", REQUEST)]
    assert resolve_ros2("a", "node", "/", both) == "/topic"
    assert resolve_ros2("a", "node", "/", both, REQUEST) == "/service"
    assert resolve_ros2("a", "node", "/", both, REPLY) == "/service"
    assert resolve_ros2("a", "other", "/", both, REQUEST) == "/a"


def test_a_node_is_renamed() -> None:
    arguments = Ros2Arguments(["--ros-args", "-r", "a:__node:=b", "--remap", "__ns:=/x", "-r", "c:__name:=d"])
    assert arguments.node_name("a") == "b"
    assert arguments.node_name("c") == "d"
    assert arguments.node_name("e") == "e"
    assert arguments.namespace("b") == "/x"
    assert Ros2Arguments([]).namespace("b") == "/"
    assert Ros2Arguments([]).namespace("b", "n") == "/n"
    with pytest.raises(InvalidName):
        Ros2Arguments([]).node_name("a b")
    assert resolve_ros2("t", "b", "/x", arguments.remappings) == "/x/t"


def test_arguments_are_sorted() -> None:
    words = "one --ros-args -p a:=1 --params-file f.yaml -p n:b.c:=[1,2] -- two -r --ros-args --log-level warn --log-level"
    words += " x.y:=DEBUG -e /e --disable-stdout-logs --enable-rosout-logs --log-config-file l --log-file-name m --x -r a:=b"
    arguments = Ros2Arguments(words.split())
    assert arguments.rest == ["one", "two", "-r"]
    assert arguments.overrides == [
        ParameterOverride("", "a", "1"),
        ParameterOverride("", "", "", "f.yaml"),
        ParameterOverride("n", "b.c", "[1,2]"),
    ]
    assert arguments.log_levels == {"": "warn", "x.y": "DEBUG"}
    assert arguments.enclave == "/e"
    assert arguments.switches == {"stdout-logs": False, "rosout-logs": True}
    assert (arguments.log_config_file, arguments.log_file_name) == ("l", "m")
    assert arguments.unknown == ["--x"]
    assert arguments.remappings == [Remapping("", "a", "b")]


@pytest.mark.parametrize(
    "text", ["", "a", "a:=", ":=b", "a b:=c", "a:=b c", "n m:a:=b", "__node:=a/b", "__ns:=/a/"]
)
def test_a_remapping_that_is_none_is_refused(text: str) -> None:
    with pytest.raises(InvalidName):
        rules(text)


@pytest.mark.parametrize("arguments", [["-p", "a"], ["-p", ":=1"], ["-r"], ["--params-file"], ["-e"]])
def test_a_flag_without_its_value_is_refused(arguments: "list[str]") -> None:
    with pytest.raises(InvalidName):
        Ros2Arguments(["--ros-args"] + arguments)  # noqa: RUF005 - as MicroPython compiles it
