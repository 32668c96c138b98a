"""Talkers and listeners on different networks: whether samples get through."""

from __future__ import annotations

import time

from interop import rtps
from interop.namespace import Namespace, Program

# Seconds after both are ready: what has not been heard by then is not going to be. Both announce themselves at once and then
# every three seconds; Fast DDS, which may have missed our first words, at 0.1 s intervals in the beginning.
SILENCE = 4.0


def talk(at: Namespace, peer: str, *words: str, count: int = 3, **environment: str) -> Program:
    """A talker that has begun to look for a listener."""
    talker = at.start(*rtps.command(peer, "talker", count, *words), name="talker", **environment)
    talker.wait_for("ready")
    return talker


def listen(at: Namespace, peer: str, *words: str, count: int = 3, **environment: str) -> Program:
    """A listener that has begun to look for a talker."""
    listener = at.start(*rtps.command(peer, "listener", count, *words), name="listener", **environment)
    listener.wait_for("ready")
    return listener


def check_heard(listener: Program, count: int = 3) -> None:
    """Every sample arrives."""
    assert listener.finish() == ["ready"] + [f"heard hello {number}" for number in range(count)]


def check_silence(*programs: Program) -> None:
    """Nothing arrives, although all still run."""
    time.sleep(SILENCE)
    for program in programs:
        assert program.lines() == ["ready"]
        assert program.process.poll() is None
