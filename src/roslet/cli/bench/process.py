"""Programs of the evaluation as processes: started, read line by line, ended."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import re
import subprocess
import threading
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence

# Seconds for a process to end by itself when its standard input ends, before it is killed.
PATIENCE = 5.0
TAIL = 8


class Failed(Exception):
    """A program ended or fell silent; the text says which, with its last words."""


class Process:
    """One program that says facts as JSON lines. As a context manager it ends with the block: the end of its standard
    input ends one that listens to that, SIGTERM another."""

    def __init__(
        self, name: str, command: Sequence[str], environment: dict[str, str], listens: bool = True
    ) -> None:
        self.name = name
        self._listens = listens
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._errors: list[str] = []
        self.process = subprocess.Popen(
            list(command),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment,
            encoding="utf-8",
            errors="replace",
        )
        self._threads = [
            threading.Thread(target=reader, daemon=True) for reader in (self._read, self._complain)
        ]
        for thread in self._threads:
            thread.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._lines.put(line.rstrip("\n"))
        self._lines.put(None)

    def _complain(self) -> None:
        assert self.process.stderr is not None
        for line in self.process.stderr:
            self._errors.append(line.rstrip())
            del self._errors[:-TAIL]

    def line(self, seconds: float) -> str:
        """Its next line. Raises Failed where there is none within so many seconds."""
        try:
            found = self._lines.get(timeout=seconds)
        except queue.Empty:
            raise Failed(f"{self.name} says nothing for {seconds:g} s{self._last()}") from None
        if found is None:
            self._threads[1].join(1.0)
            raise Failed(f"{self.name} has ended{self._last()}")
        return found

    def fact(self, seconds: float) -> dict[str, Any]:
        """Its next JSON object; other lines, which libraries print, are passed over. Raises Failed."""
        end = time.monotonic() + seconds
        while True:
            try:
                found = json.loads(self.line(max(0.0, end - time.monotonic())))
            except ValueError:
                continue
            if isinstance(found, dict):
                return found

    def _last(self) -> str:
        return f": {self._errors[-1]}" if self._errors else ""

    def memory(self) -> int | None:
        """Its greatest resident memory so far in bytes; None where the system does not tell."""
        try:
            with open(f"/proc/{self.process.pid}/status", encoding="ascii") as status:
                found = re.search(r"VmHWM:\s*(\d+) kB", status.read())
        except OSError:
            return None
        return int(found.group(1)) * 1024 if found else None

    def close(self) -> None:
        """End it."""
        if self.process.stdin is not None:
            with contextlib.suppress(OSError):
                self.process.stdin.close()
        if not self._listens:
            self.process.terminate()
        try:
            self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def __enter__(self) -> Process:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


def environment(**changes: str) -> dict[str, str]:
    """For a program that is not of this interpreter: nothing of ROS or Python is inherited."""
    ours = ("PYTHON", "VIRTUAL_ENV", "ROS_", "ROSLET_", "RMW_", "CYCLONEDDS_", "FASTDDS_", "FASTRTPS_")
    kept = {name: value for name, value in os.environ.items() if not name.startswith(ours)}
    return {**kept, "PYTHONUNBUFFERED": "1", **changes}
