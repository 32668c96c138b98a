"""Runs every test, in two parts side by side: those that need nothing but a processor yield to the others, which wait for
peers most of the time and judge by the clock. A few that failed beside the others are run once more, alone: that tells a
busy machine from a defect. The last lines name them and have the counts of all.

    python tools/run_tests.py

The exit code is 0 where all passed, at the first or at the second time; in CI, where none was skipped either.
"""

from __future__ import annotations

import json
import os
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
# Exit codes of pytest.
PASSED, FAILED = 0, 1
# How many that failed are run once more: when it is more than these, it was not the machine.
MOST_AGAIN = 8


class Part:
    """One run of pytest, and what came of it."""

    def __init__(self, folder: pathlib.Path, *arguments: str) -> None:
        self._report = folder / "report.xml"
        self._cache = folder / "cache"
        self.log = folder / "log"
        self.command = [
            *(sys.executable, "-m", "pytest", f"--junitxml={self._report}", "-o", f"cache_dir={self._cache}"),
            *arguments,
        ]
        folder.mkdir()

    def counts(self) -> Counter[str]:
        """How many passed, failed and were skipped; a run that left no report failed."""
        try:
            suite = next(ElementTree.parse(self._report).iter("testsuite"))
        except (OSError, ElementTree.ParseError, StopIteration):
            return Counter(failed=1)
        found = {name: int(suite.get(name, 0)) for name in ("tests", "failures", "errors", "skipped")}
        failed = found["failures"] + found["errors"]
        passed = found["tests"] - failed - found["skipped"]
        return Counter(passed=passed, failed=failed, skipped=found["skipped"])

    def failing(self) -> list[str]:
        """The tests that failed, by their ids."""
        try:
            return sorted(json.loads((self._cache / "v/cache/lastfailed").read_text(encoding="utf-8")))
        except OSError:
            return []


def yielding() -> list[str]:
    """The tests that need nothing but a processor: gateware simulated or proven, without a peer; C++ headers compiled."""
    found = [
        path
        for pattern in ("gateware/**/test_*.py", "gen/test_cpp*.py")
        for path in ROOT.glob(f"tests/{pattern}")
    ]
    return sorted(
        str(path.relative_to(ROOT)) for path in found if not path.stem.endswith(("_peers", "_linux"))
    )


def run_beside(quiet: Part, other: Part) -> set[int]:
    """Run both, the first at the lowest priority and its log printed at the end; their exit codes."""
    with quiet.log.open("w", encoding="utf-8") as log:
        running = subprocess.Popen(
            ["nice", "-n", "19", *quiet.command],
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        try:
            codes = {subprocess.call(other.command, cwd=ROOT, stdin=subprocess.DEVNULL), running.wait()}
        finally:
            running.terminate()  # where this was interrupted
    print(f"== beside them\n{quiet.log.read_text(encoding='utf-8')}", flush=True)
    return codes


def main() -> int:
    """Run both parts, and what failed once more; what came of them."""
    began = time.monotonic()
    beside = yielding()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        quiet = Part(folder / "quiet", f"--timeout={PATIENCE}", *beside)
        other = Part(folder / "other", *(f"--ignore={path}" for path in beside))
        codes = run_beside(quiet, other)
        total = quiet.counts() + other.counts()
        failing = quiet.failing() + other.failing()
        if codes <= {PASSED, FAILED} and 0 < len(failing) <= MOST_AGAIN:
            print("== once more, alone: what failed", flush=True)
            again = Part(folder / "again", f"--timeout={PATIENCE}", *failing)
            codes = {subprocess.call(again.command, cwd=ROOT, stdin=subprocess.DEVNULL)}
            if total["skipped"] and os.environ.get("CI"):
                codes.add(FAILED)
            alone = sorted(set(failing) - set(again.failing()))
            print(f"== passed only when it ran alone: {', '.join(alone) or 'none'}")
            total = total - Counter(failed=total["failed"]) + again.counts()
    told = ", ".join(f"{number} {what}" for what, number in total.items() if number)
    print(f"== {told} in {time.monotonic() - began:.0f} s, all parts")
    return 0 if codes == {PASSED} else 1


if __name__ == "__main__":
    sys.exit(main())
