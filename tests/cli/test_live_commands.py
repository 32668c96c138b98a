"""topic echo, pub, hz, bw: against nodes in this process, and as processes with signals, pipes and terminals."""

from __future__ import annotations

import json
import os
import pathlib
import pty
import select
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import roslet
from roslet.gen.runtime import message_class_of
from roslet.master.server import MasterServer

Run = Callable[..., Any]
Start = Callable[..., "subprocess.Popen[Any]"]
Eventually = Callable[[Callable[[], object], str], None]


@pytest.fixture
def talker(master: MasterServer) -> Iterator[roslet.Node]:
    """A node that publishes /chatter and /pose fifty times a second from a thread."""
    ended = threading.Event()
    with roslet.Node("talker", network=f"ros1://127.0.0.1:{master.port}") as node:
        chatter = node.publisher("chatter", "std_msgs/String")
        pose = node.publisher("pose", "geometry_msgs/PoseStamped")

        def talk() -> None:
            while not ended.wait(0.02):
                chatter.publish(data="hello")
                pose.publish(pose.type())

        thread = threading.Thread(target=talk)
        thread.start()
        yield node
        ended.set()
        thread.join()


# echo


def test_echo_prints_documents_of_yaml(run: Run, talker: roslet.Node) -> None:
    outcome = run("topic", "echo", "/chatter", "-n", "2")
    assert (outcome.code, outcome.out) == (0, 'data: "hello"\n---\ndata: "hello"\n---\n')


def test_echo_as_json_prints_a_line_a_message(run: Run, talker: roslet.Node) -> None:
    lines = run("topic", "echo", "/pose", "-n", "2", "--json").out.splitlines()
    assert len(lines) == 2
    assert json.loads(lines[1])["header"]["seq"] == json.loads(lines[0])["header"]["seq"] + 1


def test_echo_shows_one_field(run: Run, talker: roslet.Node) -> None:
    assert run("topic", "echo", "/chatter", "-1", "--field", "data").out == '"hello"\n---\n'
    assert (
        run("topic", "echo", "/pose", "-1", "--field", "pose.position").out == "x: 0.0\ny: 0.0\nz: 0.0\n---\n"
    )


def test_echo_of_a_field_that_is_not_there_fails_at_the_first_message(run: Run, talker: roslet.Node) -> None:
    outcome = run("topic", "echo", "/chatter", "--field", "date")
    assert (outcome.code, outcome.err) == (
        1,
        "roslet: date: std_msgs/String has no field date; it has data\n",
    )


def test_echo_ends_when_time_is_up(run: Run, master: MasterServer) -> None:
    outcome = run("topic", "echo", "/nothing", "--for", "0.2")
    assert (outcome.code, outcome.out) == (0, "")


def test_echo_with_a_timeout_fails_on_a_silent_topic(run: Run, master: MasterServer) -> None:
    outcome = run("topic", "echo", "/nothing", "--timeout", "0.2")
    assert (outcome.code, outcome.err) == (1, "roslet: /nothing: no message within 0.2 s (0 publishers)\n")


def test_echo_shows_a_type_that_is_not_installed_by_its_publishers_definition(
    start: Start, master: MasterServer
) -> None:
    text = f"Wheel[] wheels\nstring name\n{'=' * 80}\nMSG: cli_unknown/Wheel\nfloat32 speed\n"
    kind: Any = message_class_of("cli_unknown/Robot", text)
    wheel: Any = kind._spec[0][1]
    with roslet.Node("robot", network=f"ros1://127.0.0.1:{master.port}") as node:
        latched = roslet.QoS(durability="transient_local")
        node.publisher("robot", kind, qos=latched).publish(wheels=[wheel(speed=0.1)], name="r2")
        process = start("topic", "echo", "-1", "/robot")
        out, err = process.communicate(timeout=10)
    assert (process.returncode, out, err) == (0, 'wheels:\n  - speed: 0.1\nname: "r2"\n---\n', "")


def test_echo_uses_the_publishers_definition_where_another_of_that_name_is_installed(
    start: Start, master: MasterServer, tmp_path: pathlib.Path
) -> None:
    kind: Any = message_class_of("cli_changed/Thing", "int32 new\n")
    (tmp_path / "cli_changed" / "msg").mkdir(parents=True)
    (tmp_path / "cli_changed" / "msg" / "Thing.msg").write_text("string old\n")
    with roslet.Node("robot", network=f"ros1://127.0.0.1:{master.port}") as node:
        node.publisher("thing", kind, qos=roslet.QoS(durability="transient_local")).publish(new=7)
        process = start("topic", "echo", "-1", "/thing", "--types", tmp_path)
        out, _ = process.communicate(timeout=10)
    assert (process.returncode, out) == (0, "new: 7\n---\n")


# pub


@pytest.fixture
def heard(master: MasterServer) -> Iterator[tuple[roslet.Node, list[Any]]]:
    """A node that collects what comes on /news."""
    got: list[Any] = []
    with roslet.Node("ear", network=f"ros1://127.0.0.1:{master.port}") as node:
        node.subscribe("news", "std_msgs/String", got.append)
        node.start()
        yield node, got


def test_pub_once_waits_for_the_subscriber_and_ends(
    run: Run, heard: tuple[roslet.Node, list[Any]], eventually: Eventually
) -> None:
    assert run("topic", "pub", "-1", "/news", "std_msgs/String", "data:=hello").code == 0
    eventually(lambda: [message.data for message in heard[1]] == ["hello"], "the message is heard once")


def test_pub_once_says_where_nobody_listens(run: Run, master: MasterServer) -> None:
    outcome = run("topic", "pub", "-1", "/news", "std_msgs/String", "--wait", "0.1")
    assert (outcome.code, outcome.err) == (0, "nobody subscribed /news within 0.1 s\n")


def test_pub_at_a_rate_stops_after_a_count(
    run: Run, heard: tuple[roslet.Node, list[Any]], eventually: Eventually
) -> None:
    assert run("topic", "pub", "-r", "50", "-n", "5", "/news", "std_msgs/String", "hi").code == 0
    eventually(lambda: len(heard[1]) >= 4, "most are heard (the first may come before the connection)")


def test_pub_takes_the_type_that_the_topic_has(
    run: Run, heard: tuple[roslet.Node, list[Any]], eventually: Eventually
) -> None:
    assert run("topic", "pub", "-1", "/news", "-", "data:=hello").code == 0
    eventually(lambda: len(heard[1]) == 1, "the message is heard")


def test_a_message_that_is_wrong_is_refused_before_a_node_appears(run: Run, master: MasterServer) -> None:
    outcome = run("topic", "pub", "-1", "/news", "std_msgs/String", "date:=1")
    assert (outcome.code, outcome.err) == (2, "roslet: std_msgs/String has no field date; it has data\n")
    outcome = run("topic", "pub", "-1", "/news", "no_such/Type")
    assert outcome.code == 1
    assert "no_such/Type" in outcome.err


def test_options_that_exclude_each_other_are_wrong_usage(run: Run, master: MasterServer) -> None:
    assert run("topic", "pub", "-1", "-r", "5", "/news", "std_msgs/Empty").code == 2
    assert run("topic", "pub", "-n", "5", "/news", "std_msgs/Empty").code == 2


def test_a_latched_message_reaches_a_late_subscriber_and_ctrl_c_ends_it_cleanly(
    start: Start, master: MasterServer, run: Run, eventually: Eventually
) -> None:
    process = start("topic", "pub", "/news", "std_msgs/String", "data:=kept")
    eventually(lambda: "/news" in run("topic", "list", "--names").out, "the topic is there")
    assert run("topic", "echo", "-1", "/news", "--timeout", "5").out == 'data: "kept"\n---\n'
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=5)
    assert process.returncode == 130
    assert "Traceback" not in err
    assert run("node", "list", "--names").out == ""


# hz and bw


def test_hz_reports_lines_when_piped(run: Run, talker: roslet.Node) -> None:
    outcome = run("topic", "hz", "/chatter", "--every", "0.2", "--for", "0.6")
    assert outcome.code == 0
    lines = outcome.out.splitlines()
    assert len(lines) == 3
    assert all(line.startswith("/chatter  ") and " Hz  min " in line for line in lines)
    assert 0 < float(lines[-1].split()[1]) < 200


def test_hz_of_several_topics_as_json_gives_a_line_for_each(run: Run, talker: roslet.Node) -> None:
    outcome = run("topic", "hz", "/chatter", "/pose", "--every", "0.3", "--for", "0.3", "--json")
    rows = [json.loads(line) for line in outcome.out.splitlines()]
    assert [row["topic"] for row in rows] == ["/chatter", "/pose"]
    assert all(0 < row["rate"] < 200 for row in rows)


def test_bw_counts_the_bytes_of_messages(run: Run, talker: roslet.Node) -> None:
    rows = run("topic", "bw", "/chatter", "--every", "0.3", "--for", "0.6", "--json").out.splitlines()
    last = json.loads(rows[-1])
    assert (last["minimum"], last["mean"], last["maximum"]) == (9, 9.0, 9)
    assert 0 < last["bytes_per_second"] < 200 * 9


def test_a_silent_topic_is_reported_and_is_exit_code_1(run: Run, master: MasterServer) -> None:
    for command in ("hz", "bw"):
        outcome = run("topic", command, "/nothing", "--for", "0.1")
        assert (outcome.code, outcome.out) == (1, "/nothing  no message yet\n")


# signals, pipes, terminals


@pytest.mark.parametrize("number, code", [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
@pytest.mark.parametrize(
    "command", ["echo /chatter", "hz /chatter", "bw /chatter", "pub -r 20 /x std_msgs/Empty"]
)
def test_a_signal_ends_a_command_without_traceback_and_its_node_is_unregistered(
    command: str,
    number: signal.Signals,
    code: int,
    start: Start,
    talker: roslet.Node,
    run: Run,
    eventually: Eventually,
) -> None:
    process = start("topic", *command.split())
    eventually(lambda: len(run("node", "list", "--names").out.split()) == 2, "the command's node is there")
    if "/chatter" in command.split():
        chatter = talker.publisher("chatter", "std_msgs/String")
        eventually(lambda: chatter.subscriber_count == 1, "the command listens")
    process.send_signal(number)
    _, err = process.communicate(timeout=5)
    assert (process.returncode, err) == (code, "")
    assert run("node", "list", "--names").out == "/talker\n"


def test_when_nobody_reads_any_more_echo_ends_quietly(start: Start, talker: roslet.Node, run: Run) -> None:
    process = start("topic", "echo", "/chatter")
    assert process.stdout is not None
    assert process.stdout.readline() == 'data: "hello"\n'
    process.stdout.close()
    process.wait(5)
    assert process.stderr is not None
    assert (process.returncode, process.stderr.read()) == (141, "")
    assert run("node", "list", "--names").out == "/talker\n"


def on_a_terminal(process: subprocess.Popen[Any], descriptor: int, enough: Callable[[str], bool]) -> str:
    """What a process shows on a terminal until that is enough; the process is interrupted then."""
    shown = ""
    end = time.monotonic() + 10
    while not enough(shown) and time.monotonic() < end:
        if select.select([descriptor], [], [], 0.1)[0]:
            shown += os.read(descriptor, 4096).decode()
    process.send_signal(signal.SIGINT)
    process.wait(5)
    return shown


@pytest.mark.parametrize(
    "command", ["hz /chatter --every 0.1", "bw /chatter --every 0.1", "echo -c /chatter"]
)
def test_on_a_terminal_live_output_replaces_itself(
    command: str, start: Start, talker: roslet.Node, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TERM", "xterm")
    ours, theirs = pty.openpty()
    try:
        process = start("topic", *command.split(), stdout=theirs)
        shown = on_a_terminal(process, ours, lambda text: text.count("\x1b[1A\r\x1b[J") >= 2)
    finally:
        os.close(ours)
        os.close(theirs)
    assert shown.count("\x1b[1A\r\x1b[J") >= 2
    assert process.returncode == 130


def test_the_master_command_serves_until_it_is_interrupted(start: Start) -> None:
    process = start("master", "--host", "127.0.0.1", "--port", "0")
    assert process.stdout is not None
    line = process.stdout.readline()
    assert line.startswith("ROS_MASTER_URI=http://127.0.0.1:")
    with roslet.Node("n", network="ros1" + line.strip().removeprefix("ROS_MASTER_URI=http")) as node:
        assert node.has_parameter("/run_id")
    process.send_signal(signal.SIGINT)
    assert process.wait(5) == 0


def test_a_port_that_is_taken_is_one_line(start: Start, master: MasterServer) -> None:
    process = start("master", "--host", "127.0.0.1", "--port", master.port)
    _, err = process.communicate(timeout=5)
    assert process.returncode == 1
    assert err == f"roslet master: cannot listen on 127.0.0.1:{master.port}: Address already in use\n"


def test_run_hands_everything_after_the_script_to_it(
    start: Start, master: MasterServer, tmp_path: pathlib.Path
) -> None:
    script = tmp_path / "program.py"
    script.write_text(
        "import rospy, sys\nrospy.init_node('program')\nprint(rospy.get_name(), sys.argv[1:])\nsys.exit(7)\n"
    )
    process = start("run", script, "--help", "__name:=bob")
    out, _ = process.communicate(timeout=10)
    assert (process.returncode, out) == (7, "/bob ['--help', '__name:=bob']\n")
