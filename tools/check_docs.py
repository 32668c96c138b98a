"""Runs the code blocks of README.md and docs/: `check_docs.py [FILE...]`.

A block that opens with ```python is run in a process of its own, in an empty folder, with a master of ours
on a free port; it must exit 0 within LIMIT seconds. ```python no-run is only compiled (an excerpt that needs
more than one machine has). Blocks of other languages are prose.
"""

from __future__ import annotations

import ast
import os
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMIT = 30.0  # seconds for one block
BLOCK = re.compile(r"^```(python[^\n]*)\n(.*?)^```\s*$", re.MULTILINE | re.DOTALL)


def blocks(path: pathlib.Path) -> list[tuple[int, str, str]]:
    """(line of the first statement, info string, source) of each Python block."""
    text = path.read_text(encoding="utf-8")
    return [(text.count("\n", 0, found.start(2)) + 1, found[1], found[2]) for found in BLOCK.finditer(text)]


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def start_master(environment: dict[str, str]) -> subprocess.Popen[bytes]:
    port = free_port()
    environment["ROS_MASTER_URI"] = f"http://127.0.0.1:{port}"
    process = subprocess.Popen(
        [sys.executable, "-m", "roslet", "master", "--port", str(port)],
        env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
    )  # fmt: skip
    end = time.monotonic() + 10
    while time.monotonic() < end and process.poll() is None:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return process
        time.sleep(0.02)
    process.kill()
    raise SystemExit("check_docs.py: `roslet master` does not start")


def check(path: pathlib.Path, line: int, info: str, source: str, environment: dict[str, str]) -> str | None:
    """None, or what is wrong with a block."""
    where = f"{path.relative_to(ROOT)}:{line}"
    try:
        compile("\n" * (line - 1) + source, str(path), "exec", flags=ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)
    except SyntaxError as error:
        return f"{where}: {error}"
    if "no-run" in info.split():
        return None
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = subprocess.run(
                [sys.executable, "-c", source],
                cwd=folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=LIMIT,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return f"{where}: still running after {LIMIT:g} s"
    if done.returncode != 0:
        return f"{where}: exit code {done.returncode}\n{done.stderr.decode('utf-8', 'replace')}"
    return None


def main(arguments: list[str]) -> int:
    paths = [pathlib.Path(argument).resolve() for argument in arguments]
    paths = paths or [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    found = [(path, *block) for path in paths if path.exists() for block in blocks(path)]
    environment = dict(os.environ, ROS_IP="127.0.0.1")
    runs = any("no-run" not in info.split() for _, _, info, _ in found)
    master = start_master(environment) if runs else None
    try:
        wrong = [problem for block in found if (problem := check(*block, environment)) is not None]
    finally:
        if master is not None:
            master.terminate()
            master.wait(10)
    for problem in wrong:
        print(problem, file=sys.stderr)
    print(f"{len(found)} blocks, {len(wrong)} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
