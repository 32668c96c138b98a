"""The fuzz target of the participant runs without a fuzzer."""

from __future__ import annotations

import subprocess
import sys

import peers


def test_the_fuzz_target_runs_without_a_fuzzer() -> None:
    command = [sys.executable, str(peers.ROOT / "fuzz/fuzz_rtps_participant.py"), "--smoke", "1500"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "1500 inputs, no finding\n", done.stderr


def test_a_flood_leaves_a_participant_within_its_limits() -> None:
    command = [sys.executable, str(peers.ROOT / "fuzz/flood_rtps.py"), "20000"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100, check=False)
    assert done.stdout == "20000 datagrams, within the limits\n", done.stderr
