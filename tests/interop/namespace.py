"""Network namespaces for one test: hosts of its own, so that no test meets another's peers.

A Namespace has loopback and nothing else, until `connect` lays a cable between two of them.
"""

from __future__ import annotations

import json
import os
import pathlib
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import IO, Any

import pytest

PATIENCE = 90.0
_ROUTE = "ip link set lo multicast on && ip route add 239.0.0.0/8 dev lo"


class Program:
    """A command in the namespace; its standard output goes to a file, so that it never blocks."""

    end = signal.SIGTERM

    def __init__(
        self, command: list[str], environment: dict[str, str], folder: pathlib.Path, name: str
    ) -> None:
        self.name = name
        self.output = folder / f"{name}.out"
        self.errors = folder / f"{name}.err"
        with self.output.open("wb") as out, self.errors.open("wb") as err:
            self.process = subprocess.Popen(command, stdout=out, stderr=err, env=environment)

    def lines(self) -> list[str]:
        return self.output.read_text().splitlines()

    def wait_for(self, line: str, seconds: float = 30.0) -> None:
        """Until the line has been printed."""
        self.wait_until(lambda lines: line in lines, seconds, line)

    def wait_until(self, seen: object, seconds: float, what: str) -> None:
        assert callable(seen)
        end = time.monotonic() + seconds
        while not seen(self.lines()):
            if time.monotonic() > end or self.process.poll() not in (None, 0):
                raise AssertionError(
                    f"{self.name} did not print {what!r}: {self.lines()}\n{self.errors.read_text()}"
                )
            time.sleep(0.02)

    def finish(self, seconds: float = 75.0) -> list[str]:
        """Its lines, when it has ended by itself."""
        assert self.process.wait(seconds) == 0, self.errors.read_text()
        return self.lines()


def last(program: Program) -> dict[str, Any]:
    """The last whole line of JSON that a program printed."""
    lines = [line for line in program.lines() if line.startswith("{") and line.endswith("}")]
    found: dict[str, Any] = json.loads(lines[-1]) if lines else {}
    return found


def wait(
    program: Program, what: str, seen: Callable[[dict[str, Any]], bool], seconds: float = PATIENCE
) -> dict[str, Any]:
    """That, as soon as `seen` holds for it."""
    end = time.monotonic() + seconds
    while not (said := last(program)) or not seen(said):
        assert time.monotonic() < end, f"{program.name}: {what}: not within {seconds:g} s: {said}"
        time.sleep(0.05)
    return said


class Piped:
    """A command in the namespace that its owner talks to; it is not waited for in the end."""

    end = signal.SIGKILL

    def __init__(
        self, command: list[str], stdin: int, stdout: int, stderr: IO[bytes], environment: dict[str, str]
    ) -> None:
        self.process = subprocess.Popen(command, stdin=stdin, stdout=stdout, stderr=stderr, env=environment)


class Namespace:
    """A context manager: `start` runs programs in it, all of which end with it. `route`: whether multicast has one."""

    def __init__(self, folder: pathlib.Path, route: bool = True) -> None:
        self.folder = folder
        self._setup = f"ip link set lo up && {_ROUTE if route else 'true'} && echo up && exec sleep 600"
        self.programs: list[Program | Piped] = []

    def __enter__(self) -> Namespace:
        unshare = (
            ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--user", "--map-root-user", "--net"]
        )
        self._holder = subprocess.Popen(
            [*unshare, "sh", "-c", self._setup], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        assert self._holder.stdout is not None
        if self._holder.stdout.readline() != "up\n":
            reason = self._holder.communicate(timeout=5)[1]
            pytest.skip(f"no network namespace: {reason}")
        return self

    @property
    def pid(self) -> int:
        """A process that lives in it, by which others find it."""
        return self._holder.pid

    def _enter(self) -> list[str]:
        enter = ["nsenter", "--net", "--target", str(self.pid)]
        return enter if os.geteuid() == 0 else [*enter, "--user", "--preserve-credentials"]

    def run(self, command: str) -> str:
        """What a short shell command prints in it; it must succeed."""
        done = subprocess.run(
            [*self._enter(), "sh", "-ec", command], capture_output=True, text=True, timeout=10, check=False
        )
        assert done.returncode == 0, f"{command}: {done.stderr}"
        return done.stdout

    def wait_for_link(self, name: str) -> None:
        """Until an interface has a carrier: the kernel takes a moment, and Fast DDS looks only once."""
        end = time.monotonic() + 10.0
        while "state UP" not in self.run(f"ip -o link show dev {name}"):
            assert time.monotonic() < end, f"{name} did not come up"
            time.sleep(0.02)

    def environment(self, **changes: str) -> dict[str, str]:
        """What a program in it starts with: nothing of ROS but domain 0, and UDP only."""
        values = {key: value for key, value in os.environ.items() if not key.startswith("ROS_")}
        return {**values, "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4", "ROS_DOMAIN_ID": "0", **changes}

    def start(self, *command: str, name: str = "", **environment: str) -> Program:
        name = name or f"program{len(self.programs)}"
        program = Program([*self._enter(), *command], self.environment(**environment), self.folder, name)
        self.programs.append(program)
        return program

    def popen(
        self, command: list[str], stdin: int, stdout: int, stderr: IO[bytes], **environment: str
    ) -> Any:
        """A program whose input and output are the caller's."""
        program = Piped([*self._enter(), *command], stdin, stdout, stderr, self.environment(**environment))
        self.programs.append(program)
        return program.process

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for program in self.programs:
            if program.process.poll() is None:
                program.process.send_signal(program.end)
        for program in self.programs:
            try:
                program.process.wait(5)
            except subprocess.TimeoutExpired:
                program.process.kill()
                program.process.wait(5)
        self._holder.kill()
        self._holder.communicate(timeout=5)


def lay(one: Namespace, other: Namespace, cable: str) -> None:
    """A cable of that name between two namespaces, without addresses and not up."""
    if os.geteuid() != 0:
        pytest.skip("only root can lay a cable between two network namespaces")
    one.run(f"ip link add name {cable} type veth peer name {cable} netns {other.pid}")


def connect(one: Namespace, other: Namespace, cable: str, subnet: str) -> None:
    """A cable of that name between two namespaces: addresses .1 and .2 of a subnet such as "10.0.1"."""
    lay(one, other, cable)
    for end, number in ((one, 1), (other, 2)):
        end.run(f"ip address add {subnet}.{number}/24 dev {cable} && ip link set dev {cable} up")
    for end in (one, other):
        end.wait_for_link(cable)


def route(left: Namespace, router: Namespace, right: Namespace) -> None:
    """Two hosts, 10.0.1.1 and 10.0.2.1, with a router in between that passes on what is not multicast."""
    connect(left, router, "left", "10.0.1")
    connect(right, router, "right", "10.0.2")
    router.run("sysctl -qw net.ipv4.ip_forward=1")
    left.run("ip route add default via 10.0.1.2")
    right.run("ip route add default via 10.0.2.2")


def connect_lossy(one: Namespace, middle: Namespace, other: Namespace, percent: float) -> Program:
    """Two hosts, 10.0.1.1 and 10.0.1.2, and between them a bridge that loses frames by a seeded die."""
    for host, cable, number in ((one, "left", 1), (other, "right", 2)):
        lay(host, middle, cable)
        host.run(f"ip address add 10.0.1.{number}/24 dev {cable} && ip link set dev {cable} up")
        middle.run(f"ip link set dev {cable} up")
        host.wait_for_link(cable)
    bridge = middle.start(
        sys.executable,
        str(pathlib.Path(__file__).parent / "peers/lossy_bridge.py"),
        "left",
        "right",
        str(percent),
    )
    bridge.wait_for("ready")
    return bridge
