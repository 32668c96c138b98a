"""The fuzz targets of the ROS 1 machines run without a fuzzer; inputs that once broke them stand in the tests of what they
broke."""

from __future__ import annotations

import subprocess
import sys

import pytest

import peers


@pytest.mark.parametrize("target", ["fuzz_tcpros", "fuzz_framing", "fuzz_udpros", "fuzz_ros1_engine"])
def test_the_fuzz_target_runs_without_a_fuzzer(target: str) -> None:
    command = [sys.executable, str(peers.ROOT / f"fuzz/{target}.py"), "--smoke", "3000"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "3000 inputs, no finding\n", done.stderr
