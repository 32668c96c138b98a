"""Parameters of a node on ROS 2: what its user, its arguments and others do with them."""

from __future__ import annotations

import pathlib
from typing import Any

import pytest

import roslet
from nodes import wait_until
from ros2_nodes import Ros2Nodes
from roslet.gen.runtime import message_class
from roslet.node.ros2.parameter_files import concerns

FILE = """
/**:
  ros__parameters:
    everywhere: 1
mover:
  ros__parameters:
    speed: 2.5
    limits: {high: 7, low: [1, 2]}
/other/mover:
  ros__parameters:
    speed: 9.0
"""


def call(node: roslet.Node, service: str, kind: str, **fields: Any) -> Any:
    with node.client(service, f"rcl_interfaces/srv/{kind}") as client:
        return client.call(timeout=5.0, **fields)


def message(kind: str, **fields: Any) -> Any:
    made: Any = message_class("ros2", kind)
    return made(**fields)


def value(kind: int, **fields: Any) -> Any:
    return message("rcl_interfaces/msg/ParameterValue", type=kind, **fields)


def parameter(name: str, found: Any) -> Any:
    return message("rcl_interfaces/msg/Parameter", name=name, value=found)


def test_a_declared_parameter_has_its_default_until_somebody_sets_it(make2: Ros2Nodes) -> None:
    node = make2("mover")
    assert node.declare_parameter("speed", 1.5) == 1.5
    assert node.declare_parameter("speed", 99.0) == 1.5
    node.set_parameter("speed", 2.5)
    assert node.get_parameter("speed") == 2.5
    assert node.parameter_names() == ["use_sim_time", "start_type_description_service", "speed"]


def test_arguments_win_over_defaults(make2: Ros2Nodes, tmp_path: pathlib.Path) -> None:
    (tmp_path / "file.yaml").write_text(FILE)
    node = make2(
        "mover",
        "--params-file",
        str(tmp_path / "file.yaml"),
        "-p",
        "extra:=[a, b]",
        "-p",
        "mover:everywhere:=3",
    )
    found = [
        node.declare_parameter(name, default)
        for name, default in (
            ("speed", 0.0),
            ("limits.high", 0),
            ("limits.low", [0]),
            ("everywhere", 0),
            ("extra", [""]),
        )
    ]
    assert found == [2.5, 7, [1, 2], 3, ["a", "b"]]


def test_a_rule_names_nodes_by_name_path_or_pattern() -> None:
    assert concerns("mover", "mover", "/arm/mover") and concerns("/arm/mover", "mover", "/arm/mover")
    assert concerns("/**", "mover", "/mover") and concerns("/*/mover", "mover", "/arm/mover")
    assert concerns("/arm/**", "mover", "/arm/left/mover") and not concerns("/*/mover", "mover", "/mover")
    assert not concerns("/mover", "mover", "/arm/mover") and not concerns("other", "mover", "/mover")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("- 1", "expected names of nodes"),
        ("a: {ros__parameters: 3}", "holds no parameters"),
        ("a: [", "line 1"),
    ],
)
def test_a_file_that_is_no_parameter_file_is_refused(
    make2: Ros2Nodes, tmp_path: pathlib.Path, text: str, said: str
) -> None:
    (tmp_path / "bad.yaml").write_text(text)
    with pytest.raises(roslet.InvalidName, match=said):
        make2("mover", "--params-file", str(tmp_path / "bad.yaml"))


def test_what_a_parameter_cannot_be_is_refused_with_the_reason(make2: Ros2Nodes) -> None:
    node = make2("mover")
    node.declare_parameter("speed", 1.0, range=(0.0, 2.0))
    node.declare_parameter("name", "arm", read_only=True)
    for name, wrong, said in (
        ("speed", 5.0, "out of range"),
        ("speed", "fast", "type"),
        ("name", "leg", "read-only"),
    ):
        with pytest.raises(roslet.ParameterRefused, match=said):
            node.set_parameter(name, wrong)
    assert node.get_parameter("speed") == 1.0 and node.get_parameter("name") == "arm"
    with pytest.raises(roslet.ParameterNotSet):
        node.get_parameter("nothing")
    assert node.get_parameter("nothing", 7) == 7


def test_others_ask_and_set_without_anybody_spinning(make2: Ros2Nodes) -> None:
    node, other = make2("mover"), make2("other")
    node.declare_parameter("speed", 1.0, range=(0.0, 2.0), text="metres a second")
    node.declare_parameter("names", ["a", "b"])
    found = call(other, "/mover/get_parameters", "GetParameters", names=["speed", "names"])
    assert [found.values[0].double_value, list(found.values[1].string_array_value)] == [1.0, ["a", "b"]]
    assert call(other, "/mover/get_parameters", "GetParameters", names=["speed", "none"]).values == []
    found = call(
        other,
        "/mover/set_parameters",
        "SetParameters",
        parameters=[
            parameter("speed", value(3, double_value=1.75)),
            parameter("speed", value(3, double_value=9.0)),
            parameter("none", value(1, bool_value=True)),
            parameter("speed", value(77)),
        ],
    )
    assert [one.successful for one in found.results] == [True, False, False, False]
    assert "out of range" in found.results[1].reason and "none" in found.results[2].reason
    assert node.get_parameter("speed") == 1.75
    (described,) = call(
        other, "/mover/describe_parameters", "DescribeParameters", names=["speed"]
    ).descriptors
    assert (described.type, described.description, described.floating_point_range[0].to_value) == (
        3,
        "metres a second",
        2.0,
    )
    listed = call(other, "/mover/list_parameters", "ListParameters", depth=2**64 - 1).result
    assert listed.names[-2:] == ["speed", "names"]
    assert (
        bytes(call(other, "/mover/get_parameter_types", "GetParameterTypes", names=["names"]).types)
        == b"\x09"
    )
    both = [parameter("speed", value(3, double_value=0.5)), parameter("names", value(4, string_value="x"))]
    assert not call(
        other, "/mover/set_parameters_atomically", "SetParametersAtomically", parameters=both
    ).result.successful
    assert node.get_parameter("speed") == 1.75


def test_changes_are_told_to_callbacks_and_on_parameter_events(make2: Ros2Nodes) -> None:
    node, other = make2("mover"), make2("other")
    heard: list[Any] = []
    events: list[Any] = []
    other.subscribe("/parameter_events", "rcl_interfaces/msg/ParameterEvent", events.append)
    node.declare_parameter("speed", 1)
    assert node.on_parameter("speed", heard.append) == 1
    node.set_parameter("speed", 2)
    wait_until(lambda: heard == [2] and len(events) >= 2, "both hear of it")
    changed = events[-1]
    assert (
        changed.node,
        changed.changed_parameters[0].name,
        changed.changed_parameters[0].value.integer_value,
    ) == (
        "/mover",
        "speed",
        2,
    )
    node.off_parameter("speed", heard.append)
    node.delete_parameter("speed")
    wait_until(lambda: events[-1].deleted_parameters, "the end is told as well")
    assert heard == [2] and not node.has_parameter("speed")


def test_use_sim_time_makes_the_clock_follow_its_topic(make2: Ros2Nodes) -> None:
    node, other = make2("mover", "-p", "use_sim_time:=true"), make2("other")
    assert node.clock.simulated and node.now().to_sec() == 0.0
    clock = other.publisher("/clock", "rosgraph_msgs/msg/Clock", qos=roslet.QoS(1, reliability="best_effort"))
    fired: list[float] = []
    node.timer(10.0, lambda: fired.append(node.now().to_sec()))
    for sec in (100, 105, 111):
        clock.publish(clock=message("builtin_interfaces/msg/Time", sec=sec, nanosec=500))
        wait_until(lambda sec=sec: int(node.now().to_sec()) == sec, "the clock follows")  # type: ignore[misc]
    wait_until(lambda: fired, "the timer goes by it")
    node.set_parameter("use_sim_time", False)
    assert node.now().to_sec() > 1e9


def test_a_type_is_described_to_whoever_asks(make2: Ros2Nodes) -> None:
    make2("mover")
    other = make2("other")
    kind = "type_description_interfaces/srv/GetTypeDescription"
    with other.client("/mover/get_type_description", kind) as client:
        found = client.call(type_name="geometry_msgs/msg/Point", timeout=5.0)
        assert found.successful
        assert [(one.name, one.type.type_id) for one in found.type_description.type_description.fields] == [
            ("x", 11),
            ("y", 11),
            ("z", 11),
        ]
        wrong = client.call(type_name="geometry_msgs/msg/Point", type_hash="RIHS01_0", timeout=5.0)
        assert not wrong.successful and "RIHS01_0" in wrong.failure_reason
        assert not client.call(type_name="no/such/Type", timeout=5.0).successful


def test_arguments_set_the_level_of_the_log(make2: Ros2Nodes) -> None:
    quiet = make2("quiet", "--log-level", "ERROR")
    told: list[str] = []
    other = make2("arm", "--log-level", "fatal", "--log-level", "left.arm:=debug", namespace="/left")
    qos = roslet.QoS(10, durability="transient_local")
    other.subscribe("/rosout", "rcl_interfaces/msg/Log", lambda entry: told.append(entry.msg), qos=qos)
    quiet.log.warning("not this")
    quiet.log.error("this")
    other.log.debug("and this")
    wait_until(lambda: len(told) == 2, "both come")
    assert sorted(told) == ["and this", "this"]
    with pytest.raises(roslet.InvalidName, match="loud"):
        make2("node", "--log-level", "loud")
