"""Unmodified rospy programs do under `roslet run` what they do under rospy, with either at the other end."""

from __future__ import annotations

import re
import sys

import pytest

import peers
from interop.ros1 import HERE, Master, Program, wait_until

PROGRAMS = HERE / "peers" / "programs"
PAIRS = [("roslet", "rospy"), ("rospy", "roslet"), ("roslet", "roslet")]


def run(program: str, under: str, master: Master, *arguments: str) -> Program:
    """Starts a program under Debian's rospy, or unmodified under `roslet run`."""
    environment = master.environment()
    path = str(PROGRAMS / program)
    if under == "rospy":
        peers.require("rospy")
        peers.require("ros1-messages")
        return Program([peers.DEBIAN_PYTHON, path, *arguments], environment)
    # No generated package is on the path here: the definitions are found through ROS_PACKAGE_PATH.
    environment["PYTHONPATH"] = str(peers.ROOT / "src")
    return Program([sys.executable, "-m", "roslet", "run", path, *arguments], environment)


@pytest.mark.parametrize(("talks", "listens"), PAIRS)
def test_the_talker_is_heard_by_the_listener(master: Master, talks: str, listens: str) -> None:
    talker = run("talker.py", talks, master)
    listener = run("listener.py", listens, master)
    assert listener.finish() == 0
    assert talker.stop() == 0
    assert len(listener.told("heard hello ")) == 5
    assert listener.told("in order") == ["in order True"]
    assert talker.told("talker ends") == ["talker ends"]


@pytest.mark.parametrize(("talks", "listens"), PAIRS)
def test_the_paper_s_coordinates_arrive(master: Master, talks: str, listens: str) -> None:
    talker = run("coordinate_talker.py", talks, master)
    listener = run("coordinate_listener.py", listens, master)
    assert listener.finish() == 0
    assert talker.stop() == 0
    assert listener.lines == ["I heard True True True"] * 3


@pytest.mark.parametrize(("serves", "calls"), PAIRS)
def test_a_service_is_called_in_every_way(master: Master, serves: str, calls: str) -> None:
    server = run("scale_server.py", serves, master)
    server.wait_for("ready /scale")
    client = run("scale_client.py", calls, master)
    assert client.finish() == 0, "\n".join(client.errors)
    assert server.stop() == 0
    assert client.lines == [
        *("points: ", "  - ", "    x: 1.0", "    y: 0.0", "    z: 0.0", "    time: ", "      secs: 0"),
        *("      nsecs:         0", 'text: "one"'),
        "scaled 2",
        "scaled 0",
        "scaled 0",
        "refused True",
        "refused False",
        "['scaled 0', 'scaled 0', 'scaled 0']",
        "ROSException timeout exceeded while waiting for service /nobody",
        "TypeError",
    ]


def test_the_battery_prints_the_same_under_both(master: Master) -> None:
    """Names, parameters, time arithmetic, messages, topics, timers: line by line what rospy prints."""
    arguments = ("__ns:=/house", "left", "alone")
    judge = run("battery.py", "rospy", master, *arguments)
    assert judge.finish(30) == 0, "\n".join(judge.errors)
    ours = run("battery.py", "roslet", master, *arguments)
    assert ours.finish(30) == 0, "\n".join(ours.errors)
    assert lines_of(ours) == lines_of(judge)
    assert len(judge.lines) > 90


def lines_of(program: Program) -> list[str]:
    """What a program printed and logged, but for the time of a log line."""
    return [re.sub(r"\[\d+\.\d+\]", "[now]", line) for line in program.lines + program.errors]


def test_an_interrupted_program_is_gone_from_the_master(master: Master) -> None:
    talker = run("talker.py", "roslet", master, "__name:=soon_gone", "chatter:=gone_chatter")
    listener = run("listener.py", "rospy", master, "chatter:=gone_chatter")
    listener.wait_for("heard")
    assert talker.stop() == 0
    listener.stop()
    command = [str(peers.require("rosnode")), "list"]

    def gone() -> bool:
        listing = Program(command, master.environment())
        assert listing.finish() == 0
        return "/soon_gone" not in listing.lines

    wait_until(gone, "the master forgets the node")
