"""The same programs under Debian's rospy and under `roslet run`, and what they said."""

from __future__ import annotations

import pathlib
import re
import sys

import peers
from interop.ros1 import Master, Program

HERE = pathlib.Path(__file__).resolve().parent
PROGRAMS = HERE / "programs"
WORKSPACE = HERE / "ws"

# The time of a log line, and of a line of a traceback of ours or theirs that leads to the program's own.
_TIME = re.compile(r"\[\d{9,}\.\d+(?:, \d+\.\d+)?\]")


class Both:
    """Starts programs under Debian's rospy, against a master of their own, and under `roslet run`, against `master`."""

    def __init__(self, judge: Master, master: Master, generated: pathlib.Path) -> None:
        self.judge = judge
        self.master = master
        self.generated = generated

    def under_rospy(self, program: str | pathlib.Path, *arguments: str) -> Program:
        peers.require("rospy")
        environment = self.judge.environment()
        environment["ROS_PACKAGE_PATH"] = f"{WORKSPACE}:/usr/share"
        environment["PYTHONPATH"] = str(self.generated)
        return Program([str(peers.DEBIAN_PYTHON), str(PROGRAMS / program), *arguments], environment)

    def under_roslet(
        self, program: str | pathlib.Path, *arguments: str, libraries: pathlib.Path | None = None
    ) -> Program:
        """`libraries` is a folder of modules that come first."""
        environment = self.master.environment()
        environment["ROS_PACKAGE_PATH"] = f"{WORKSPACE}:/usr/share"
        environment["PYTHONPATH"] = f"{libraries or self.generated / 'libraries'}:{peers.ROOT / 'src'}"
        command = [sys.executable, "-m", "roslet.cli.main", "run", str(PROGRAMS / program), *arguments]
        return Program(command, environment)


def outcome(programs: list[Program]) -> list[tuple[int, list[str], list[str]]]:
    """Exit code, output and error lines of programs that end by themselves."""
    codes = [program.finish(30) for program in programs]
    return [
        (code, tidy(program.lines), tidy(program.errors))
        for code, program in zip(codes, programs, strict=True)
    ]


def tidy(lines: list[str]) -> list[str]:
    """The lines without times."""
    return [_TIME.sub("[now]", line) for line in lines]
