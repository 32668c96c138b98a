"""The fuzz targets of what is typed at a command line run without a fuzzer; what they found stands in the tests of what
they broke."""

from __future__ import annotations

import subprocess
import sys

import pytest

import peers


@pytest.mark.parametrize("target", ["fuzz_names", "fuzz_scalars", "fuzz_values"])
def test_the_fuzz_target_runs_without_a_fuzzer(target: str) -> None:
    command = [sys.executable, str(peers.ROOT / f"fuzz/{target}.py"), "--smoke", "2000"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "2000 inputs, no finding\n", done.stderr
