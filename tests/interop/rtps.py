"""String on /chatter between two peers, on the participant itself: what every pair of implementations must do."""

from __future__ import annotations

import pathlib
import sys
from typing import ClassVar

import pytest

import peers
from interop.namespace import Namespace

PROGRAMS = peers.ROOT / "tests/interop/peers"
# Seconds between the samples of every talker.
PAUSE = 0.05


def command(peer: str, role: str, count: int, *words: str) -> list[str]:
    """How a peer is started."""
    if peer == "roslet":
        return [sys.executable, str(PROGRAMS / "roslet_rtps.py"), role, str(count), *words]
    program = "cyclone_rtps.py" if peer == "cyclone" else "rclpy_rtps.py"
    return [str(peers.require(peer)), str(PROGRAMS / program), role, str(count), *words]


def exchange(folder: pathlib.Path, talker: str, listener: str, count: int, *words: str) -> list[str]:
    """What the listener prints; both programs have ended by themselves."""
    with Namespace(folder) as namespace:
        said = namespace.start(*command(talker, "talker", count, *words), name="talker")
        said.wait_for("ready")
        heard = namespace.start(*command(listener, "listener", count, *words), name="listener").finish()
        said.finish()
        return heard


class Exchange:
    """The tests of a file that names who talks and who listens."""

    talker: ClassVar[str]
    listener: ClassVar[str]

    @pytest.mark.parametrize("words", [(), ("transient_local",)])
    def test_every_sample_arrives_in_order(self, tmp_path: pathlib.Path, words: tuple[str, ...]) -> None:
        """Every sample of a reliable topic arrives, once and in order."""
        heard = exchange(tmp_path, self.talker, self.listener, 5, *words)
        assert heard == ["ready"] + [f"heard hello {number}" for number in range(5)]

    @pytest.mark.parametrize("size", [100_000, 10 << 20])
    def test_large_samples_arrive_whole(self, tmp_path: pathlib.Path, size: int) -> None:
        """Samples far larger than a datagram arrive whole."""
        heard = exchange(tmp_path, self.talker, self.listener, 3, str(size))
        assert heard == ["ready"] + [f"heard {size + len('hello 0')}"] * 3

    def test_best_effort_samples_arrive_in_order(self, tmp_path: pathlib.Path) -> None:
        """Best effort on an idle loopback: what arrives is in order, and the last samples do arrive."""
        with Namespace(tmp_path) as namespace:
            namespace.start(*command(self.talker, "talker", 30, "best_effort"), name="talker")
            listener = namespace.start(
                *command(self.listener, "listener", 10, "best_effort"), name="listener"
            )
            heard = listener.finish()
        assert heard[0] == "ready"
        found = [int(line.split()[-1]) for line in heard[1:]]
        assert len(found) >= 10
        assert found == sorted(set(found))
