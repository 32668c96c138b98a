"""Commands on ROS 2 beside a roslet node: in this process, whose participant they share, and as processes of their own."""

from __future__ import annotations

import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import roslet
from roslet.cli.ros2.parameters import flat, nested
from roslet.gen.runtime import message_class
from roslet.wire.time import Time

Run = Callable[..., Any]
Start = Callable[..., subprocess.Popen[Any]]

# One that hardly anybody on this host uses.
NETWORK = f"ros2://{20 + os.getpid() % 80}?range=localhost"


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setenv("ROSLET_NETWORK", NETWORK)
    return NETWORK


def count(goal: Any) -> Any:
    sequence = [0, 1]
    for _ in range(goal.request.order):
        if goal.cancel_requested:
            return goal.canceled(sequence=sequence)
        sequence.append(sequence[-1] + sequence[-2])
        goal.feedback(sequence=sequence)
        time.sleep(0.05)
    return {"sequence": sequence}


@pytest.fixture
def robot(network: str) -> Iterator[roslet.Node]:
    """A node with something of everything."""
    with roslet.Node("robot", network=network) as node:
        chatter = node.publisher("chatter", "std_msgs/msg/String")
        node.timer(0.05, lambda: chatter.publish(data="hello"))
        node.publisher(
            "kept", "std_msgs/msg/String", qos=roslet.QoS(1, durability="transient_local")
        ).publish(data="before")
        node.subscribe("cmd/vel", "geometry_msgs/msg/Twist", lambda message: None)
        node.service("enable", "std_srvs/srv/SetBool", lambda request: {"success": request.data})
        node.action_server("count", "example_interfaces/action/Fibonacci", count)
        node.declare_parameter("rate", 20, text="turns a second", range=(1, 100))
        node.declare_parameter("arm.speed", 0.5)
        node.start()
        yield node


# lists


@pytest.mark.parametrize("command", ["topic", "node", "service", "param", "action"])
def test_where_nothing_is_there_the_list_is_empty_and_a_note_says_so(
    command: str, run: Run, network: str
) -> None:
    outcome = run(command, "list")
    thing = {"param": "parameters"}.get(command, command + "s")
    assert (outcome.code, outcome.out, outcome.err) == (0, "", f"no {thing}\n")
    outcome = run(command, "list", "--json")
    assert (json.loads(outcome.out), outcome.err) == ([], "")


def test_lists_show_what_there_is_and_hide_the_parts_of_actions(run: Run, robot: roslet.Node) -> None:
    assert run("topic", "list").out.splitlines()[:3] == [
        "TOPIC              TYPE                               PUBLISHERS  SUBSCRIBERS",
        "/chatter           std_msgs/msg/String                         1            0",
        "/cmd/vel           geometry_msgs/msg/Twist                     0            1",
    ]
    assert "_action" not in run("topic", "list", "--names").out
    assert "/count/_action/feedback" in run("topic", "list", "--names", "--all").out.splitlines()
    assert run("topic", "list", "/cmd", "--names").out == "/cmd/vel\n"
    assert run("node", "list").out.split() == [
        "NODE", "PUBLISHES", "SUBSCRIBES", "SERVICES", "/robot", "6", "1", "11",
    ]  # fmt: skip
    assert "/enable" in run("service", "list", "--names").out.splitlines()
    assert "/count/_action/send_goal" in run("service", "list", "--names", "--all").out.splitlines()
    assert json.loads(run("action", "list", "--json").out) == [
        {
            "action": "/count",
            "type": "example_interfaces/action/Fibonacci",
            "servers": ["/robot"],
            "clients": [],
        }
    ]


def test_what_is_not_there_is_one_line_and_exit_code_1(run: Run, robot: roslet.Node) -> None:
    for command, text in (
        ("topic info /nothing", "nobody publishes or subscribes /nothing"),
        ("topic type /nothing", "nobody publishes or subscribes /nothing"),
        ("node info /nothing", "there is no node /nothing"),
        ("service info /nothing", "there is no service /nothing"),
        ("service call /nothing", "there is no service /nothing"),
        ("action info /nothing", "there is no action /nothing"),
        ("action send_goal /nothing 1", "nobody serves an action /nothing"),
        ("param get /nothing rate", "the node /nothing is not there"),
        ("param get /nothing/rate", "no node is called as /nothing/rate begins; write NODE NAME"),
        ("param get /robot nothing", "parameter nothing of /robot is not set"),
        ("param dump - /nothing", "no node with parameters below /nothing"),
    ):
        outcome = run(*command.split())
        assert (outcome.code, outcome.out, outcome.err) == (1, "", f"roslet: {text}\n")


@pytest.mark.parametrize("command", ["echo --timeout 1", "hz --for 1"])
@pytest.mark.parametrize(
    "topic, complaint",
    [("/1st", "character 2, '1', must not begin a name"), ("", "character 1, '/', must not end a name")],
)
def test_a_topic_that_cannot_be_is_not_waited_for(
    command: str, topic: str, complaint: str, run: Run, network: str
) -> None:
    outcome = run("topic", *command.split(), topic)
    assert (outcome.code, outcome.out) == (1, "")
    assert outcome.err == f"roslet: {topic or '/'!r}: {complaint}\n"


def test_a_node_is_shown_with_its_actions_apart_from_its_services(run: Run, robot: roslet.Node) -> None:
    shown = json.loads(run("node", "info", "/robot", "--json").out)
    assert shown["action_servers"] == [{"action": "/count", "type": "example_interfaces/action/Fibonacci"}]
    assert [row["topic"] for row in shown["subscribes"]] == ["/cmd/vel"]
    assert not [row for row in shown["services"] + shown["publishes"] if "_action" in str(row)]
    assert (
        "Action servers:\n  /count  example_interfaces/action/Fibonacci" in run("node", "info", "/robot").out
    )


# topics


def test_where_nodes_disagree_on_a_type_one_must_be_named(run: Run, network: str) -> None:
    with roslet.Node("some", network=network) as some, roslet.Node("others", network=network) as others:
        some.subscribe("t", "std_msgs/String", lambda message: None)
        others.subscribe("t", "std_msgs/Int8", lambda message: None)
        some.service("s", "std_srvs/Empty", lambda request: None)
        others.service("s", "std_srvs/Trigger", lambda request: None)
        some.action_server("a", "example_interfaces/action/Fibonacci", count)
        others.action_server("a", "tf2_msgs/action/LookupTransform", count)
        some.start()
        for command, name, types, remedy in (
            ("topic pub -1 /t - 1", "/t", "std_msgs/msg/Int8, std_msgs/msg/String", "name one instead of -"),
            ("service call /s", "/s", "std_srvs/srv/Empty, std_srvs/srv/Trigger", "give --type"),
            (
                "action send_goal /a",
                "/a",
                "example_interfaces/action/Fibonacci, tf2_msgs/action/LookupTransform",
                "give --type",
            ),
        ):
            outcome = run(*command.split())
            assert (outcome.code, outcome.out) == (2, "")
            assert outcome.err == f"roslet: {name} has several types, {types}; {remedy}\n"
        assert run("topic", "pub", "-1", "/t", "std_msgs/Int8", "1").code == 0
        assert run("service", "call", "/s", "--type", "std_srvs/Empty", "--timeout", "5").code == 0


def test_echo_takes_what_was_kept_and_what_comes(run: Run, robot: roslet.Node) -> None:
    assert run("topic", "echo", "/kept", "-1", "--timeout", "5").out == 'data: "before"\n---\n'
    assert run("topic", "echo", "/chatter", "-n", "2", "--field", "data").out == '"hello"\n---\n' * 2


def test_echo_of_a_topic_that_is_not_there_waits_for_it(run: Run, robot: roslet.Node) -> None:
    outcome = run("topic", "echo", "/nothing", "--timeout", "0.3")
    assert (outcome.code, outcome.err) == (1, "roslet: /nothing: no message within 0.3 s (0 publishers)\n")
    robot.timer(
        0.8, lambda: robot.publisher("late", "std_msgs/msg/String", qos=LATCHED).publish(data="x"), once=True
    )
    assert run("topic", "echo", "/late", "-1", "--timeout", "5").out == 'data: "x"\n---\n'


LATCHED = roslet.QoS(1, durability="transient_local")


def test_publishers_that_differ_are_all_heard_and_a_note_says_how(run: Run, network: str) -> None:
    with roslet.Node("two", network=network) as node:
        publishers = [
            node.publisher("mixed", "std_msgs/msg/String", qos=roslet.QoS(reliability=quality))
            for quality in ("reliable", "best_effort")
        ]

        def publish() -> None:
            for publisher in publishers:
                publisher.publish(data=publisher.qos.reliability)

        node.timer(0.05, publish)
        node.start()
        outcome = run("topic", "echo", "/mixed", "-n", "6", "--field", "data", "--json", "--timeout", "5")
    assert set(outcome.out.split()) == {'"reliable"', '"best_effort"'}
    assert outcome.err == "/mixed: only some publishers are reliable; subscribing best_effort, to hear all\n"


def test_a_type_that_is_known_to_its_publisher_alone_is_described_by_it(
    start: Start, run: Run, tmp_path: pathlib.Path, network: str
) -> None:
    package = tmp_path / "lab_msgs"
    (package / "msg").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>lab_msgs</name></package>")
    (package / "msg" / "Probe.msg").write_text("lab_msgs/Part[<=3] parts\nstring<=5 name\n")
    (package / "msg" / "Part.msg").write_text("float32[2] at\nbuiltin_interfaces/Time when\n")
    publisher = start(
        "topic",
        "pub",
        "--types",
        package,
        "-r",
        "20",
        "/probe",
        "lab_msgs/msg/Probe",
        "{name: a, parts: [{at: [1, 2]}]}",
    )
    outcome = run("topic", "echo", "/probe", "-1", "--json", "--timeout", "10")
    assert outcome.code == 1
    assert "no node of its publishers describes types; load it with --types DIR" in outcome.err
    publisher.send_signal(signal.SIGINT)
    script = tmp_path / "probe.py"
    script.write_text(
        f"import roslet\nlab = roslet.load({str(package)!r}).lab_msgs.msg\n"
        f"with roslet.Node('lab', network={network!r}) as node:\n"
        "    probe = node.publisher('probe', 'lab_msgs/msg/Probe')\n"
        "    node.timer(0.05, lambda: probe.publish(name='a', parts=[lab.Part(at=[1, 2])]))\n"
        "    node.spin()\n"
    )
    publisher.wait(5)
    process = subprocess.Popen([sys.executable, str(script)], env={**os.environ, "PYTHONPATH": "src"})
    try:
        outcome = run("topic", "echo", "/probe", "-1", "--json", "--timeout", "10")
    finally:
        process.terminate()
        process.wait(5)
    assert json.loads(outcome.out) == {
        "parts": [{"at": [1.0, 2.0], "when": {"sec": 0, "nanosec": 0}}],
        "name": "a",
    }


def test_hz_counts_no_message_of_before(run: Run, robot: roslet.Node) -> None:
    outcome = run("topic", "hz", "/kept", "--for", "0.5")
    assert (outcome.code, outcome.out) == (1, "/kept  no message yet\n")


def test_delay_needs_a_header(start: Start, robot: roslet.Node) -> None:
    process = start("topic", "delay", "/chatter", "--for", "5")
    _, err = process.communicate(timeout=10)
    assert (process.returncode, err) == (1, "roslet: std_msgs/msg/String has no header with a stamp\n")


def test_pub_latches_until_ctrl_c_and_its_node_is_hidden(start: Start, run: Run, network: str) -> None:
    process = start("topic", "pub", "/news", "std_msgs/String", "data:=kept")
    assert process.stderr is not None
    assert process.stderr.readline() == "publishing and latching /news until Ctrl-C\n"
    assert run("topic", "echo", "/news", "-1", "--timeout", "5").out == 'data: "kept"\n---\n'
    assert run("node", "list", "--names").out == ""
    assert run("node", "list", "--names", "--all").out.startswith("/_roslet_pub_")
    process.send_signal(signal.SIGINT)
    assert process.wait(5) == 130
    assert run("topic", "list", "--names").out == ""


def test_the_present_time_is_a_value_on_ros_2_too() -> None:
    from roslet.cli.values import build

    kind = message_class("ros2", "geometry_msgs/msg/PointStamped")
    for words in (["header:=auto"], ["{header: {stamp: now}}"], ["header.stamp:=now"]):
        stamp = build(kind, words, lambda: Time(5, 6)).header.stamp  # type: ignore[attr-defined]
        assert (stamp.sec, stamp.nanosec) == (5, 6)


# services and actions


def test_a_service_is_called_in_another_process(start: Start, robot: roslet.Node) -> None:
    process = start("service", "call", "/enable", "true")
    out, err = process.communicate(timeout=10)
    assert (process.returncode, out, err) == (0, 'success: true\nmessage: ""\n', "")


def test_a_service_that_comes_later_is_waited_for(run: Run, robot: roslet.Node) -> None:
    outcome = run("service", "call", "/later", "--wait", "0.2")
    assert (outcome.code, outcome.err) == (3, "roslet: there is no service /later within 0.2 s\n")
    robot.timer(
        1.0, lambda: robot.service("later", "std_srvs/srv/Trigger", lambda _: {"success": True}), once=True
    )
    assert run("service", "call", "/later", "--wait", "5").out == 'success: true\nmessage: ""\n'


def test_a_goal_is_sent_with_feedback_and_result(run: Run, robot: roslet.Node) -> None:
    outcome = run("action", "send_goal", "/count", "2", "--json")
    assert [json.loads(line) for line in outcome.out.splitlines()] == [
        {"feedback": {"sequence": [0, 1, 1]}},
        {"feedback": {"sequence": [0, 1, 1, 2]}},
        {"status": "SUCCEEDED", "result": {"sequence": [0, 1, 1, 2]}},
    ]


def test_ctrl_c_cancels_a_goal_and_shows_what_it_came_to(start: Start, robot: roslet.Node) -> None:
    process = start("action", "send_goal", "/count", "1000")
    assert process.stdout is not None
    assert process.stdout.readline() == "feedback:\n"
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=10)
    assert (process.returncode, err) == (130, "")
    assert 'status: "CANCELED"\nresult:\n  sequence: [0, 1, 1' in out


def test_ctrl_c_cancels_a_goal_that_is_accepted_only_afterwards(start: Start, robot: roslet.Node) -> None:
    asked = threading.Event()

    def accept(goal: Any) -> bool:
        asked.set()
        time.sleep(0.5)
        return True

    robot.action_server("slow", "example_interfaces/action/Fibonacci", count, on_goal=accept)
    process = start("action", "send_goal", "/slow", "1000")
    assert asked.wait(10)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=10)
    assert (process.returncode, err) == (130, "")
    assert 'status: "CANCELED"\nresult:\n' in out


def test_a_goal_that_takes_too_long_is_canceled(run: Run, robot: roslet.Node) -> None:
    outcome = run("action", "send_goal", "/count", "1000", "--timeout", "1", "--no-feedback")
    assert outcome.code == 3
    assert outcome.out.startswith('status: "CANCELED"\n')
    assert outcome.err == "roslet: /count: no result within 1 s; the goal is canceled\n"


# parameters


def test_parameters_go_both_ways(run: Run, robot: roslet.Node, tmp_path: pathlib.Path) -> None:
    assert {"/robot arm.speed", "/robot rate"} <= set(run("param", "list").out.splitlines())
    assert run("param", "set", "/robot", "arm.speed", "2").code == 0
    assert robot.get_parameter("arm.speed") == 2.0
    outcome = run("param", "set", "/robot/rate", "1000")
    assert (outcome.code, outcome.err[:30]) == (1, "roslet: /robot refuses: rate: ")
    assert run("param", "set", "/robot", "new", "1").err == (
        "roslet: /robot refuses: new: the node has declared no such parameter\n"
    )
    file = tmp_path / "robot.yaml"
    assert run("param", "dump", file).code == 0
    robot.set_parameter("arm.speed", 3.0)
    assert run("param", "load", file).code == 0
    assert robot.get_parameter("arm.speed") == 2.0
    file.write_text("/other:\n  ros__parameters: {rate: 5}\n")
    assert run("param", "load", file).err == f"roslet: {file} is for /other; no such node is there\n"
    file.write_text("{rate: 5, arm: {speed: 1.5}}")
    assert run("param", "load", file, "/robot").code == 0
    assert (robot.get_parameter("rate"), robot.get_parameter("arm.speed")) == (5, 1.5)


def test_names_with_dots_are_dicts_in_a_file_and_back() -> None:
    values = {"a": 1, "b.c": 2, "b.d.e": [3], "f": "x", "f.g": 4}
    assert nested(values) == {"a": 1, "b": {"c": 2, "d": {"e": [3]}}, "f": "x", "f.g": 4}
    assert flat(nested(values)) == values
