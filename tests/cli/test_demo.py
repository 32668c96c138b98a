"""`roslet demo`: that it works, and that it would notice if it did not."""

from __future__ import annotations

import json
import os
import pathlib
import signal
import struct
import subprocess
import sys
import time
import zlib
from collections.abc import Callable
from typing import Any

import pytest

from roslet.cli.demo import floor, gates
from roslet.cli.demo.programs import Programs, cyclone_python, folder
from roslet.cli.demo.show import HEIGHT, ROS1, ROS2, WIDTH, judge, png_size

Start = Callable[..., "subprocess.Popen[Any]"]


def png(width: int, height: int, rows: int) -> bytes:
    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0)
    data = zlib.compress(bytes(rows * (1 + 3 * width)))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", data) + chunk(b"IEND", b"")


def figures(**changes: Any) -> dict[str, dict[str, dict[str, Any]]]:
    """What the programs report when all is right, with some of it changed: ros2_talker_sent=9."""

    def pair() -> dict[str, dict[str, Any]]:
        trips = [0.001, 0.002, 0.003]
        return {
            "talker": {
                "sent": 10,
                "returned": 10,
                "altered": 0,
                "round_trips": trips,
                "found": 0.1,
                "final": True,
            },
            "listener": {"heard": 10, "wrong": 0, "final": True},
        }

    pictures = {"camera": {"sent": 5, "final": True}, "viewer": {"received": 5, "wrong": 0, "final": True}}
    cyclone = {"cyclone": {"heard": 10, "wrong": 0, "final": True}}
    right: dict[str, dict[str, dict[str, Any]]] = {ROS1: {**pair(), **pictures}, ROS2: {**pair(), **cyclone}}
    for change, value in changes.items():
        network, program, key = change.split("_", 2)
        right[{"ros1": ROS1, "ros2": ROS2}[network]][program][key] = value
    return right


FLOORS = {ROS1: [0.001], ROS2: [0.001]}


@pytest.fixture
def picture(tmp_path: pathlib.Path) -> pathlib.Path:
    path = tmp_path / "image.png"
    path.write_bytes(png(WIDTH, HEIGHT, HEIGHT))
    return path


def test_when_all_is_right_there_are_no_problems(picture: pathlib.Path) -> None:
    result = judge(figures(), FLOORS, picture)
    assert result["problems"] == []
    assert [row["right"] for row in result["topics"]] == [True] * 6
    assert [one["roslet"]["median"] for one in result["round_trips"]] == [0.002, 0.002]
    assert (result["discovery"], result["cyclonedds"]) == (0.1, True)


@pytest.mark.parametrize(
    "changes, topic",
    [
        ({"ros1_listener_heard": 9}, "ROS 1 /ping"),
        ({"ros1_listener_wrong": 1}, "ROS 1 /ping"),
        ({"ros1_talker_returned": 9}, "ROS 1 /pong"),
        ({"ros1_talker_altered": 1}, "ROS 1 /pong"),
        ({"ros1_viewer_received": 4}, "ROS 1 /image"),
        ({"ros1_viewer_wrong": 1}, "ROS 1 /image"),
        ({"ros1_camera_sent": 0, "ros1_viewer_received": 0}, "ROS 1 /image"),
        ({"ros1_talker_round_trips": []}, "ROS 1: no round trip"),
        ({"ros2_listener_heard": 9}, "ROS 2 /ping"),
        ({"ros2_talker_returned": 9}, "ROS 2 /pong"),
        ({"ros2_cyclone_heard": 9}, "ROS 2 /ping at CycloneDDS"),
        ({"ros2_cyclone_wrong": 1}, "ROS 2 /ping at CycloneDDS"),
        ({"ros2_talker_round_trips": []}, "ROS 2: no round trip"),
    ],
)
def test_whatever_is_lost_or_altered_or_missing_is_a_problem(
    changes: dict[str, Any], topic: str, picture: pathlib.Path
) -> None:
    problems = judge(figures(**changes), FLOORS, picture)["problems"]
    assert any(problem.startswith(topic) for problem in problems)


def test_a_program_that_never_reported_is_a_problem(picture: pathlib.Path) -> None:
    silent = figures()
    silent[ROS2]["talker"] = {}
    del silent[ROS2]["cyclone"]
    result = judge(silent, {ROS1: [0.001], ROS2: []}, picture)
    assert not result["cyclonedds"]
    assert result["problems"] == [
        "ROS 2 /ping: sent None, received 10, wrong 0",
        "ROS 2 /pong: sent 10, received None, wrong None",
        "ROS 2: no round trip was timed",
        "ROS 2: no round trip of raw sockets was timed",
    ]


def test_programs_that_said_nothing_are_problems(tmp_path: pathlib.Path) -> None:
    problems = judge({ROS1: {}, ROS2: {}}, {ROS1: [], ROS2: []}, tmp_path / "none.png")["problems"]
    assert len(problems) == 2 * 4 + 2, "each network: two topics, two timings; the images, the picture"


@pytest.mark.parametrize(
    "data, complaint",
    [
        (b"", "no PNG file"),
        (png(4, 3, 3)[:-12], "not whole"),
        (png(4, 3, 2), "not as many rows"),
        (png(4, 3, 3).replace(b"IHDR\x00\x00\x00\x04", b"IHDR\x00\x00\x00\x05"), "damaged"),
    ],
)
def test_a_picture_that_is_none_is_told(data: bytes, complaint: str) -> None:
    assert png_size(png(4, 3, 3)) == (4, 3)
    with pytest.raises(ValueError, match=complaint):
        png_size(data)


def test_the_floor_is_timed_with_a_process_of_its_own() -> None:
    for measure in (floor.measure, floor.measure_datagrams):
        trips = measure(0.2, 100.0)
        assert 1 <= len(trips) <= 21
        assert all(trip > 0 for trip in trips)


def test_the_whole_demo_works_and_leaves_nothing_behind(start: Start, tmp_path: pathlib.Path) -> None:
    process = start("demo", "--seconds", 1, "--rate", 50, "--folder", tmp_path, "--json", "--no-gates")
    out, err = process.communicate(timeout=40)
    result = json.loads(out)
    assert (process.returncode, err, result["problems"], result["gates"]) == (0, "", [], None)
    rows = {(row["network"], row["topic"]): (row["sent"], row["received"]) for row in result["topics"]}
    assert rows.pop((ROS1, "/image")) == (10, 10)
    assert set(rows.values()) == {(50, 50)}
    pairs = {(network, topic) for network in (ROS1, ROS2) for topic in ("/ping", "/pong")}
    cyclone = {(ROS2, "/ping at CycloneDDS")} if cyclone_python() else set()
    assert set(rows) == pairs | cyclone
    assert 0 < result["discovery"] < 5
    assert png_size(pathlib.Path(result["picture"]).read_bytes()) == (WIDTH, HEIGHT)
    assert children(process.pid) == []


@pytest.mark.timeout(400)  # the design is compiled
def test_the_node_in_gates_and_the_one_in_software_hear_each_other() -> None:
    said: list[str] = []
    found = gates.simulate(said.append)
    assert gates.judge(found) == []
    assert found["heard"][:3] == [f"Message from FPGA - {number:04}" for number in range(3)]
    assert found["sent"][:5] == ["", "a", "short", "ten octets", "fifteen octets!"]
    assert found["leds"][:4] == [1, 3, 7, 15]
    assert found["faults"] == {}
    assert any(line.endswith("LEDs ***.") for line in said)


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (
            {"heard": ["Message from FPGA - 0001", "Message from FPGA - 0003"]},
            "not one number after the other",
        ),
        ({"heard": []}, "not one number after the other"),
        ({"heard": ["Message from FPGA - 1"]}, "not one number after the other"),
        ({"leds": [1, 7]}, "the LEDs showed"),
        ({"leds": []}, "the LEDs showed"),
        ({"faults": {"fcs-wrong": 1}}, "faults in frames"),
        ({"problems": ["gates: exit code 1: no"]}, "exit code 1"),
    ],
)
def test_what_is_wrong_with_the_gates_is_told(change: dict[str, Any], problem: str) -> None:
    right: dict[str, Any] = {
        "heard": ["Message from FPGA - 0007", "Message from FPGA - 0008"],
        "sent": ["", "a", "short"],
        "leds": [1, 3],
        "faults": {},
        "problems": [],
    }
    assert gates.judge(right) == []
    (told,) = gates.judge({**right, **change})
    assert problem in told


def children(pid: int) -> list[int]:
    """The processes whose parent is, or in whose command line stands, what the demo started."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            except (OSError, IndexError, ValueError):
                continue
            if parent == pid:
                found.append(int(entry.name))
    return found


def test_an_interrupted_demo_ends_its_processes(start: Start, tmp_path: pathlib.Path) -> None:
    process = start("demo", "--seconds", 30, "--folder", tmp_path)
    assert process.stdout is not None
    for line in process.stdout:
        if line.startswith("processes:"):
            break
    end = time.monotonic() + 10
    while len(started := children(process.pid)) < 4 and time.monotonic() < end:
        time.sleep(0.02)
    assert len(started) == 4
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=20)
    assert process.returncode == 130
    assert [pid for pid in started if os.path.exists(f"/proc/{pid}")] == []


def test_a_program_that_fails_is_told_with_its_last_words(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "bad.py").write_text("import sys\nprint('it hurts', file=sys.stderr)\nsys.exit(4)\n")
    (tmp_path / "silent.py").write_text("")
    (tmp_path / "endless.py").write_text("import time\ntime.sleep(60)\n")
    monkeypatch.setattr("roslet.cli.demo.programs.folder", lambda: tmp_path)
    with Programs("ros1://127.0.0.1:1") as programs:
        bad, silent, endless = (programs.start(name) for name in ("bad.py", "silent.py", "endless.py"))
        assert bad.finish(10) == "bad.py ended with exit code 4: it hurts"
        assert silent.finish(10) == "silent.py ended without its last report"
        assert endless.finish(0.2) == "endless.py did not end by itself"
        assert not endless.running


def test_the_programs_are_those_of_the_examples_folder() -> None:
    assert folder() == pathlib.Path(__file__).resolve().parents[2] / "examples"
    assert sys.executable
