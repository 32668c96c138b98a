"""Our command beside an rclpy program (Kilted): what it shows of it, asks it and tells it."""

from __future__ import annotations

import json
import os
import pathlib
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import Any

import pytest

import peers
from interop.namespace import Namespace, Program, connect

PROGRAM = peers.ROOT / "tests/interop/peers/rclpy_robot.py"
STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"


class Command:
    """`roslet` as a process of its own in the peer's namespace."""

    def __init__(self, namespace: Namespace) -> None:
        self.namespace = namespace
        self.environment = {key: value for key, value in os.environ.items() if not key.startswith("ROS_")}
        self.environment["PYTHONPATH"] = str(peers.ROOT / "src")

    def start(self, *arguments: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [*self.namespace._enter(), sys.executable, "-m", "roslet", *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=self.environment,
        )

    def outcome(self, *arguments: str) -> tuple[int, str, str]:
        process = self.start(*arguments)
        try:
            out, err = process.communicate(timeout=40)
        finally:
            process.kill()
        return process.returncode, out, err

    def run(self, *arguments: str, code: int = 0) -> str:
        """What it prints."""
        found, out, err = self.outcome(*arguments)
        assert found == code, f"exit code {found}: {out}{err}"
        return out

    def json(self, *arguments: str, code: int = 0) -> Any:
        return json.loads(self.run(*arguments, "--json", code=code))


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Program]:
    with Namespace(tmp_path_factory.mktemp("robot")) as namespace:
        program = namespace.start(str(peers.require("kilted")), str(PROGRAM), name="robot")
        program.wait_for("ready", 60.0)
        program.namespace = namespace  # type: ignore[attr-defined]
        yield program


@pytest.fixture
def command(robot: Program) -> Command:
    return Command(robot.namespace)  # type: ignore[attr-defined]


def test_topics_are_listed_with_their_types_and_counts(command: Command) -> None:
    rows = {row["topic"]: row for row in command.json("topic", "list")}
    assert rows["/chatter"] == {
        "topic": "/chatter",
        "type": "std_msgs/msg/String",
        "publishers": ["/robot"],
        "subscribers": [],
    }
    assert rows["/imu"]["subscribers"] == ["/robot_listener"]
    assert set(rows["/rosout"]["publishers"]) == {"/robot", "/robot_listener", "/twin"}
    assert command.run("topic", "find", "geometry_msgs/Twist") == "/cmd\n"


def test_a_topic_is_shown_with_type_hash_gid_and_qos(command: Command) -> None:
    shown = command.json("topic", "info", "/map")
    assert shown["subscribers"] == []
    assert [(one["node"], one["type"]) for one in shown["publishers"]] == [
        ("/robot", "geometry_msgs/msg/Point")
    ]
    assert shown["publishers"][0]["qos"] == {
        "reliability": "reliable",
        "durability": "transient_local",
        "deadline": None,
        "lifespan": None,
        "liveliness": "automatic",
        "liveliness_lease": None,
    }
    text = command.run("topic", "info", "-v", "/chatter")
    assert STRING_HASH in text
    assert "gid   01.0f." in text


def test_nodes_are_listed_and_the_command_is_not_among_them(command: Command) -> None:
    assert command.run("node", "list", "--all", "--names") == "/robot\n/robot_listener\n/twin\n"


def test_a_node_is_shown_with_what_it_has(command: Command) -> None:
    shown = command.json("node", "info", "/robot")
    assert (shown["vendor"], shown["host"]) == ("eProsima Fast DDS", "127.0.0.1")
    assert [row["topic"] for row in shown["publishes"]] == [
        "/chatter",
        "/imu",
        "/map",
        "/parameter_events",
        "/rosout",
    ]
    assert [(row["topic"], row["type"]) for row in shown["subscribes"]] == [
        ("/cmd", "geometry_msgs/msg/Twist")
    ]
    assert {"service": "/enable", "type": "std_srvs/srv/SetBool"}.items() <= shown["services"][0].items()


@pytest.mark.parametrize("topic", ["/chatter", "/imu", "/map"])
def test_echo_hears_publishers_of_any_quality(command: Command, topic: str) -> None:
    assert command.json("topic", "echo", topic, "-1", "--timeout", "10")


def test_echo_shows_messages_and_a_late_one_of_a_transient_local_topic(command: Command) -> None:
    assert command.run("topic", "echo", "/chatter", "-n", "2") == 'data: "hello"\n---\n' * 2
    assert command.run("topic", "echo", "/map", "-1") == "x: 1.0\ny: 2.0\nz: 3.0\n---\n"


def test_a_definition_that_differs_gives_way_to_the_description_of_the_publisher(
    command: Command, tmp_path: pathlib.Path
) -> None:
    package = tmp_path / "geometry_msgs"
    (package / "msg").mkdir(parents=True)
    (package / "msg" / "Point.msg").write_text("float32 wrong\n")
    (package / "package.xml").write_text("<package><name>geometry_msgs</name></package>")
    assert command.run("topic", "echo", "/map", "-1", "--types", str(package), "--timeout", "10") == (
        "x: 1.0\ny: 2.0\nz: 3.0\n---\n"
    )


def test_echo_of_a_quality_that_nobody_offers_fails_in_time(command: Command) -> None:
    code, out, err = command.outcome(
        "topic", "echo", "/imu", "--qos", "reliability=reliable", "--timeout", "1"
    )
    assert (code, out) == (1, "")
    assert "QoS reliability" in err
    assert "no message within 1 s (0 publishers)" in err


def test_hz_bw_and_delay_measure(command: Command) -> None:
    rows = [
        json.loads(line)
        for line in command.run("topic", "hz", "/chatter", "/imu", "--for", "2", "--json").splitlines()
    ]
    assert {row["topic"] for row in rows[-2:]} == {"/chatter", "/imu"}
    assert all(10 < row["rate"] < 30 for row in rows[-2:])
    last = json.loads(command.run("topic", "bw", "/chatter", "--for", "1", "--json").splitlines()[-1])
    assert last["mean"] == 4 + 4 + 6 + 2  # encapsulation, length, `hello` with its NUL, padding
    last = json.loads(command.run("topic", "delay", "/imu", "--for", "1", "--json").splitlines()[-1])
    assert 0 < last["minimum"] <= last["mean"] < 1


def test_pub_once_reaches_the_subscriber_that_there_is(command: Command, robot: Program) -> None:
    begin = len(robot.lines())
    command.run("topic", "pub", "-1", "/cmd", "geometry_msgs/Twist", "linear.x:=0.25")
    robot.wait_until(lambda lines: "drove 0.25" in lines[begin:], 5, "drove 0.25")
    command.run("topic", "pub", "-r", "20", "-n", "3", "/cmd", "-", "linear.x:=0.5")
    robot.wait_until(lambda lines: lines[begin:].count("drove 0.5") == 3, 5, "drove 0.5, three times")


def test_services_are_listed_shown_and_called(command: Command) -> None:
    rows = {row["service"]: row for row in command.json("service", "list", "-t")}
    assert rows["/enable"] == {"service": "/enable", "nodes": ["/robot"], "type": "std_srvs/srv/SetBool"}
    assert command.run("service", "type", "/enable") == "std_srvs/srv/SetBool\n"
    assert command.run("service", "find", "std_srvs/SetBool") == "/enable\n"
    shown = command.json("service", "info", "/enable")
    assert (shown["nodes"], shown["request"]) == (["/robot"], ["bool data"])
    assert command.run("service", "call", "/enable", "true") == 'success: true\nmessage: "on"\n'
    assert command.outcome("service", "call", "/nothing") == (
        1,
        "",
        "roslet: there is no service /nothing\n",
    )


def test_parameters_are_listed_read_and_described(command: Command) -> None:
    names = command.run("param", "list", "/robot").split("\n")
    assert {"/robot rate", "/robot arm.speed", "/robot serial"} <= set(names)
    assert command.run("param", "get", "/robot", "rate") == "20\n"
    assert command.run("param", "get", "/robot/serial") == "0042\n"
    assert command.json("param", "get", "/robot/arm.joints") == ["a", "b"]
    assert command.run("param", "get", "/robot", "nothing", "--default", "7") == "7\n"
    assert command.outcome("param", "get", "/robot", "nothing")[2] == (
        "roslet: parameter nothing of /robot is not set\n"
    )
    (described,) = command.json("param", "describe", "/robot", "rate")
    assert described["description"] == "turns a second"
    assert described["range"] == {"from": 1, "to": 100, "step": 1}


def test_parameters_are_set_where_the_node_takes_them(command: Command) -> None:
    command.run("param", "set", "/robot", "arm.speed", "2")  # an integer, for a double
    assert command.json("param", "get", "/robot/arm.speed") == 2.0
    command.run("param", "set", "/robot/spare", "[1.5, 2.5]")
    assert command.json("param", "get", "/robot/spare") == [1.5, 2.5]
    command.run("param", "delete", "/robot/spare")
    assert command.outcome("param", "get", "/robot/spare")[0] == 1
    for name, value in (("rate", "1000"), ("serial", "x"), ("rate", "fast"), ("nothing", "1")):
        code, _, err = command.outcome("param", "set", "/robot", name, value)
        assert code == 1
        assert err.startswith("roslet: /robot refuses: ")


def test_a_dump_is_loaded_again(command: Command, tmp_path: pathlib.Path) -> None:
    file = tmp_path / "robot.yaml"
    command.run("param", "set", "/robot", "arm.speed", "0.5")
    command.run("param", "dump", str(file), "/robot")
    text = file.read_text()
    assert text.startswith("/robot:\n  ros__parameters:\n    arm:\n      joints:\n      - a\n")
    file.write_text(text.replace("speed: 0.5", "speed: 0.75").replace("    serial: '0042'\n", ""))
    command.run("param", "load", str(file))
    assert command.run("param", "get", "/robot/arm.speed") == "0.75\n"
    file.write_text("/**:\n  ros__parameters:\n    arm: {speed: 0.25}\n")
    command.run("param", "load", str(file), "/robot")
    assert command.run("param", "get", "/robot/arm.speed") == "0.25\n"


def test_the_doctor_names_a_mismatch_and_a_name_that_two_have(command: Command) -> None:
    findings = command.json("doctor", "--for", "4", code=1)
    about = {row["about"]: row for row in findings}
    assert about["topic /imu"]["level"] == "problem"
    assert about["topic /imu"]["text"] == "/robot_listener hears nothing of /robot: QoS reliability"
    assert about["topic /imu"]["remedy"] == "let the publisher be reliable, or the subscription best_effort"
    assert about["node /twin"]["text"].startswith("2 nodes have this name")
    (participant,) = [row for row in findings if row["about"] == "participants"]
    assert "eProsima Fast DDS, RTPS 2." in participant["text"]
    assert "/robot, /robot_listener, /twin, /twin" in participant["text"]
    assert [row["text"] for row in findings if row["level"] == "ok" and row["about"] == "multicast"] == [
        "lo (127.0.0.1) sends to 239.255.0.1 and hears itself",
        "announcements of all 1 participants come in",
    ]


def test_ctrl_c_ends_an_echo_and_its_node_is_gone(command: Command) -> None:
    process = command.start("topic", "echo", "/chatter")
    assert process.stdout is not None
    assert process.stdout.readline() == 'data: "hello"\n'
    process.send_signal(signal.SIGINT)
    begin = time.monotonic()
    _, err = process.communicate(timeout=10)
    assert (process.returncode, err) == (130, "")
    assert time.monotonic() - begin < 2
    assert command.run("node", "list", "--all", "--names") == "/robot\n/robot_listener\n/twin\n"


def test_the_doctor_without_anybody_and_without_a_route_for_multicast(tmp_path: pathlib.Path) -> None:
    with Namespace(tmp_path, route=False) as namespace:
        code, out, _ = Command(namespace).outcome("doctor", "--for", "0.5", "--json")
    about = [(row["about"], row["level"], row["remedy"]) for row in json.loads(out)]
    assert code == 0
    assert ("multicast", "warning", "ip route add 239.0.0.0/8 dev lo") in about
    assert [level for name, level, _ in about if name == "participants"] == ["warning"]


def test_the_doctor_hears_another_host_and_names_an_interface_without_multicast(
    tmp_path: pathlib.Path,
) -> None:
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
    with (
        Namespace(tmp_path / "here", route=False) as here,
        Namespace(tmp_path / "there", route=False) as there,
    ):
        connect(here, there, "cable", "10.0.1")
        there.start(str(peers.require("kilted")), str(PROGRAM), name="robot").wait_for("ready", 60.0)
        rows = json.loads(Command(here).outcome("doctor", "--for", "4", "--json")[1])
        texts = [row["text"] for row in rows]
        assert "cable (10.0.1.1) sends to 239.255.0.1 and hears itself" in texts
        assert "announcements of all 1 participants come in" in texts
        assert next(row["text"] for row in rows if row["about"] == "participants").startswith(
            "10.0.1.2: eProsima Fast DDS"
        )
        here.run("ip link set cable multicast off")
        rows = json.loads(Command(here).outcome("doctor", "--for", "0.5", "--json")[1])
        assert {
            "about": "interfaces",
            "level": "warning",
            "text": "cable has multicast switched off",
            "remedy": "ip link set cable multicast on, or name the others in $ROS_STATIC_PEERS",
        } in rows
