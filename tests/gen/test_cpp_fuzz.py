"""The fuzz target of C++ headers, for a short while; `make fuzz` runs it longer, with every type."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest

from gen.cpp_programs import require
from peers import ROOT


@pytest.mark.timeout(900)
def test_the_fuzz_target_finds_nothing() -> None:
    require("clang++ with sanitizers")
    command = [sys.executable, str(ROOT / "fuzz" / "fuzz_cpp.py"), "--smoke", "50000"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-5000:]
    found = re.search(r"Done (\d+) runs", done.stderr)
    assert found is not None and int(found[1]) >= 50_000, done.stderr[-5000:]
