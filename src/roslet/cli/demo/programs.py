"""The example programs as processes: started, read, ended."""

from __future__ import annotations

import contextlib
import importlib.util
import json
import os
import pathlib
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING, Any

import roslet
from roslet.cli.options import CommandError
from roslet.cli.process import Process

if TYPE_CHECKING:
    from types import TracebackType


def folder() -> pathlib.Path:
    """Where the example programs are: in the installed package, or beside the sources. Raises CommandError."""
    package = pathlib.Path(roslet.__file__).resolve().parent
    for place in (package / "examples", package.parent.parent / "examples"):
        if (place / "coordinate_talker.py").is_file():
            return place
    raise CommandError("the example programs are not there: neither in the package nor in a checkout")


def cyclone_python() -> str | None:
    """An interpreter that has the package cyclonedds: this one, or that of the tests' peers. None where there is none."""
    if importlib.util.find_spec("cyclonedds") is not None:
        return sys.executable
    peers = os.environ.get("ROSLET_PEERS") or os.path.expanduser("~/.cache/roslet/peers")
    there = os.path.join(peers, "cyclone", "bin", "python")
    if not os.access(there, os.X_OK):
        return None
    done = subprocess.run(
        [there, "-c", "import cyclonedds"], stdin=subprocess.DEVNULL, capture_output=True, check=False
    )
    return None if done.returncode else there


class Program(Process):
    """One program, which prints what it knows so far as a JSON line now and then."""

    def __init__(self, name: str, command: list[str], environment: dict[str, str]) -> None:
        super().__init__(name, command, environment, signal.SIGINT)
        self._figures: dict[str, Any] = {}

    @property
    def figures(self) -> dict[str, Any]:
        """The latest of its JSON lines."""
        for line in self.lines():
            with contextlib.suppress(ValueError):  # a line for people
                if isinstance(figures := json.loads(line), dict):
                    self._figures = figures
        return self._figures

    def wait_ready(self, seconds: float) -> bool:
        """Wait for its first report, which says that it is ready; false where it ended or did not come."""
        end = time.monotonic() + seconds
        while not self.figures and self.running and time.monotonic() < end:
            time.sleep(0.005)
        return bool(self.figures)

    def finish(self, seconds: float) -> str:
        """Wait until the program ends by itself; what was wrong with it, "" where nothing was."""
        code = self.end(seconds)
        if code is None:
            self.close()
            return f"{self.name} did not end by itself"
        if code:
            return f"{self.name} ended with exit code {code}{self.last_words()}"
        if not self.figures.get("final"):
            return f"{self.name} ended without its last report"
        return ""


class Programs:
    """Several programs that end together, on one network: leaving the block ends those that still run."""

    def __init__(self, network: str) -> None:
        self.network = network
        self.all: list[Program] = []
        source = str(pathlib.Path(roslet.__file__).resolve().parent.parent)
        path = os.environ.get("PYTHONPATH")
        # The programs get this roslet, installed or not.
        self._environment = {
            **os.environ,
            "PYTHONPATH": f"{source}{os.pathsep}{path}" if path else source,
            "ROS_IP": "127.0.0.1",
            "PYTHONUNBUFFERED": "1",
        }
        self._environment.pop("ROS_HOSTNAME", None)
        self._environment.pop("ROS_NAMESPACE", None)

    def start(self, name: str, *arguments: object) -> Program:
        """Start one of the example programs; its network and --json are given to it."""
        given = [str(argument) for argument in arguments]
        command = [sys.executable, str(folder() / name), "--network", self.network, "--json", *given]
        return self._add(Program(name, command, self._environment))

    def start_cyclone(self, python: str, domain: int, *arguments: object) -> Program:
        """Start the CycloneDDS program, in the interpreter that has cyclonedds."""
        path = pathlib.Path(__file__).with_name("cyclone_peer.py")
        command = [python, str(path), str(domain), *map(str, arguments)]
        environment = {name: value for name, value in self._environment.items() if name != "PYTHONPATH"}
        return self._add(Program(path.name, command, environment))

    def _add(self, program: Program) -> Program:
        self.all.append(program)
        return program

    def __enter__(self) -> Programs:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for program in self.all:
            program.close()
