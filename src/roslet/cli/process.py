"""Programs as processes: started, read line by line, ended."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import re
import signal
import subprocess
import threading
import time
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from typing_extensions import Self

# Seconds for a process to end by itself when it is asked to, before it is killed.
PATIENCE = 5.0
# Lines of its standard error that are kept, the last ones.
TAIL = 12


class Failed(Exception):
    """A program ended or fell silent; the text says which, with its last words."""


class Process:
    """One program that says facts as JSON lines.

    It is asked to end by the end of its standard input and, where there is one, the signal `stop`; as a context manager,
    with the block. Without an environment it has this process's. What nobody takes of its lines is kept: whoever starts it
    reads it.
    """

    def __init__(
        self,
        name: str,
        command: Sequence[str],
        environment: Mapping[str, str] | None = None,
        stop: signal.Signals | None = None,
    ) -> None:
        self.name = name
        self._stop = stop
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
        found = self.line_or_end(seconds)
        if found is None:
            raise Failed(f"{self.name} has ended{self.last_words()}")
        return found

    def line_or_end(self, seconds: float) -> str | None:
        """Its next line, None after the last one. Raises Failed where there is none within so many seconds."""
        try:
            found = self._lines.get(timeout=seconds)
        except queue.Empty:
            raise Failed(f"{self.name} says nothing for {seconds:g} s{self.last_words()}") from None
        if found is None:
            self._lines.put(None)  # for whoever asks again
            self._threads[1].join(1.0)
        return found

    def lines(self) -> Iterator[str]:
        """The lines that it has said and nobody has taken, without waiting for more."""
        while True:
            try:
                found = self._lines.get_nowait()
            except queue.Empty:
                return
            if found is None:
                self._lines.put(None)
                return
            yield found

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

    def last_words(self) -> str:
        """The last line of its standard error, after a colon; "" where there is none."""
        return f": {self._errors[-1]}" if self._errors else ""

    @property
    def running(self) -> bool:
        """Whether it still runs."""
        return self.process.poll() is None

    def memory(self) -> int | None:
        """Its greatest resident memory so far in bytes; None where the system does not tell."""
        try:
            with open(f"/proc/{self.process.pid}/status", encoding="ascii") as status:
                found = re.search(r"VmHWM:\s*(\d+) kB", status.read())
        except OSError:
            return None
        return int(found.group(1)) * 1024 if found else None

    def end(self, seconds: float) -> int | None:
        """Let it end by itself and its last lines come; its exit code, None where it has not ended in so many seconds."""
        try:
            code = self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return None
        for thread in self._threads:
            thread.join(PATIENCE)
        return code

    def close(self) -> None:
        """End it, whatever it does."""
        assert self.process.stdin is not None
        with contextlib.suppress(OSError):
            self.process.stdin.close()
        if self._stop is not None and self.running:
            self.process.send_signal(self._stop)
        try:
            self.process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


def environment(**changes: str) -> dict[str, str]:
    """For a program that is not of this interpreter: nothing of ROS or Python is inherited."""
    ours = ("PYTHON", "VIRTUAL_ENV", "ROS_", "ROSLET_", "RMW_", "CYCLONEDDS_", "FASTDDS_", "FASTRTPS_")
    kept = {name: value for name, value in os.environ.items() if not name.startswith(ours)}
    return {**kept, "PYTHONUNBUFFERED": "1", **changes}
