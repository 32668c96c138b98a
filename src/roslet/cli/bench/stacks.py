"""The stacks that are compared: where each is, how its programs are started, on which network."""

from __future__ import annotations

import json
import os
import pathlib
import shlex
import subprocess
import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import roslet
from roslet.cli.bench import compiled
from roslet.cli.demo.programs import cyclone_python, folder
from roslet.cli.process import environment

if TYPE_CHECKING:
    from collections.abc import Mapping

PROGRAMS = pathlib.Path(__file__).with_name("programs")
DEBIAN_PYTHON = "/usr/bin/python3"
SOURCE = str(pathlib.Path(roslet.__file__).resolve().parent.parent)
TCP, UDP = "floor TCP", "floor UDP"


@dataclass(frozen=True)
class Network:
    """Where the nodes of one run meet: the master's URI, and the ROS 2 domain."""

    master: str
    domain: int

    @property
    def ros1(self) -> str:
        """As roslet's URL."""
        return self.master.replace("http", "ros1", 1).rstrip("/")

    @property
    def ros2(self) -> str:
        """As roslet's URL."""
        return f"ros2://{self.domain}?range=localhost"


@dataclass(frozen=True)
class Stack:
    """One of what is compared. `ping` and `echo` are the words before the role, one program for both as a rule; `dialect`
    is ros1, ros2 or nothing, for a floor. A program of another kind, `foreign`, is told nothing."""

    name: str
    dialect: str
    ping: tuple[str, ...]
    echo: tuple[str, ...]
    variables: Mapping[str, str] = field(default_factory=dict)
    floor: str = TCP
    foreign: bool = False

    def command(self, role: str, options: Mapping[str, Any]) -> list[str]:
        """The command line that is `role` with its options."""
        words = self.ping if role == "ping" else self.echo
        if self.foreign and role != "ping":
            return list(words)
        if role != "mirror" and words[0].endswith("roscpp_node"):
            given = (
                [",".join(options["cases"]), str(options["count"]), str(options["warm_up"])]
                if options
                else []
            )
            return [*words, role, *given]
        return [*words, role, json.dumps(options)]

    def environment(self, network: Network, **more: str) -> dict[str, str]:
        """What its programs find in their environment."""
        ours = {
            "ROSLET_NETWORK": network.ros1 if self.dialect == "ros1" else network.ros2,
            "BENCH_TYPES": str(folder() / "msgs" / "mros_comm_measure"),
            "ROS_MASTER_URI": network.master,
            "ROS_IP": "127.0.0.1",
            "ROS_DOMAIN_ID": str(network.domain),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_LOG_DIR": str(compiled.cache() / "log"),
            "ROS_HOME": str(compiled.cache() / "home"),
        }
        return environment(**ours, **self.variables, **more)


def floors() -> list[Stack]:
    """Raw sockets."""
    words = (sys.executable, str(PROGRAMS / "floor_node.py"))
    return [
        Stack(TCP, "", words, words, {"BENCH_FLOOR": "tcp"}),
        Stack(UDP, "", words, words, {"BENCH_FLOOR": "udp"}, floor=UDP),
    ]


def ours() -> list[Stack]:
    """roslet on this interpreter."""
    words = (sys.executable, str(PROGRAMS / "roslet_node.py"))
    path = {"PYTHONPATH": SOURCE}
    return [
        Stack("roslet, ROS 1", "ros1", words, words, path),
        Stack("roslet, ROS 2", "ros2", words, words, path, floor=UDP),
    ]


def peers(only: str, say: Any = lambda text: None) -> tuple[list[Stack], dict[str, str]]:
    """The peers that are installed and wanted (`only`, words), and by name why others are left out. May compile, which `say`
    is told."""
    found, absent = [], {}
    try:
        if wanted("roscpp", only):
            program = str(compiled.program("roscpp_node", say))
            found.append(Stack("roscpp", "ros1", (program,), (program,)))
    except compiled.Absent as error:
        absent["roscpp"] = str(error)
    try:
        words = (DEBIAN_PYTHON, str(PROGRAMS / "rospy_node.py"))
        found.append(Stack("rospy", "ros1", words, words, {"BENCH_GENPY": str(compiled.genpy())}))
    except compiled.Absent as error:
        absent["rospy"] = str(error)
    python = rclpy_python()
    if python is None:
        absent["rclpy"] = "no interpreter that has it"
    else:
        words = (python, str(PROGRAMS / "rclpy_node.py"))
        coordinate: dict[str, str] = {}
        try:
            if wanted("rclpy", only) or wanted("rclpy, UDP only", only):
                coordinate["BENCH_COORDINATE"] = str(compiled.rclpy_coordinate(python, say))
        except compiled.Absent as error:
            say(f"no Coordinate of rclpy: {error}")
        found.append(Stack("rclpy", "ros2", words, words, coordinate, floor=UDP))
        only_udp = {"FASTDDS_BUILTIN_TRANSPORTS": "UDPv4", **coordinate}
        found.append(Stack("rclpy, UDP only", "ros2", words, words, only_udp, floor=UDP))
    cyclone = cyclone_python()
    if cyclone is None:
        absent["cyclonedds"] = "no interpreter that has it"
    else:
        words = (cyclone, str(PROGRAMS / "cyclone_node.py"))
        found.append(Stack("cyclonedds", "ros2", words, words, {}, floor=UDP))
    return [stack for stack in found if wanted(stack.name, only)], absent


def rclpy_python() -> str | None:
    """An interpreter that has rclpy: that of the tests' peers, or Debian's. None where there is none."""
    for python in (str(compiled.peers_folder() / "kilted" / "bin" / "python"), DEBIAN_PYTHON):
        if os.access(python, os.X_OK):
            done = subprocess.run(
                [python, "-c", "import rclpy"],
                stdin=subprocess.DEVNULL, capture_output=True, check=False, env=environment(),
            )  # fmt: skip
            if not done.returncode:
                return python
    return None


def of_user(text: str) -> Stack:
    """A stack from `NAME=ros1:COMMAND` or `NAME=ros2:COMMAND`: roslet pings what the command starts. Raises ValueError."""
    name, _, rest = text.partition("=")
    dialect, _, command = rest.partition(":")
    if not name or dialect not in ("ros1", "ros2") or not command.strip():
        raise ValueError(f"{text!r} is not NAME=ros1:COMMAND or NAME=ros2:COMMAND")
    return pinged(name, dialect, tuple(shlex.split(command)))


def pinged(name: str, dialect: str, words: tuple[str, ...]) -> Stack:
    """A stack whose echo node is what these words start, and which roslet pings."""
    host = next(stack for stack in ours() if stack.dialect == dialect)
    return Stack(name, dialect, host.ping, words, host.variables, host.floor, foreign=True)


def wanted(name: str, words: str) -> bool:
    """Whether one of the words, separated by commas, is in a name; true where there are no words."""
    each = [word.strip().lower() for word in words.split(",") if word.strip()]
    return not each or any(word in name.lower() for word in each)
