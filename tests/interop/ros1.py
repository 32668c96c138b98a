"""Masters, peer processes and command-line tools for the ROS 1 interop tests, all on loopback."""

from __future__ import annotations

import contextlib
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import peers

HERE = pathlib.Path(__file__).resolve().parent
PATIENCE = (
    15.0  # seconds until something that should happen counts as not happening; a wait ends as soon as it has
)


def wait_until(predicate: Callable[[], object], what: str, patience: float = PATIENCE) -> None:
    """Returns as soon as predicate() is true; fails after `patience` seconds, saying what did not happen."""
    end = time.monotonic() + patience
    while not predicate():
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not within {patience:g} s")
        time.sleep(0.005)


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def answers(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


class Master:
    """A master process on a port of its own: Debian's rosmaster ("debian") or ours ("roslet")."""

    def __init__(self, kind: str, folder: pathlib.Path, port: int | None = None) -> None:
        self.kind = kind
        self.folder = folder
        self.port = port or free_port()
        self.uri = f"http://127.0.0.1:{self.port}"
        self.network = f"ros1://127.0.0.1:{self.port}"
        self.start()

    def start(self) -> None:
        environment = self.environment()
        if self.kind == "debian":
            program = str(peers.require("rosmaster"))
            command = [str(peers.DEBIAN_PYTHON), program, "--core", "-p", str(self.port)]
        else:
            environment["PYTHONPATH"] = str(peers.ROOT / "src")
            command = [sys.executable, "-m", "roslet", "master", "--port", str(self.port)]
        self._log = open(self.folder / f"master-{self.kind}.log", "ab")  # noqa: SIM115 - as long as the process
        self.process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=self._log, stderr=self._log, env=environment
        )
        wait_until(
            lambda: answers(self.port) or self.process.poll() is not None, f"the {self.kind} master starts"
        )
        if self.process.poll() is not None:
            raise AssertionError(f"the {self.kind} master ended at once:\n{self.log()}")

    def log(self) -> str:
        return (self.folder / f"master-{self.kind}.log").read_text(encoding="utf-8", errors="replace")[-4000:]

    def stop(self) -> None:
        end(self.process)
        self._log.close()

    def environment(self) -> dict[str, str]:
        """For a process of Debian's ROS: this master, our messages, nothing of this Python's environment."""
        ours = ("PYTHON", "VIRTUAL_ENV")
        kept = {name: value for name, value in os.environ.items() if not name.startswith(ours)}
        kept.update(
            ROS_MASTER_URI=self.uri,
            ROS_IP="127.0.0.1",
            ROS_HOME=str(self.folder / "home"),
            ROS_LOG_DIR=str(self.folder / "log"),
            ROS_PACKAGE_PATH=f"{peers.WORKSPACE}:/usr/share",
            PYTHONPATH=str(peers.CACHE / "ros1/python"),
            PYTHONUNBUFFERED="1",
            ROSCONSOLE_STDOUT_LINE_BUFFERED="1",
        )
        return kept


def end(process: subprocess.Popen[Any], patience: float = 20.0) -> int:
    """Interrupts a process of ours, kills it if it does not listen; its exit code."""
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(patience)
        except subprocess.TimeoutExpired:
            process.kill()
    return process.wait()


class Program:
    """A process whose output lines are read as they come."""

    def __init__(self, command: Sequence[str | os.PathLike[str]], environment: dict[str, str]) -> None:
        self.name = os.path.basename(command[0])
        self.process = subprocess.Popen(
            [os.fspath(part) for part in command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
            encoding="utf-8",
            errors="replace",
            bufsize=1,
        )
        self.lines: list[str] = []
        self.errors: list[str] = []
        self._readers = [
            threading.Thread(target=self._read, args=pair, daemon=True)
            for pair in ((self.process.stdout, self.lines), (self.process.stderr, self.errors))
        ]
        for reader in self._readers:
            reader.start()

    @staticmethod
    def _read(stream: Iterable[str], lines: list[str]) -> None:
        lines.extend(line.rstrip("\n") for line in stream)

    def told(self, prefix: str) -> list[str]:
        """The lines so far that begin with a prefix."""
        return [line for line in list(self.lines) if line.startswith(prefix)]

    def wait_for(self, prefix: str, count: int = 1, patience: float = PATIENCE) -> list[str]:
        """Waits for `count` lines that begin with a prefix and returns them."""

        def enough() -> bool:
            if len(self.told(prefix)) >= count:
                return True
            if self.process.poll() is not None and not any(reader.is_alive() for reader in self._readers):
                raise AssertionError(
                    f"{self.name} ended with {self.process.returncode} before it said {prefix!r}"
                )
            return False

        try:
            wait_until(
                enough, f"{self.name} says {prefix!r} {count} times, said {len(self.told(prefix))}", patience
            )
        except AssertionError as error:
            raise AssertionError(f"{error}{self._tail()}") from None
        return self.told(prefix)

    def _tail(self) -> str:
        return "\nlast output:\n" + "\n".join((self.lines + self.errors)[-15:])

    def say(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def finish(self, patience: float = PATIENCE) -> int:
        """Waits until it ends by itself; its exit code."""
        try:
            code = self.process.wait(patience)
        except subprocess.TimeoutExpired:
            self.stop()
            raise AssertionError(f"{self.name} is still running after {patience:g} s{self._tail()}") from None
        for reader in self._readers:
            reader.join(5)
        return code

    def stop(self) -> int:
        if self.process.stdin is not None:
            self.process.stdin.close()
        code = end(self.process)
        for reader in self._readers:
            reader.join(5)
        return code


class Peer(Program):
    """roscpp_peer or rospy_peer.py: a node of a real client library that obeys line by line."""

    def __init__(self, kind: str, master: Master) -> None:
        self.kind = kind
        command: list[str | os.PathLike[str]]
        if kind == "roscpp":
            command = [peers.require("roscpp")]
        else:
            peers.require("rospy")
            peers.require("ros1-messages")
            command = [peers.DEBIAN_PYTHON, HERE / "peers" / "rospy_peer.py"]
        super().__init__(command, master.environment())
        self.name = f"{kind} peer"
        self.node_name = self.wait_for("ready")[0].split()[1]

    def ask(self, line: str, answer: str) -> str:
        """Says a line and returns what follows `answer` in the line that answers it."""
        before = len(self.told(answer))
        self.say(line)
        return self.wait_for(answer, before + 1)[before][len(answer) :].strip()

    def subscribers(self, topic: str) -> int:
        return int(self.ask(f"subscribers {topic}", f"subscribers {topic}"))

    def publishers(self, topic: str) -> int:
        return int(self.ask(f"publishers {topic}", f"publishers {topic}"))

    def quit(self) -> int:
        if self.process.poll() is None:
            self.say("quit")
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(5)
        return self.stop()


class Tools:
    """Debian's rostopic, rosnode, ... against a master."""

    def __init__(self, master: Master, folder: pathlib.Path) -> None:
        self.master = master
        self.folder = folder

    def start(self, *command: str) -> Program:
        """A tool that goes on until it is stopped."""
        return Program([peers.require(command[0]), *command[1:]], self.master.environment())

    def run(self, *command: str, patience: float = 20.0, code: int | None = 0) -> str:
        """A tool that ends by itself: its standard output. Demands the exit code; None allows any."""
        done = subprocess.run(
            [str(peers.require(command[0])), *command[1:]],
            env=self.master.environment(),
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=patience,
            encoding="utf-8",
            check=False,
        )
        text = f"{' '.join(command)} ended with {done.returncode}\n{done.stdout}\n{done.stderr}"
        assert code is None or done.returncode == code, text
        return done.stdout


def remove(folder: pathlib.Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
