"""`roslet bench`: what it counts and compares, that it runs, and that it would notice what is wrong."""

from __future__ import annotations

import csv
import importlib.util
import json
import math
import pathlib
import re
import sys
from collections.abc import Callable
from typing import Any

import pytest

import peers
from roslet.bundle import flash
from roslet.cli.bench import (
    board,
    compiled,
    paper,
    plots,
    porting,
    report,
    rtt,
    size,
    stacks,
    tables,
    validity,
    values,
)
from roslet.master.server import MasterServer

Run = Callable[..., Any]


# -- lines


@pytest.mark.parametrize(
    "before, after, added, changed, deleted",
    [
        ("a b c", "a b c", 0, 0, 0),
        ("a b c", "a x b c", 1, 0, 0),
        ("a b c", "a c", 0, 0, 1),
        ("a b c", "a x c", 0, 1, 0),
        ("a b c d", "a x d", 0, 1, 1),
        ("a b c", "a x y z c", 2, 1, 0),
        ("", "a b", 2, 0, 0),
        ("a b", "", 0, 0, 2),
    ],
)
def test_lines_are_added_changed_or_deleted(
    before: str, after: str, added: int, changed: int, deleted: int
) -> None:
    found = porting.cost(before.split(), after.split())
    whole = added + changed + deleted
    assert found == {"added": added, "changed": changed, "deleted": deleted, "all": whole}


def test_empty_lines_and_spaces_at_ends_are_no_lines() -> None:
    assert porting.code("a  \n\n   \n  b\n") == ["a", "  b"]


def test_a_point_that_stays_or_jumps_is_no_moving_point() -> None:
    lines = [f"I heard [x:{100 * k}, y:{10030 * k}, z:{3003 * k + 1}]" for k in range(3)]
    assert porting.moves(lines)
    assert not porting.moves([*lines, lines[-1]])
    assert not porting.moves([lines[0], lines[2]])
    assert not porting.moves([*lines, "something else"])


def test_every_program_that_is_compared_is_there() -> None:
    for _, _, before, after in porting.PORTS:
        for program in porting.PROGRAM_NAMES:
            assert (porting.FOLDER / before.format(program)).is_file()
            assert (porting.FOLDER / after.format(program)).is_file()


@pytest.mark.parametrize("source, name", [("rospy", "publisher_rospy.py"), ("rclpy", "publisher_rclpy.py")])
def test_a_program_of_the_peer_names_no_roslet(source: str, name: str) -> None:
    text = (porting.FOLDER / name).read_text("utf-8")
    assert f"import {source}" in text and "roslet" not in text


# -- values


def test_other_values_are_not_the_same() -> None:
    expected = [1, -0.0, 1.5, "a", True, values.ANY]
    assert values.same(expected, [1, -0.0, 1.5, "a", True, 17])
    assert values.same(expected, ["1", "-0", "1.5", "a", "1", "17"])  # as roscpp prints them
    for at, other in enumerate([2, 0.0, 1.25, "b", False]):
        assert not values.same(expected, [*expected[:at], other, *expected[at + 1 :]])
    assert not values.same(expected, expected[:-1])
    assert not values.same([1], ["one"])


def test_every_primitive_is_there_with_its_extremes() -> None:
    for ros1 in (True, False):
        found = values.messages(ros1)
        for bits in (8, 16, 32, 64):
            flat = [value for (value,) in found[f"std_msgs/Int{bits}"]]
            assert min(flat) == -(2 ** (bits - 1)) and max(flat) == 2 ** (bits - 1) - 1
            assert max(value for (value,) in found[f"std_msgs/UInt{bits}"]) == 2**bits - 1
        assert [math.inf] in found["std_msgs/Float32"] and [-math.inf] in found["std_msgs/Float64"]
        assert ("std_msgs/Time" in found) == ("std_msgs/Duration" in found) == ros1
        assert len(found["sensor_msgs/Image"][0][-1]) == 32768


# -- round trips


def test_the_summary_is_of_all_rounds_and_the_noise_of_each() -> None:
    found = rtt.Measured([[1.0, 2.0, 3.0], [5.0, 6.0, 7.0]], lost=1).summary()
    assert (found["count"], found["lost"], found["mean"], found["median"]) == (6, 1, 4.0, 4.0)
    assert (found["lowest round"], found["highest round"]) == (2.0, 6.0)
    assert (found["min"], found["quartile1"], found["quartile3"], found["max"]) == (1.0, 2.25, 5.75, 7.0)


def test_the_paper_s_rows_are_marked_and_complete() -> None:
    assert [len(row) for row in paper.MEANS.values()] == [11, 17, 17]
    assert paper.MEANS["mROS, the paper's"]["32768"] == 15983.26
    assert {sum(one) for one in paper.PROGRAM_BYTES.values()} == {191532, 5124376, 4066588}
    assert [sum(edge + host) for edge, host in paper.PORTING.values()] == [8, 8, 25, 17, 4, 4]
    assert paper.MARK in tables.published("mROS")


def test_a_stack_of_the_user_says_its_name_network_and_command() -> None:
    found = stacks.of_user("my board=ros1:python3 'start it.py' --fast")
    assert (found.name, found.dialect, found.foreign) == ("my board", "ros1", True)
    assert found.command("echo", {}) == ["python3", "start it.py", "--fast"]
    for wrong in ("board", "board=tcp:x", "board=ros1:", "=ros1:x"):
        with pytest.raises(ValueError, match="is not NAME"):
            stacks.of_user(wrong)


# -- tables and the page


def result(**more: Any) -> dict[str, Any]:
    """Of a run in which one stack was measured."""
    samples = {"floor TCP": [[10.0, 20.0, 30.0]], "roslet, ROS 1": [[20.0, 40.0, 60.0]]}
    figures = {name: {"coordinate": rtt.Measured(one).summary()} for name, one in samples.items()}
    found = {
        "cases": ["coordinate"], "rounds": 1, "count": 3, "figures": figures,
        "stacks": {"floor TCP": "floor ros1", "roslet, ROS 1": "ros1"},
        "ratios": {"roslet, ROS 1": {"coordinate": 2.0}}, "memory": {}, "load": [0.5], "others": 0.1,
        "processors": 2, "failed": [], "samples": {name: {"coordinate": one} for name, one in samples.items()},
    }  # fmt: skip
    return {"about": {"Python": "<3>"}, "problems": [], "rtt": found, **more}


def test_the_tables_hold_what_was_measured_beside_what_is_quoted() -> None:
    means = tables.trips(result())[0]
    assert means.rows[:2] == [["floor TCP", "20.0"], ["roslet, ROS 1", "40.0"]]
    assert [f"mROS, the paper's ({paper.MARK})", "995"] in means.rows
    assert "| *995* |" in means.markdown() and 'class="quoted"' in means.html()
    assert "| 2.00 |" in tables.trips(result())[2].markdown()


def test_the_page_needs_nothing_else_and_says_what_was_wrong(tmp_path: pathlib.Path) -> None:
    paths = report.write(result(problems=["one <b> was lost"]), tmp_path / "new")
    page = (tmp_path / "new" / "report.html").read_text("utf-8")
    assert "one &lt;b&gt; was lost" in page and "&lt;3&gt;" in page
    assert "src=" not in page and "<link" not in page and "<?xml" not in page
    drawn = importlib.util.find_spec("matplotlib") is not None
    assert plots.available() == drawn
    assert ("<svg" in page) == drawn and (report.NO_PLOTS in page.replace("&#x27;", "'")) != drawn
    with (tmp_path / "new" / "rtt.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert rows[1]["stack"] == "roslet, ROS 1" and rows[1]["median"] == "40.0"
    assert all(path.is_file() for path in paths)


def test_a_design_has_its_luts_beside_the_sections_of_programs() -> None:
    built = {
        "design": "typed-echo",
        "device": "ECP5",
        "luts": {"total": 9452, "logic": 7556},
        "flip_flops": 4751,
    }
    assert size.given({"sections": {}}) == {"sections": {}}
    assert size.given(built) == {"gates": {"typed-echo in gates, ECP5": 9452}}
    found = size.measure({}, {"sections": {"a board": [1000, 20, 3]}}, size.given(built))
    table = tables.size({"size": found})[0]
    assert table.headings == ["", "text", "data", "bss", "all", "LUT4"]
    assert ["a board", "1,000", "20", "3", "1,023", "-"] in table.rows
    assert ["typed-echo in gates, ECP5", "-", "-", "-", "-", "9,452"] in table.rows
    assert all(len(row) == 6 for row in table.rows)
    without = tables.size({"size": size.measure({}, {"sections": {"a board": [1000, 20, 3]}})})[0]
    assert "LUT4" not in without.headings and ["a board", "1,000", "20", "3", "1,023"] in without.rows


# -- the command


def test_one_size_from_end_to_end(run: Run, tmp_path: pathlib.Path) -> None:
    echo = [sys.executable, str(stacks.PROGRAMS / "roslet_node.py"), "echo", "{}"]
    words = " ".join(f"'{word}'" for word in echo)
    outcome = run(
        "bench", "--quick", "--only", "rtt", "--stacks", "roslet", "--sizes", "64", "--count", 5,
        "--echo", f"a board=ros1:{words}", "--output", tmp_path, "--json",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    found = json.loads(outcome.out)
    assert found["problems"] == [] and found["rtt"]["samples"] is None
    assert list(found["rtt"]["figures"]) == [
        "floor TCP", "floor UDP", "roslet, ROS 1", "roslet, ROS 2", *board.NAMES.values(), "a board",
    ]  # fmt: skip
    for cases in found["rtt"]["figures"].values():
        assert {case: (one["count"], one["lost"]) for case, one in cases.items()} == {
            "64": (5, 0),
            "coordinate": (5, 0),
        }
        assert all(one["min"] > 0 for one in cases.values())
    written = json.loads((tmp_path / "results.json").read_text("utf-8"))
    assert len(written["rtt"]["samples"]["a board"]["64"][0]) == 5


@pytest.mark.timeout(400)  # the program for roscpp may have to be compiled
def test_the_peers_that_are_installed_answer(run: Run, tmp_path: pathlib.Path) -> None:
    for name in ("roscpp", "rospy", "kilted", "cyclone"):
        peers.require(name)
    outcome = run(
        "bench", "--quick", "--only", "rtt,size", "--sizes", "1024", "--count", 3, "--output", tmp_path, "--json",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    found = json.loads(outcome.out)
    assert found["problems"] == [] and "not installed" not in found["about"]
    assert set(found["rtt"]["figures"]) == {
        *("floor TCP", "floor UDP", "roslet, ROS 1", "roslet, ROS 2", *board.NAMES.values()),
        *("roscpp", "rospy", "rclpy", "rclpy, UDP only", "cyclonedds"),
    }
    for name, cases in found["rtt"]["figures"].items():
        assert cases["coordinate"]["count"] == 3 and cases["coordinate"]["lost"] == 0, name
        assert cases["1024"]["count"] == 3 and cases["1024"]["lost"] == 0, name
    assert {*board.NAMES.values(), "libroscpp-dev", "cyclonedds"} <= set(found["size"]["installed"])


def test_every_value_comes_back_from_micropython(run: Run, tmp_path: pathlib.Path) -> None:
    peers.require("micropython")
    outcome = run(
        "bench", "--quick", "--only", "validity", "--stacks", "MicroPython", "--output", tmp_path, "--json",
    )  # fmt: skip
    assert outcome.code == 0, outcome.err
    found = json.loads(outcome.out)["validity"]
    assert found["problems"] == [] and list(found["peers"]) == list(board.NAMES.values())
    for rows in found["peers"].values():
        assert {name.split("/")[1] for name in rows} == set(validity.QUICK)
        assert all(right.split(" of ")[0] == right.split(" of ")[1] != "0" for right in rows.values())


def test_what_is_missing_for_micropython_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(flash, "find_compiler", lambda: None)
    with pytest.raises(compiled.Absent, match="mpy-cross"), board.boards(""):
        pass
    with board.boards("roscpp") as (none, sizes):
        assert none == [] and sizes == {"installed": {}}


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        (["--only", "speed"], "no such part: speed"),
        (["--sizes", "3"], "powers of two"),
        (["--sizes", "many"], "not sizes"),
        (["--rounds", "-1"], "at least 1"),
        (["--echo", "board"], "is not NAME"),
    ],
)
def test_wrong_usage_is_told(run: Run, arguments: list[str], complaint: str) -> None:
    outcome = run("bench", *arguments)
    assert outcome.code == 2 and complaint in outcome.err


PROGRAM = """
import sys
sys.path.insert(0, {programs!r})
import pinger
from roslet_node import Roslet

class Wrong(Roslet):
    def flat(self, value):
        return [leaf + {error} if type(leaf) is int else leaf for leaf in super().flat(value)]

if __name__ == "__main__":
    pinger.main(Wrong)
"""


@pytest.mark.parametrize("error", [0, 1])
def test_a_peer_that_reads_another_value_is_noticed(
    master: MasterServer, tmp_path: pathlib.Path, error: int
) -> None:
    path = tmp_path / "wrong.py"
    path.write_text(PROGRAM.format(programs=str(stacks.PROGRAMS), error=error), encoding="utf-8")
    words = (sys.executable, str(path))
    stack = stacks.Stack("wrong", "ros1", words, words, {"PYTHONPATH": stacks.SOURCE})
    network = stacks.Network(master.uri, 1)
    found = validity.measure([stack], network, lambda *_: None, ("Int32", "String"))
    assert found["peers"]["wrong"] == {
        "std_msgs/Int32": "6 of 6" if not error else "0 of 6",
        "std_msgs/String": "3 of 3",
    }
    assert len(found["problems"]) == 6 * error
    if error:
        assert re.search(
            r"std_msgs/Int32, message 1: the peer read -\d+, not -2147483648", found["problems"][0]
        )


def test_a_stack_that_fails_is_a_problem_and_the_others_go_on(master: MasterServer) -> None:
    broken = stacks.Stack("broken", "ros1", (sys.executable, "-c", "raise SystemExit('gone')"), ("true",))
    floor = stacks.floors()[1]
    network = stacks.Network(master.uri, 1)
    trips = rtt.measure([broken, floor], network, ["8"], 1, 3, lambda *_: None)
    assert (
        len(trips.problems) == 1 and "round 1, broken: the echo node of broken has ended" in trips.problems[0]
    )
    assert trips.figures()[floor.name]["8"]["count"] == 3
