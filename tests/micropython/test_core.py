"""The core's tests under MicroPython, one pytest test each, so that the counts of the closing line are real.

A test module joins by `pytestmark = pytest.mark.micropython`; a test in it that needs CPython is marked
`cpython`. Every file is run once, in a MicroPython process of its own.
"""

from __future__ import annotations

import ast
import functools
import json
import os
import pathlib
import subprocess

import pytest

import peers

HERE = pathlib.Path(__file__).resolve().parent
TESTS = HERE.parent
SECONDS = 100  # for one file; a core test file takes about a second
HEAP = "64m"  # of the host's memory; what fits a microcontroller is a matter for the benchmarks


def _is_mark(node: ast.expr, name: str) -> bool:
    if isinstance(node, ast.Call):
        node = node.func
    return isinstance(node, ast.Attribute) and node.attr == name


def _joined(tree: ast.Module) -> bool:
    for node in tree.body:
        if isinstance(node, ast.Assign) and any(
            isinstance(target, ast.Name) and target.id == "pytestmark" for target in node.targets
        ):
            marks = node.value.elts if isinstance(node.value, ast.List | ast.Tuple) else [node.value]
            return any(_is_mark(mark, "micropython") for mark in marks)
    return False


def _collect() -> list[tuple[str, str]]:
    """(file relative to tests/, test name) of everything that joins."""
    found = []
    for path in sorted(TESTS.rglob("test_*.py")):
        source = path.read_text(encoding="utf-8")
        if "mark.micropython" not in source or path.parent == HERE:
            continue
        tree = ast.parse(source)
        if not _joined(tree):
            continue
        for node in tree.body:
            if not isinstance(node, ast.FunctionDef) or not node.name.startswith("test_"):
                continue
            if not any(_is_mark(decorator, "cpython") for decorator in node.decorator_list):
                found.append((path.relative_to(TESTS).as_posix(), node.name))
    return found


@functools.cache
def _results(file: str) -> dict[str, tuple[str, str]]:
    """Test name -> (outcome, text) of one file's run; "" is the file itself when it could not be imported."""
    interpreter = peers.require("micropython")
    environment = dict(os.environ, MICROPYPATH=f"{TESTS.parent / 'src'}:{TESTS}:.frozen")
    command = [str(interpreter), "-X", f"heapsize={HEAP}", "run.py", "shims", str(TESTS / file)]
    done = subprocess.run(
        command, cwd=HERE, env=environment, capture_output=True, timeout=SECONDS, check=False
    )
    results = {}
    for line in done.stdout.decode("utf-8", "replace").splitlines():
        if line.startswith('{"'):
            entry = json.loads(line)
            results[entry["test"]] = (entry["outcome"], entry["text"])
    if done.returncode != 0:
        results.setdefault("", ("failed", (done.stdout + done.stderr).decode("utf-8", "replace")[-4000:]))
    return results


@pytest.mark.parametrize(("file", "test"), _collect())
def test_core(file: str, test: str) -> None:
    results = _results(file)
    outcome, text = results.get(test) or results.get("") or ("missing", "the runner did not report this test")
    assert outcome == "passed", f"under MicroPython: {outcome}\n{text}"
