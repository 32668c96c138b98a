"""Every example program runs: alone with --help, and with its partner on both networks."""

from __future__ import annotations

import contextlib
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import time
import zlib
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import peers
from nodes import domain, network

__all__ = ["network"]

FOLDER = peers.ROOT / "examples"
PROGRAMS = sorted(path.name for path in FOLDER.glob("*.py"))

Start = Callable[..., "subprocess.Popen[str]"]


@contextlib.contextmanager
def starting(network: str) -> Iterator[Start]:
    processes: list[subprocess.Popen[str]] = []

    def begin(name: str, *arguments: object) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, str(FOLDER / name), "--network", network, *map(str, arguments)],
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


@pytest.fixture
def start(network: str) -> Iterator[Start]:
    """Start an example on a network of the test's own; it ends with the test."""
    with starting(network) as begin:
        yield begin


@pytest.fixture
def start_ros2() -> Iterator[Start]:
    """The same for what there is on ROS 2 only."""
    with starting(f"ros2://{domain()}?range=localhost") as begin:
        yield begin


def finish(process: subprocess.Popen[str], patience: float = 20) -> list[str]:
    """The lines that a program printed; it must end by itself, with exit code 0, and complain of nothing."""
    out, err = process.communicate(timeout=patience)
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


def test_a_board_in_cpp_talks_through_a_node(start: Start) -> None:
    if shutil.which("g++") is None:
        pytest.skip("the compiler g++ is absent; `make peers` installs it")
    listener = start("coordinate_listener.py", "--count", 3)
    said = finish(start("cpp/board.py", "--count", 3), patience=100)  # it compiles first
    assert said[:3] == [
        "came back [x: 0.100000, y: 10.030000, z: 3.003000]",
        "came back [x: 0.200000, y: 20.059999, z: 6.006000]",
        "came back [x: 0.300000, y: 30.090000, z: 9.009000]",
    ]
    assert said[3].startswith("heard 3, wrong 0, longest round trip ")
    assert finish(listener)[-1] == "heard 3, wrong 0"


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


def test_a_service_is_called_in_one_process_and_in_two(start: Start) -> None:
    assert finish(start("service.py")) == ["2 + 3", "2 + 4", "2 + 5", "sums 5 6 7"]
    server = start("service.py", "server")
    assert finish(start("service.py", "client", 40, 2)) == ["sums 42 43 44"]
    assert interrupt(server) == ["40 + 2", "40 + 3", "40 + 4"]


def interrupt(process: subprocess.Popen[str]) -> list[str]:
    """What it printed until a Ctrl-C, after which it ends quietly."""
    process.send_signal(signal.SIGINT)
    return finish(process)


def test_an_asyncio_program_hears_and_asks(start: Start) -> None:
    said = finish(start("asyncio_node.py", "--count", 3))
    assert sorted(said) == [
        *(f"I heard: Hello asyncio {number}" for number in (1, 2, 3)),
        "the switch says: on",
    ]


def test_an_action_gives_feedback_a_result_and_can_be_canceled(start_ros2: Start) -> None:
    server = start_ros2("action.py", "server", "--pause", 0.05)
    assert finish(start_ros2("action.py", "client", "--order", 5)) == [
        *(f"so far {number}" for number in (1, 2, 3, 5, 8)),
        "SUCCEEDED 0 1 1 2 3 5 8",
    ]
    said = finish(start_ros2("action.py", "client", "--order", 40, "--cancel-after", 2))
    assert said[:2] == ["so far 1", "so far 2"]
    assert said[-1].startswith("CANCELED 0 1 1 2") and len(said) < 12
    interrupt(server)


def test_a_parameter_changes_what_a_program_does(start: Start, network: str) -> None:
    heart = start("parameters.py", "--count", 30)
    assert heart.stdout is not None and heart.stdout.readline() == "2 beats a second\n"
    command = [sys.executable, "-m", "roslet", "param", "set"]
    name = ["/heart/hz"] if network.startswith("ros1") else ["/heart", "hz"]
    env = {**os.environ, "PYTHONPATH": str(peers.ROOT / "src")}
    begin = time.monotonic()
    done = subprocess.run(
        [*command, *name, "50.0", "--network", network],
        env=env,
        capture_output=True,
        text=True,
        timeout=30,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert finish(heart) == ["50 beats a second", "30 beats"]
    assert time.monotonic() - begin < 14, "thirty beats at the old rate take 15 s"


def test_the_events_of_qos_are_told(start_ros2: Start) -> None:
    assert finish(start_ros2("qos_events.py")) == [
        "no messages from /offers: reliability",
        "matched with /offers",
        "one",
        "the deadline was missed",
        "came late and got map 2 map 3",
    ]
