"""String on /chatter between two peers, on the participant itself: what every pair of implementations must do."""

from __future__ import annotations

import pathlib
import sys

import peers
from interop.namespace import Namespace, Program

PROGRAMS = peers.ROOT / "tests/interop/peers"


def command(peer: str, role: str, count: int, *words: str) -> list[str]:
    """How a peer is started."""
    if peer == "roslet":
        return [sys.executable, str(PROGRAMS / "roslet_rtps.py"), role, str(count), *words]
    program = "cyclone_rtps.py" if peer == "cyclone" else "rclpy_rtps.py"
    return [str(peers.require(peer)), str(PROGRAMS / program), role, str(count), *words]


def exchange(
    folder: pathlib.Path, talker: str, listener: str, count: int, *words: str, late: bool = False
) -> tuple[Program, Program]:
    """Both programs, ended; `late`: the listener starts after the samples were written."""
    with Namespace(folder) as namespace:
        said = namespace.start(*command(talker, "talker", count, *words), name="talker")
        if not late:
            said.wait_for("ready")
        heard = namespace.start(*command(listener, "listener", count, *words), name="listener")
        heard.finish()
        said.finish()
        return said, heard


def check_text(folder: pathlib.Path, talker: str, listener: str, *words: str) -> None:
    """Every sample of a reliable topic arrives, once and in order."""
    _, heard = exchange(folder, talker, listener, 5, *words)
    assert heard.lines() == ["ready"] + [f"heard hello {number}" for number in range(5)]


def check_large(folder: pathlib.Path, talker: str, listener: str, size: int) -> None:
    """Samples far larger than a datagram arrive whole."""
    _, heard = exchange(folder, talker, listener, 3, str(size))
    assert heard.lines() == ["ready"] + [f"heard {size + len('hello 0')}"] * 3


def check_best_effort(folder: pathlib.Path, talker: str, listener: str) -> None:
    """Best effort on an idle loopback: what arrives is in order, and the last samples do arrive."""
    with Namespace(folder) as namespace:
        namespace.start(*command(talker, "talker", 30, "best_effort"), name="talker")
        heard = namespace.start(*command(listener, "listener", 10, "best_effort"), name="listener").finish()
    assert heard[0] == "ready"
    found = [int(line.split()[-1]) for line in heard[1:]]
    assert len(found) >= 10
    assert found == sorted(set(found))
