"""The fuzz target of contexts and services runs without a fuzzer."""

from __future__ import annotations

import subprocess
import sys

import peers


def test_the_fuzz_target_runs_without_a_fuzzer() -> None:
    command = [sys.executable, str(peers.ROOT / "fuzz/fuzz_ros2.py"), "--smoke", "300"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "300 inputs, no finding\n", done.stderr
