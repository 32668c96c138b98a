"""Every example program runs, alone with --help and with its partner against a master of ours."""

from __future__ import annotations

import os
import pathlib
import struct
import subprocess
import sys
import zlib
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import peers
from roslet.master.server import MasterServer

FOLDER = peers.ROOT / "examples"
PROGRAMS = sorted(path.name for path in FOLDER.glob("*.py"))

Start = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def start() -> Iterator[Start]:
    """Start an example on a master of its own; it ends with the test."""
    processes: list[subprocess.Popen[str]] = []
    with MasterServer("127.0.0.1", 0) as master:

        def begin(name: str, *arguments: object) -> subprocess.Popen[str]:
            process = subprocess.Popen(
                [
                    sys.executable,
                    str(FOLDER / name),
                    "--network",
                    f"ros1://127.0.0.1:{master.port}",
                    *map(str, arguments),
                ],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                env={**os.environ, "PYTHONPATH": str(peers.ROOT / "src")},
            )
            processes.append(process)
            return process

        yield begin
        for process in processes:
            if process.poll() is None:
                process.kill()
            process.communicate()


def finish(process: subprocess.Popen[str]) -> list[str]:
    """The lines that a program printed; it must end by itself, with exit code 0, and complain of nothing."""
    out, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (0, "")
    return out.splitlines()


def test_the_examples_are_those_of_the_readme() -> None:
    text = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert [name for name in PROGRAMS if f"`{name}`" not in text] == []


@pytest.mark.parametrize("name", PROGRAMS)
def test_every_example_has_help(name: str) -> None:
    done = subprocess.run(
        [sys.executable, str(FOLDER / name), "--help"],
        capture_output=True,
        text=True,
        check=False,
        timeout=20,
        env={**os.environ, "PYTHONPATH": str(peers.ROOT / "src")},
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("usage: ")


@pytest.mark.parametrize("name", PROGRAMS)
def test_every_example_says_how_to_run_it(name: str) -> None:
    assert f"python {name}" in (FOLDER / name).read_text(encoding="utf-8")


def test_strings_are_heard_in_one_process_and_in_two(start: Start) -> None:
    expected = ["I heard: Hello roslet 1", "I heard: Hello roslet 2", "I heard: Hello roslet 3"]
    assert finish(start("string_pubsub.py", "--rate", 50, "--count", 3)) == expected
    listener = start("string_pubsub.py", "sub", "--count", 3)
    finish(start("string_pubsub.py", "pub", "--rate", 50, "--count", 3))
    assert finish(listener) == expected


def test_a_type_of_ones_own_is_heard_whole(start: Start) -> None:
    listener = start("custom_pubsub.py", "sub", "--count", 3)
    finish(start("custom_pubsub.py", "pub", "--rate", 50, "--count", 3))
    assert finish(listener) == [
        "Ada Lovelace wants red 255 green 0 blue 0",
        "Grace Hopper wants red 0 green 255 blue 0",
        "Mary Somerville wants red 0 green 0 blue 255",
    ]


def test_coordinates_are_heard_checked_and_come_back(start: Start) -> None:
    listener = start("coordinate_listener.py", "--count", 5)
    talker = start("coordinate_talker.py", "--rate", 50, "--count", 5)
    said = finish(talker)
    assert said[-1].startswith("sent 5, came back 5, median round trip ")
    heard = finish(listener)
    assert heard[0].startswith("I heard [x: 0.100000, y: 10.030000, z: 3.003000] at ")
    assert heard[-1] == "heard 5, wrong 0"


def test_a_listener_notices_what_is_not_as_it_should_be(start: Start, tmp_path: pathlib.Path) -> None:
    """Judged with a talker that leaves one out: the checks of the demo rest on this."""
    listener = start("coordinate_listener.py", "--count", 2)
    skipping = tmp_path / "skipping.py"
    skipping.write_text(
        "import sys\n"
        f"sys.path.insert(0, {str(FOLDER)!r})\n"
        "import coordinate_talker as program\n"
        "whole = program.coordinate\n"
        "program.coordinate = lambda number: whole(2 * number)\n"
        "sys.exit(program.main())\n"
    )
    talker = start(os.path.relpath(skipping, FOLDER), "--rate", 50, "--count", 2)
    finish(talker)
    _, err = listener.communicate(timeout=20)
    assert listener.returncode == 1
    assert "not what was expected after message 2" in err


def pixels(path: pathlib.Path) -> tuple[int, int, bytes]:
    """Width, height and rows of an 8-bit RGB PNG file without filters."""
    data = path.read_bytes()
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    chunks: dict[bytes, bytes] = {}
    at = 8
    while at < len(data):
        (size,) = struct.unpack_from(">I", data, at)
        name, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + size]
        assert struct.unpack_from(">I", data, at + 8 + size)[0] == zlib.crc32(name + body)
        chunks[name] = body
        at += 12 + size
    width, height, *rest = struct.unpack(">2I5B", chunks[b"IHDR"])
    assert rest == [8, 2, 0, 0, 0]
    rows = zlib.decompress(chunks[b"IDAT"])
    length = 1 + 3 * width
    lines = [rows[at : at + length] for at in range(0, len(rows), length)]
    assert [line[0] for line in lines] == [0] * height
    return width, height, b"".join(line[1:] for line in lines)


def test_the_viewer_saves_the_picture_that_was_sent(start: Start, tmp_path: pathlib.Path) -> None:
    file = tmp_path / "image.png"
    viewer = start("image_viewer.py", "--check", "--count", 4, "--save", file)
    finish(start("image_publisher.py", "--rate", 30, "--count", 4, "--width", 64, "--height", 48))
    said = finish(viewer)
    assert said[-1] == f"received 4, latest 64 x 48, rgb8, in {file}"
    sys.path.insert(0, str(FOLDER))
    try:
        import image_publisher
    finally:
        sys.path.remove(str(FOLDER))
    assert pixels(file) == (64, 48, image_publisher.picture(4, 64, 48))
    assert image_publisher.picture(3, 64, 48) != image_publisher.picture(4, 64, 48)


def test_a_viewer_that_got_nothing_fails(start: Start, tmp_path: pathlib.Path) -> None:
    viewer: Any = start("image_viewer.py", "--seconds", 0.2, "--save", tmp_path / "image.png")
    viewer.communicate(timeout=20)
    assert viewer.returncode == 1
    assert not (tmp_path / "image.png").exists()
