"""What a node on MicroPython takes: flash of a bounded size, a heap of a bounded size, and none more after ten thousand
messages. On the 64-bit Unix interpreter, whose objects are twice as large as a board's; the code runs from simulated flash.
"""

from __future__ import annotations

import os
import pathlib
import socket
import sys
import time
import urllib.parse
import xmlrpc.client
from typing import Any, Literal

import pytest

import peers
from interop import boards
from interop.namespace import Namespace
from interop.ros1 import Master, Program, wait_until
from roslet.bundle.build import Bundle, build

LONG = bool(os.environ.get("ROSLET_LONG"))
MESSAGES = 100_000 if LONG else 12_000
# Seconds that they may take: with both cores busy 100,000 took 240. Less than a namespace lasts.
LIMIT = 540.0 if LONG else 110.0
# And of a whole test, whose ordinary limit is too short for that.
PATIENCE = pytest.mark.timeout(LIMIT + 30)
DEFINITIONS = peers.ROOT / "examples/msgs/mros_comm_measure"
# Bytes of .mpy, and of heap.
FLASH = {"ros1": 60_000, "ros2": 110_000}
# Octets by which what the heap holds differs from one look to the next by nothing but chance: the collector keeps what any
# word on the stack points at, be it left over. Of one look up to 256 were seen, of the least of five 32.
STRAY = 128
# Octets of heap that a message echoed takes until they are collected: a quarter more than was measured.
GARBAGE = {"ros1": 455, "ros2": 1090}


def echo(
    dialect: Literal["ros1", "ros2"], folder: pathlib.Path, rosout: bool, program: str = "board_memory.py"
) -> Bundle:
    peers.require("micropython")
    boards.require_compiler()
    text = (boards.PROGRAMS / program).read_text().replace("NETWORK", dialect + "://")
    (folder / "program.py").write_text(text)
    return build(
        folder / "program.py",
        folder / "bundle",
        dialect,
        definitions=[DEFINITIONS],
        rosout=rosout,
        by_module=False,
    )


def pinger(network: str, count: int, name: str, *rest: str) -> list[str]:
    program = str(boards.PROGRAMS / "roslet_pinger.py")
    return [sys.executable, program, network, str(count), name, str(DEFINITIONS), *rest]


def on_ros1(master: Master) -> dict[str, str]:
    """The environment of programs on that master."""
    return {
        **os.environ,
        "ROS_MASTER_URI": master.uri,
        "ROS_IP": "127.0.0.1",
        "PYTHONPATH": str(peers.ROOT / "src"),
    }


def drift(lines: list[str]) -> int:
    """By how much what the heap holds at rest grew from the first half to the second: the least of each, as an announcement
    may be under way at the moment."""
    held = [int(line.split()[2]) for line in lines if line.startswith("memory")][1:]
    half = len(held) // 2
    assert half >= 5, lines
    grown = min(held[half:]) - min(held[:half])
    if grown > STRAY:
        print("held at each rest:", *held)
    return grown


@pytest.mark.parametrize(("dialect", "most"), FLASH.items())
def test_an_echo_fits_its_flash(dialect: Literal["ros1", "ros2"], most: int, tmp_path: pathlib.Path) -> None:
    boards.require_compiler()
    text = (peers.ROOT / "examples/micropython/echo.py").read_text().replace("ros2://", dialect + "://")
    (tmp_path / "echo.py").write_text(text)
    made = build(tmp_path / "echo.py", tmp_path / "out", dialect, definitions=[DEFINITIONS], by_module=False)
    assert made.total < most
    assert made.image is not None and made.image.stat().st_size < most


@PATIENCE
def test_a_ros1_echo_in_160_kb_takes_no_more_with_time(tmp_path: pathlib.Path) -> None:
    made = echo("ros1", tmp_path, rosout=True)
    master = Master("roslet", tmp_path)
    environment = on_ros1(master)
    board = Program(boards.command(made, "160k"), environment)
    try:
        board.wait_for("ready")
        talker = Program(pinger("ros1://", MESSAGES, "pinger"), environment)
        talker.finish(LIMIT)
        assert talker.lines[-1].startswith(f"right {MESSAGES} of {MESSAGES} "), talker.lines
        assert drift(board.lines) <= STRAY
    finally:
        board.stop()
        master.stop()


@PATIENCE
@pytest.mark.parametrize(("heap", "rosout"), [("256k", False), ("272k", True)])
def test_a_ros2_echo_with_four_peers_takes_no_more_with_time(
    tmp_path: pathlib.Path, heap: str, rosout: bool
) -> None:
    made = echo("ros2", tmp_path, rosout)
    with Namespace(tmp_path) as namespace:
        path = {"PYTHONPATH": str(peers.ROOT / "src")}
        board = namespace.start(*boards.command(made, heap), name="board")
        board.wait_for("ready")
        for number in range(3):
            one = namespace.start(
                *pinger("ros2://", 0, f"peer{number}", str(LIMIT)), name=f"peer{number}", **path
            )
            one.wait_for("ready")
        talker = namespace.start(*pinger("ros2://", MESSAGES, "pinger"), name="pinger", **path)
        lines = talker.finish(LIMIT)
        assert lines[-1].startswith(f"right {MESSAGES} of {MESSAGES} "), lines
        assert drift(board.lines()) <= STRAY


def at_rest(board: Program) -> int:
    """What the heap of board_idle.py holds, from now on for a second: the least."""
    begin = len(board.lines)
    wait_until(lambda: len(board.lines) >= begin + 10, "the board says what it holds")
    return min([int(line.split()[1]) for line in board.lines[begin:]])


def test_what_connected_and_is_gone_takes_no_heap(tmp_path: pathlib.Path) -> None:
    """Each connection has another port, and 64 such addresses were kept: 160 octets each, or 192 with a larger table."""
    made = echo("ros1", tmp_path, rosout=True, program="board_idle.py")
    master = Master("roslet", tmp_path)
    board = Program(boards.command(made, "160k"), on_ros1(master))
    try:
        board.wait_for("ready")
        found: Any = xmlrpc.client.ServerProxy(master.uri).lookupNode("/test", "/idle")
        where = urllib.parse.urlsplit(found[2])

        def connect(count: int) -> None:
            for _ in range(count):
                socket.create_connection((where.hostname or "", where.port or 0)).close()
                time.sleep(0.01)

        connect(5)
        before = at_rest(board)
        connect(40)
        assert at_rest(board) - before < 160
    finally:
        board.stop()
        master.stop()


def garbage(lines: list[str]) -> int:
    return int(next(line for line in lines if line.startswith("garbage")).split()[1])


def test_what_a_ros1_message_leaves_is_little(tmp_path: pathlib.Path) -> None:
    made = echo("ros1", tmp_path, rosout=False, program="board_garbage.py")
    master = Master("roslet", tmp_path)
    environment = on_ros1(master)
    board = Program(boards.command(made, "16m"), environment)
    try:
        board.wait_for("ready")
        talker = Program(pinger("ros1://", 2500, "pinger"), environment)
        talker.finish(LIMIT)
        assert 0 < garbage(board.lines) <= GARBAGE["ros1"], board.lines
    finally:
        board.stop()
        master.stop()


def test_what_a_ros2_message_leaves_is_little(tmp_path: pathlib.Path) -> None:
    made = echo("ros2", tmp_path, rosout=False, program="board_garbage.py")
    with Namespace(tmp_path) as namespace:
        board = namespace.start(*boards.command(made, "16m"), name="board")
        board.wait_for("ready")
        path = {"PYTHONPATH": str(peers.ROOT / "src")}
        talker = namespace.start(*pinger("ros2://", 2500, "pinger"), name="pinger", **path)
        talker.finish(LIMIT)
        assert 0 < garbage(board.lines()) <= GARBAGE["ros2"], board.lines()
