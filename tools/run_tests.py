"""Runs every test, in two parts side by side: those that need nothing but a processor yield to the others, which wait for
peers most of the time and judge by the clock. The last line has the counts of both.

    python tools/run_tests.py

The exit code is 0 where all passed; in CI, where none was skipped either.
"""

from __future__ import annotations

import pathlib
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from collections import Counter

ROOT = pathlib.Path(__file__).resolve().parents[1]
# Seconds for one test that runs when the others leave it a processor; a test's own mark goes first.
PATIENCE = 900


def yielding() -> list[str]:
    """The tests that need nothing but a processor: blocks simulated cycle by cycle, proofs, C++ headers compiled."""
    tests = ROOT / "tests"
    found = [tests / "gateware" / "typed"]
    for pattern in ("gateware/test_*.py", "gen/test_cpp*.py"):
        found += sorted(tests.glob(pattern))
    return [str(path.relative_to(ROOT)) for path in found]


def counts(report: pathlib.Path) -> Counter[str]:
    """How many passed, failed and were skipped, of a report in JUnit's format; one that is not there failed."""
    try:
        suite = next(ElementTree.parse(report).iter("testsuite"))
    except (OSError, ElementTree.ParseError, StopIteration):
        return Counter(failed=1)
    found = {name: int(suite.get(name, 0)) for name in ("tests", "failures", "errors", "skipped")}
    failed = found["failures"] + found["errors"]
    return Counter(passed=found["tests"] - failed - found["skipped"], failed=failed, skipped=found["skipped"])


def main() -> int:
    """Run both parts; what came of them."""
    began = time.monotonic()
    beside = yielding()
    pytest = [sys.executable, "-m", "pytest"]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        first, second = folder / "first.xml", folder / "second.xml"
        with (folder / "beside.log").open("w", encoding="utf-8") as log:
            quiet = subprocess.Popen(
                ["nice", "-n", "19", *pytest, f"--timeout={PATIENCE}", f"--junitxml={first}", *beside],
                cwd=ROOT,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
            )
            try:
                ignored = [f"--ignore={path}" for path in beside]
                code = subprocess.call(
                    [*pytest, f"--junitxml={second}", *ignored], cwd=ROOT, stdin=subprocess.DEVNULL
                )
                code = quiet.wait() or code
            finally:
                quiet.terminate()  # where this was interrupted
        print(f"== beside them\n{(folder / 'beside.log').read_text(encoding='utf-8')}", flush=True)
        total = counts(first) + counts(second)
    told = ", ".join(f"{number} {what}" for what, number in total.items() if number)
    print(f"== {told} in {time.monotonic() - began:.0f} s, both parts")
    return 1 if code else 0


if __name__ == "__main__":
    sys.exit(main())
