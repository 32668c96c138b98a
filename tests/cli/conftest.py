"""A master in this process, and ways to run the command: in this process (fast), or as one of its own (signals, pipes)."""

from __future__ import annotations

import os
import pathlib
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from roslet.cli.main import main
from roslet.master.server import MasterServer

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Outcome:
    """What a command did."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code = code
        self.out = out
        self.err = err


@pytest.fixture
def master(monkeypatch: pytest.MonkeyPatch) -> Iterator[MasterServer]:
    with MasterServer("127.0.0.1", 0) as server:
        monkeypatch.setenv("ROS_MASTER_URI", server.uri)
        yield server


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str]) -> Callable[..., Outcome]:
    """Run a command in this process."""

    def call(*arguments: object) -> Outcome:
        capsys.readouterr()
        try:
            code = main([str(argument) for argument in arguments])
        except SystemExit as ending:  # argparse, for --help and wrong usage
            code = int(ending.code or 0)
        captured = capsys.readouterr()
        return Outcome(code, captured.out, captured.err)

    return call


@pytest.fixture
def start() -> Iterator[Callable[..., subprocess.Popen[Any]]]:
    """Start a command as a process, which ends with the test."""
    processes: list[subprocess.Popen[Any]] = []

    def begin(*arguments: object, **options: Any) -> subprocess.Popen[Any]:
        given: dict[str, Any] = {
            "stdout": subprocess.PIPE,
            "stderr": subprocess.PIPE,
            "text": True,
            **options,
        }
        process = subprocess.Popen(
            [sys.executable, "-m", "roslet", *map(str, arguments)],
            stdin=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": str(ROOT / "src"), "PYTHONUNBUFFERED": "1"},
            **given,
        )
        processes.append(process)
        return process

    yield begin
    for process in processes:
        if process.poll() is None:
            process.kill()
        process.wait()
        for stream in (process.stdout, process.stderr):
            if stream is not None:
                stream.close()


@pytest.fixture
def eventually() -> Callable[[Callable[[], object], str], None]:
    """Wait until something is true; fail after ten seconds, saying what was not."""

    def wait(predicate: Callable[[], object], what: str) -> None:
        end = time.monotonic() + 10.0
        while not predicate():
            assert time.monotonic() < end, f"not within 10 s: {what}"
            time.sleep(0.01)

    return wait
