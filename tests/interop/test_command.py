"""Our command beside Debian's rostopic, rosnode, rosservice, rosparam: same graph, same answers, on both masters."""

from __future__ import annotations

import json
import os
import pathlib
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import pytest
import yaml  # type: ignore[import-untyped,unused-ignore]

import peers
from interop.ros1 import Master, Program, Tools, wait_until

CROWD = {
    "header": {"seq": 0, "stamp": {"secs": 1, "nsecs": 2}, "frame_id": "hall"},
    "people": [{"name": {"first": "Ada", "last": "Lovelace"}, "leds": {"red": 1, "green": 2, "blue": 255}}],
    "lamps": [{"red": n, "green": 0, "blue": 0} for n in range(3)],
    "guests": [{"first": "a", "last": "b"}, {"first": "c", "last": "d"}],
    "path": [{"x": 0.5, "y": -1.0, "z": 2.0, "time": {"secs": 3, "nsecs": 4}}],
}


class Command:
    """`roslet` as a process of its own, which has nothing of ROS in its environment but the master's address."""

    def __init__(self, master: Master) -> None:
        self.environment = {
            **os.environ,
            "PYTHONPATH": str(peers.ROOT / "src"),
            "ROS_MASTER_URI": master.uri,
            "ROS_IP": "127.0.0.1",
        }

    def run(self, *arguments: str, code: int = 0) -> str:
        done = subprocess.run(
            [sys.executable, "-m", "roslet", *arguments],
            env=self.environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=20,
            check=False,
        )
        assert done.returncode == code, (
            f"roslet {' '.join(arguments)}: {done.returncode}\n{done.stdout}{done.stderr}"
        )
        return done.stdout

    def start(self, *arguments: str) -> Program:
        """A command that goes on until it is stopped."""
        return Program([sys.executable, "-m", "roslet", *arguments], self.environment)

    def json(self, *arguments: str) -> Any:
        return json.loads(self.run(*arguments, "--json"))


@pytest.fixture
def command(master: Master) -> Command:
    return Command(master)


@pytest.fixture
def published(tools: Tools, topic: str, command: Command) -> Iterator[Program]:
    """A rospy node, `rostopic pub`, that latches a message of a type that is not installed here."""
    program = tools.start("rostopic", "pub", "-l", topic, "peer_msgs/Crowd", json.dumps(CROWD))
    try:
        wait_until(lambda: topic in command.run("topic", "list", "--names").split(), "rostopic publishes")
        yield program
    finally:
        program.stop()


def test_echo_shows_what_rostopic_shows_of_a_type_that_is_not_installed_here(
    published: Program, command: Command, tools: Tools, topic: str
) -> None:
    theirs = next(yaml.safe_load_all(tools.run("rostopic", "echo", "-n", "1", topic)))
    ours = next(yaml.safe_load_all(command.run("topic", "echo", "-1", topic, "--timeout", "10")))
    theirs["header"].pop("seq"), ours["header"].pop("seq")
    assert ours == theirs
    assert ours["people"] == CROWD["people"]
    assert command.json("topic", "echo", "-1", topic, "--field", "path[0].time") == {"secs": 3, "nsecs": 4}


def test_lists_and_types_are_those_of_rostopic_and_rosnode(
    published: Program, command: Command, tools: Tools, topic: str
) -> None:
    assert command.run("topic", "list", "--names").split() == sorted(tools.run("rostopic", "list").split())
    assert command.run("node", "list", "--names").split() == sorted(tools.run("rosnode", "list").split())
    assert command.run("topic", "type", topic) == tools.run("rostopic", "type", topic) == "peer_msgs/Crowd\n"


def test_info_and_ping_and_kill_of_a_rospy_node(published: Program, command: Command, topic: str) -> None:
    (publisher,) = command.json("topic", "info", topic)["publishers"]
    info = command.json("node", "info", publisher["node"])
    assert info["uri"] == publisher["uri"]
    assert info["pid"] == published.process.pid
    assert {"topic": topic, "type": "peer_msgs/Crowd"} in info["publishes"]
    assert f"{publisher['node']}/get_loggers" in info["services"]
    assert command.json("node", "ping", publisher["node"], "-n", "1")["seconds"] > 0
    command.run("node", "kill", publisher["node"])
    wait_until(lambda: published.process.poll() is not None, "the rospy node ends")
    assert publisher["node"] not in command.run("node", "list", "--names").split()


def test_what_pub_publishes_rostopic_hears(command: Command, tools: Tools, topic: str) -> None:
    # rostopic subscribes only when it has learned the type from a publisher.
    latching = command.start(
        "topic", "pub", topic, "geometry_msgs/PointStamped", "header.frame_id:=map", "point.x:=1.5"
    )
    try:
        heard = next(yaml.safe_load_all(tools.run("rostopic", "echo", "-n", "1", topic)))
    finally:
        latching.stop()
    assert (heard["header"]["frame_id"], heard["point"]) == ("map", {"x": 1.5, "y": 0.0, "z": 0.0})


def test_pub_once_waits_for_a_rospy_subscriber(command: Command, tools: Tools, topic: str) -> None:
    first = command.start("topic", "pub", "-r", "5", topic, "std_msgs/String", "data:=first")
    ear = tools.start("rostopic", "echo", topic)
    try:
        ear.wait_for('data: "first"')
        first.stop()
        command.run("topic", "pub", "-1", topic, "std_msgs/String", "data:=once")
        ear.wait_for('data: "once"')
    finally:
        first.stop()
        ear.stop()
    assert ear.told('data: "once"') == ['data: "once"']


def test_services_of_a_rospy_node_are_listed_and_called(
    published: Program, command: Command, topic: str
) -> None:
    (publisher,) = command.json("topic", "info", topic)["publishers"]
    service = publisher["node"] + "/get_loggers"
    assert {"service": service, "nodes": [publisher["node"]], "type": "roscpp/GetLoggers"} in command.json(
        "service", "list", "--types-too", publisher["node"]
    )
    loggers = command.json("service", "call", service)["loggers"]
    assert "rosout" in [logger["name"] for logger in loggers]
    command.run("service", "call", publisher["node"] + "/set_logger_level", "logger:=rosout", "level:=debug")
    assert {"name": "rosout", "level": "DEBUG"} in command.json("service", "call", service)["loggers"]


def test_parameters_are_those_of_rosparam_both_ways(
    command: Command, tools: Tools, topic: str, tmp_path: pathlib.Path
) -> None:
    value = {"name": "näme: yes", "rates": [1, 2.5, True], "deep": {"er": -1}, "text": "0042"}
    (tmp_path / "ours.json").write_text(json.dumps(value), encoding="utf-8")
    command.run("param", "load", str(tmp_path / "ours.json"), topic)
    assert yaml.safe_load(tools.run("rosparam", "get", topic)) == value
    command.run("param", "dump", str(tmp_path / "ours.yaml"), topic)
    tools.run("rosparam", "load", str(tmp_path / "ours.yaml"), topic + "/copy")
    assert command.json("param", "get", topic + "/copy") == value
    assert command.run("param", "list").split() == sorted(tools.run("rosparam", "list").split())
    command.run("param", "delete", topic)
    assert topic + "/name" not in tools.run("rosparam", "list").split()


def test_hz_measures_a_rospy_publisher(command: Command, tools: Tools, topic: str) -> None:
    program = tools.start("rostopic", "pub", "-r", "50", topic, "std_msgs/String", "data: hello")
    try:
        wait_until(lambda: topic in command.run("topic", "list", "--names").split(), "rostopic publishes")
        figures = json.loads(command.run("topic", "hz", topic, "--for", "1", "--json").splitlines()[-1])
    finally:
        program.stop()
    assert 0 < figures["rate"] < 100
