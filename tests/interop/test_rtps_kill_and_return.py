"""A peer that is killed without a word and comes back is served again at once, long before its lease is over."""

from __future__ import annotations

import pathlib
import time

import pytest

from interop import rtps
from interop.namespace import Namespace


@pytest.mark.parametrize("peer", ["kilted", "cyclone"])
def test_a_killed_listener_comes_back(tmp_path: pathlib.Path, peer: str) -> None:
    with Namespace(tmp_path) as namespace:
        talker = namespace.start(*rtps.command("roslet", "talker", 400), name="talker")
        for turn in range(3):
            listener = namespace.start(*rtps.command(peer, "listener", 1000), name=f"listener{turn}")
            listener.wait_until(lambda lines: len(lines) > 3, 15, "some samples")
            found = [int(line.split()[-1]) for line in listener.lines()[1:]]
            assert found == list(range(found[0], found[0] + len(found)))
            listener.process.kill()
            listener.process.wait(5)
        assert talker.process.poll() is None


@pytest.mark.parametrize("peer", ["kilted", "cyclone"])
def test_a_killed_talker_comes_back(tmp_path: pathlib.Path, peer: str) -> None:
    with Namespace(tmp_path) as namespace:
        listener = namespace.start(*rtps.command("roslet", "listener", 1000), name="listener")
        listener.wait_for("ready")
        for turn in range(3):
            before = len(listener.lines())
            talker = namespace.start(*rtps.command(peer, "talker", 400), name=f"talker{turn}")
            begin = time.monotonic()
            while len(listener.lines()) < before + 3:
                assert time.monotonic() - begin < 15, talker.errors.read_text()
                time.sleep(0.02)
            assert listener.lines()[before] == "heard hello 0"
            talker.process.kill()
            talker.process.wait(5)
            time.sleep(0.1)
