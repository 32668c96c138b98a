"""Peer programs of the ROS 2 tests, several in one namespace of their own; see peers/commands.py for how they are told."""

from __future__ import annotations

import json
import pathlib
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from typing import Any

import peers
from interop.namespace import Namespace

PROGRAMS = peers.ROOT / "tests/interop/peers"
# Seconds until something that should happen counts as not happening; a wait ends as soon as it has.
PATIENCE = 15.0
# Of a peer that has its whole life to begin, with other tests beside it.
START = 60.0


def wait_until(predicate: Callable[[], object], what: str, patience: float = PATIENCE) -> None:
    """Returns as soon as predicate() is true; fails after `patience` seconds, saying what did not happen."""
    end = time.monotonic() + patience
    while not predicate():
        if time.monotonic() > end:
            raise AssertionError(f"{what}: not within {patience:g} s")
        time.sleep(0.01)


class Peer:
    """A program of one of the peers: "roslet", "kilted", "jazzy" or "cyclone". `words` follow it: the node's name, and for
    roslet its namespace and network; without any, it has a node in its children only."""

    def __init__(self, namespace: Namespace, kind: str, *words: str, **environment: str) -> None:
        self.kind = kind
        self.node = "/" + words[0] if words else ""
        program = {"roslet": "roslet_ros2.py", "cyclone": "cyclone_ros2.py"}.get(kind, "rclpy_ros2.py")
        python = sys.executable if kind == "roslet" else str(peers.require(kind))
        self.errors = namespace.folder / f"{kind}-{len(namespace.programs)}-{time.monotonic_ns()}.err"
        with self.errors.open("wb") as errors:
            self.process = namespace.popen(
                [python, str(PROGRAMS / program), *words],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                **environment,
            )
        self._answers: queue.SimpleQueue[str] = queue.SimpleQueue()
        threading.Thread(target=self._listen, daemon=True).start()
        self.ask("process", patience=START)

    def _listen(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._answers.put(line.decode())
        self._answers.put("")

    def tell(self, command: str, *arguments: object) -> None:
        """A command whose answer `answer` gets."""
        assert self.process.stdin is not None
        self.process.stdin.write((json.dumps([command, *arguments]) + "\n").encode())
        self.process.stdin.flush()

    def answer(self, patience: float = PATIENCE) -> Any:
        try:
            line = self._answers.get(timeout=patience)
        except queue.Empty:
            raise AssertionError(f"{self.kind} does not answer: {self.log()}") from None
        if not line:
            raise AssertionError(f"{self.kind} has ended: {self.log()}")
        verdict, value = json.loads(line)
        assert verdict == "ok", f"{self.kind}: {value}"
        return value

    def ask(self, command: str, *arguments: object, patience: float = 30.0) -> Any:
        """What the program answers to a command."""
        self.tell(command, *arguments)
        return self.answer(patience)

    def wait(self, expected: object, command: str, *arguments: object, patience: float = PATIENCE) -> None:
        """Until it answers so."""
        found = None
        end = time.monotonic() + patience
        while True:
            found = self.ask(command, *arguments)
            if found == expected:
                return
            if time.monotonic() > end:
                raise AssertionError(f"{self.kind}: {command} {arguments}: {found}, not {expected}")
            time.sleep(0.01)

    def log(self) -> str:
        return self.errors.read_text(errors="replace")[-4000:]

    def quit(self) -> None:
        """Let it end by itself."""
        if self.process.poll() is None:
            assert self.process.stdin is not None
            self.process.stdin.close()
            self.process.wait(10)


class Host:
    """A namespace with peers, all of which end with it."""

    def __init__(self, folder: pathlib.Path, **environment: str) -> None:
        self.namespace = Namespace(folder)
        self.environment = environment

    def __enter__(self) -> Host:
        self.namespace.__enter__()
        return self

    def __exit__(self, *exception: Any) -> None:
        self.namespace.__exit__(*exception)

    def peer(self, kind: str, *words: str, **environment: str) -> Peer:
        return Peer(self.namespace, kind, *words, **{**self.environment, **environment})


class Pair:
    """Who talks and who listens in a file's tests: one of them is roslet."""

    def __init__(self, host: Host, talker: str, listener: str) -> None:
        self.host = host
        self.talker = host.peer(talker, "talker")
        self.listener = host.peer(listener, "listener")
