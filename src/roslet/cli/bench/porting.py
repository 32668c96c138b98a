"""What it takes to bring the programs of the paper's Figures 9 and 10 to roslet, in lines; and whether they run."""

from __future__ import annotations

import difflib
import itertools
import pathlib
import re
import signal
import sys
import tempfile
import time
from typing import TYPE_CHECKING, Any

from roslet.cli.bench.stacks import PROGRAMS, SOURCE
from roslet.cli.demo.programs import folder
from roslet.cli.process import Failed, Process, environment

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from roslet.cli.bench.stacks import Network

FOLDER = PROGRAMS / "porting"
PROGRAM_NAMES = ("publisher", "subscriber")
UNDER_RUN = "roslet run"
# From which program to which, and how the port is started.
PORTS = (
    ("rospy", UNDER_RUN, "{}_rospy.py", "{}_rospy.py"),
    ("rclpy", UNDER_RUN, "{}_rclpy.py", "{}_rclpy.py"),
    ("rospy", "roslet.Node", "{}_rospy.py", "{}_roslet.py"),
    ("rclpy", "roslet.Node", "{}_rclpy.py", "{}_roslet_ros2.py"),
    ("roscpp", "roslet.Node", "{}_roscpp.cpp", "{}_roslet.py"),
    ("roslet, ROS 1", "roslet, ROS 2", "{}_roslet.py", "{}_roslet_ros2.py"),
)
# Lines that have to be heard, and seconds for that.
HEARD, PATIENCE = 5, 20.0
LINE = re.compile(r"I heard \[x:(\d+), y:(\d+), z:(\d+)\]")
STEP = (100, 10030, 3003)


def code(text: str) -> list[str]:
    """The lines that hold something."""
    return [line.rstrip() for line in text.splitlines() if line.strip()]


def cost(before: Sequence[str], after: Sequence[str]) -> dict[str, int]:
    """Lines added, changed and deleted. Where a block replaces another, as many lines as both have are changed."""
    found = {"added": 0, "changed": 0, "deleted": 0}
    matcher = difflib.SequenceMatcher(None, before, after, autojunk=False)
    for _, old, old_end, new, new_end in (one for one in matcher.get_opcodes() if one[0] != "equal"):
        gone, come = old_end - old, new_end - new
        both = min(gone, come)
        found["changed"] += both
        found["deleted"] += gone - both
        found["added"] += come - both
    return {**found, "all": sum(found.values())}


def moves(lines: Sequence[str]) -> bool:
    """Whether each line says a point that is one step from the one before, to a thousandth or two for float32."""
    points = []
    for line in lines:
        found = LINE.search(line)
        if found is None:
            return False
        points.append([int(part) for part in found.groups()])
    return all(
        abs(later - earlier - step) <= 2
        for before, after in itertools.pairwise(points)
        for earlier, later, step in zip(before, after, STEP, strict=True)
    )


def _command(program: pathlib.Path, how: str) -> list[str]:
    if how == UNDER_RUN:
        types = str(folder() / "msgs" / "mros_comm_measure")
        return [sys.executable, "-m", "roslet", "run", "--types", types, str(program)]
    return [sys.executable, str(program)]


def _variables(network: Network, prefix: pathlib.Path) -> dict[str, str]:
    return environment(
        AMENT_PREFIX_PATH=str(prefix),
        PYTHONPATH=SOURCE,
        ROS_MASTER_URI=network.master,
        ROS_IP="127.0.0.1",
        ROS_DOMAIN_ID=str(network.domain),
        ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST",
        ROS_PACKAGE_PATH=str(folder() / "msgs"),
    )


def installed(prefix: pathlib.Path) -> pathlib.Path:
    """Make a ROS 2 installation prefix with the paper's type in it, as it would be on a machine with that package."""
    path = prefix / "share" / "mros_comm_measure" / "msg" / "Coordinate.msg"
    path.parent.mkdir(parents=True)
    path.write_text("float32 x\nfloat32 y\nfloat32 z\nbuiltin_interfaces/Time time\n", encoding="utf-8")
    return prefix


def verify(publisher: list[str], subscriber: list[str], variables: dict[str, str]) -> None:
    """Run both, and read what the subscriber says. Raises Failed."""
    with (
        Process("the subscriber", subscriber, variables, stop=signal.SIGTERM) as listener,
        Process("the publisher", publisher, variables, stop=signal.SIGTERM),
    ):
        end = time.monotonic() + PATIENCE
        lines: list[str] = []
        while len(lines) < HEARD:
            line = listener.line(max(0.0, end - time.monotonic()))
            if LINE.search(line):
                lines.append(line)
        if not moves(lines):
            raise Failed(f"the subscriber heard {lines}")


def measure(network: Network, progress: Callable[[str, int, int], None]) -> dict[str, Any]:
    """The table, and what went wrong. Every port is run against roslet's program of the other end."""
    with tempfile.TemporaryDirectory() as prefix:
        return _measure(_variables(network, installed(pathlib.Path(prefix))), progress)


def _measure(variables: dict[str, str], progress: Callable[[str, int, int], None]) -> dict[str, Any]:
    rows: list[dict[str, Any]] = []
    problems: list[str] = []
    whole = len(PORTS) * len(PROGRAM_NAMES)
    for source, target, before, after in PORTS:
        for program in PROGRAM_NAMES:
            progress(f"{program}, {source} to {target}", len(rows), whole)
            old, new = (FOLDER / name.format(program) for name in (before, after))
            how = target if target == UNDER_RUN else ""
            ros2 = source == "rclpy" or after.endswith("ros2.py")
            other = PROGRAM_NAMES[1 - PROGRAM_NAMES.index(program)]
            beside = FOLDER / f"{other}_roslet{'_ros2' if ros2 else ''}.py"
            ends = {program: _command(new, how), other: _command(beside, "")}
            verified = "runs"
            try:
                verify(ends["publisher"], ends["subscriber"], variables)
            except Failed as error:
                verified = "fails"
                problems.append(f"porting, {program}, {source} to {target}: {error}")
            lines = cost(code(old.read_text("utf-8")), code(new.read_text("utf-8")))
            rows.append({"from": source, "to": target, "program": program, **lines, "verified": verified})
    progress("", whole, whole)
    return {"rows": rows, "problems": problems}
