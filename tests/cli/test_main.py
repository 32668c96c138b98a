"""The command as a whole: help, exit codes, errors as one line, imports."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import pytest

from roslet.cli.main import COMMANDS, build
from roslet.cli.options import default_network

Run = Callable[..., Any]

LEAVES = [
    "topic list", "topic echo", "topic pub", "topic hz", "topic bw", "topic delay", "topic info", "topic type", "topic find",
    "node list", "node info", "node ping", "node kill",
    "service list", "service call", "service type", "service info", "service find",
    "action list", "action info", "action send_goal",
    "param list", "param get", "param set", "param delete", "param describe", "param dump",
    "param load",
    "interface show", "interface hash", "interface size", "interface list",
    "gen cpp", "gen python", "master", "doctor", "run", "bench", "demo",
    "gateware build",
    "gateware sim",
    "micropython bundle", "micropython run",
]  # fmt: skip


@pytest.mark.parametrize("command", LEAVES)
def test_every_command_has_help_with_an_example(command: str, run: Run) -> None:
    outcome = run(*command.split(), "--help")
    assert outcome.code == 0
    assert f"\n  roslet {command}" in outcome.out


def test_the_commands_tested_are_all_there_are() -> None:
    found = []
    for group in COMMANDS:
        parser = build(group)
        groups: Any = next(action for action in parser._actions if action.dest == "group")
        inner = [action for action in groups.choices[group]._actions if action.dest == "command"]
        names = [f"{group} {name}" for action in inner for name in action.choices] if inner else [group]
        found += names
    assert sorted(found) == sorted(LEAVES)


def test_help_lists_groups_and_exit_codes(run: Run) -> None:
    outcome = run("--help")
    assert outcome.code == 0
    assert all(f"    {group} " in outcome.out for group in COMMANDS)
    assert "nobody reachable" in outcome.out


def test_without_a_command_there_is_help(run: Run) -> None:
    assert "commands:" in run().out


def test_the_version_is_printed(run: Run) -> None:
    import roslet

    assert run("--version").out == f"roslet {roslet.__version__}\n"


@pytest.mark.parametrize(
    "arguments", ["nonsense", "topic", "topic nonsense", "topic echo", "param get a b c"]
)
def test_wrong_usage_is_exit_code_2(arguments: str, run: Run) -> None:
    outcome = run(*arguments.split())
    assert outcome.code == 2
    assert "usage: roslet" in outcome.err


@pytest.mark.parametrize(
    "command",
    [
        "topic list", "topic info /a", "topic type /a", "topic echo /a", "topic hz /a", "topic bw /a",
        "topic pub -1 /a std_msgs/Empty", "node list", "node info /a", "node ping /a", "node kill /a", "service list",
        "service info /a", "service type /a", "service call /a", "param list", "param get /a", "param set /a 1",
        "param delete /a", "param dump",
    ],
)  # fmt: skip
def test_without_a_master_every_graph_command_says_so_with_exit_code_3(command: str, run: Run) -> None:
    outcome = run(*command.split())
    assert (outcome.code, outcome.out) == (3, "")
    assert outcome.err == "roslet: cannot reach the master at http://127.0.0.1:1 (Connection refused)\n"


def test_a_network_that_is_none_is_one_line(run: Run) -> None:
    outcome = run("topic", "list", "--network", "http://localhost")
    assert outcome.code == 1
    assert outcome.err == (
        "roslet: 'http://localhost' is no network; write ros2://DOMAIN or ros1://host:port\n"
    )


@pytest.mark.parametrize(
    "variables, network",
    [
        ({}, "ros2://"),
        ({"ROS_MASTER_URI": "http://robot:11311"}, "ros1://"),
        ({"ROS_MASTER_URI": ""}, "ros2://"),
        ({"ROSLET_NETWORK": "ros2://7", "ROS_MASTER_URI": "http://robot:11311"}, "ros2://7"),
        ({"ROSLET_NETWORK": "ros1://robot"}, "ros1://robot"),
    ],
)
def test_the_environment_decides_on_the_network_of_a_command_that_is_told_none(
    variables: dict[str, str], network: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("ROSLET_NETWORK", "ROS_MASTER_URI"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert default_network() == network
    assert build("topic").parse_args(["topic", "list"]).network == network
    assert build("topic").parse_args(["topic", "list", "--network", "ros2://3"]).network == "ros2://3"


@pytest.mark.parametrize("command", ["node ping /a", "node kill /a"])
def test_what_ros_2_lacks_is_one_line(command: str, run: Run) -> None:
    outcome = run(*command.split(), "--network", "ros2://")
    assert outcome.code == 1
    assert outcome.err == f"roslet: {' '.join(command.split()[:2])}: the ROS 2 network has no such call\n"


def test_run_says_where_the_domain_of_an_rclpy_program_is(run: Run) -> None:
    outcome = run("run", "--network", "ros2://5", "talker.py")
    assert outcome.code == 1
    assert outcome.err == (
        "roslet: --network names the master of a rospy program; set $ROS_DOMAIN_ID for one of rclpy\n"
    )


@pytest.mark.parametrize("command", ["action list", "action info /a", "action send_goal /a"])
def test_what_ros_1_lacks_is_one_line(command: str, run: Run) -> None:
    outcome = run(*command.split(), "--network", "ros1://")
    assert outcome.code == 1
    assert outcome.err == f"roslet: {' '.join(command.split()[:2])}: the ROS 1 network has no such thing\n"


@pytest.mark.parametrize(
    "words, complaint",
    [
        ("depth", "depth takes a whole number, not ''"),
        ("depth=x", "depth takes a whole number, not 'x'"),
        ("depth=0", "depth must be"),
        ("deadline=soon", "deadline takes seconds, not 'soon'"),
        ("reliability=perfect", "reliability must be one of reliable, best_effort, not 'perfect'"),
        ("speed=5", "'speed=5' is no policy with a value; there are depth, "),
    ],
)
def test_a_wrong_quality_of_service_is_wrong_usage(words: str, complaint: str, run: Run) -> None:
    outcome = run("topic", "pub", "/a", "std_msgs/Empty", "--qos", words)
    assert outcome.code == 2
    assert outcome.err.startswith(f"roslet: --qos: {complaint}")


def test_a_master_uri_that_is_none_is_one_line(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_MASTER_URI", "robot:11311")
    outcome = run("topic", "list", "--network", "ros1://")
    assert outcome.code == 1
    assert outcome.err == "roslet: 'robot:11311' is no URI of a master; write http://host:port\n"


def test_a_file_that_is_not_there_is_named(run: Run, master: Any) -> None:
    outcome = run("param", "load", "/nonexistent.yaml")
    assert outcome.code == 1
    assert outcome.err == "roslet: /nonexistent.yaml: No such file or directory\n"


def imported(*arguments: str) -> list[str]:
    """The modules that a command imports."""
    source = (
        "import json, sys\nfrom roslet.cli.main import main\ntry:\n    main(sys.argv[1:])\nexcept SystemExit:\n    pass\n"
        "print('\\n' + json.dumps(sorted(sys.modules)))"
    )
    done = subprocess.run(
        [sys.executable, "-c", source, *arguments], capture_output=True, text=True, check=True
    )
    modules: list[str] = json.loads(done.stdout.splitlines()[-1])
    return modules


def test_an_interface_command_needs_neither_sockets_nor_generated_code(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("PYTHONPATH", "src")
    modules = imported("interface", "show", "std_msgs/String")
    assert "roslet.idl" in modules
    assert [
        name for name in modules if name in ("socket", "roslet.gen.runtime", "roslet.node.node", "numpy")
    ] == []


def test_a_question_to_the_master_needs_no_node(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONPATH", "src")
    modules = imported("topic", "list")
    assert "roslet.io.blocking" in modules
    assert [
        name for name in modules if name in ("roslet.gen.runtime", "roslet.node.node", "asyncio", "numpy")
    ] == []
