"""kill -9 and return, a hundred times each way; in the end nothing is left of the dead.

The tests are steps of one story: roslet and rclpy live on while others die. A child is forked for each life, from a
program that has imported everything, so that a life takes a moment only.
"""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest

from interop import ros2_exchange as exchange
from interop.ros2_peers import Host, Peer, wait_until

TURNS = 100
# Seconds: the lease of roslet and of Fast DDS is 20.
LEASE = 20.0
# KiB that a process may grow by after the first lives.
ROOM = 6000


class Story:
    def __init__(self, host: Host) -> None:
        self.host = host
        self.survivors = [host.peer("roslet", "survivor"), host.peer("kilted", "witness")]
        self.mortals = {kind: host.peer(kind) for kind in ("roslet", "kilted", "jazzy", "cyclone")}
        for peer in self.survivors:
            peer.ask("subscription", "from", "/from", exchange.STRING, 0, {"depth": 100})
            peer.ask("publisher", "to", "/to", exchange.UINT32, {})
        self.ours = self.survivors[0]
        self.tables: dict[str, int] = {}
        self.process: dict[str, int] = {}

    def settled(self) -> dict[str, int]:
        """Our tables once they have not changed for a second: all that the witness has is known."""
        found: dict[str, int] = {}
        for _ in range(20):
            before, found = found, self.ours.ask("tables")
            if {**before, "objects": 0} == {**found, "objects": 0}:
                break
            time.sleep(1)
        return found

    def lives(self, kind: str, survivors: list[Peer]) -> None:
        """One life of a mortal: each survivor hears it, and is heard by it."""
        mortal = self.mortals[kind]
        pid = mortal.ask("mortal", "mortal_" + kind)
        end = time.monotonic() + 15
        for peer in survivors:
            while peer.ask("last", "from") != [pid]:
                assert time.monotonic() < end, (
                    f"{peer.kind} does not hear the {kind} that has returned: {mortal.log()}"
                )
                peer.ask("publish", "to", 0, 1, 0, 0.01)
        mortal.ask("kill", pid)


@pytest.fixture(scope="module")
def story(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Story]:
    with Host(tmp_path_factory.mktemp("killed")) as host:
        made = Story(host)
        wait_until(lambda: "/witness" in made.ours.ask("nodes"), "the survivors know each other")
        made.tables = made.settled()
        yield made


def test_roslet_may_be_killed_and_return(story: Story) -> None:
    """Two survivors hear it, rclpy among them."""
    for _ in range(TURNS):
        story.lives("roslet", story.survivors)


@pytest.mark.parametrize("kind", ["kilted", "jazzy", "cyclone"])
def test_a_peer_may_be_killed_and_return(story: Story, kind: str) -> None:
    for turn in range(TURNS):
        story.lives(kind, [story.ours])
        if turn == 10:
            story.process = story.ours.ask("process")


def test_when_the_leases_are_over_nothing_is_left_of_the_dead(story: Story) -> None:
    """In our tables, descriptors and memory; and rclpy lists nobody but the survivors."""

    def left() -> dict[str, int]:
        tables: dict[str, int] = story.ours.ask("tables")
        return {name: size - story.tables[name] for name, size in tables.items() if name != "objects"}

    end = time.monotonic() + LEASE + 10
    while any(left().values()):
        assert time.monotonic() < end, f"our tables are not as they were: {left()} more"
    for peer in story.survivors:
        peer.wait(["/survivor", "/witness"], "nodes", patience=LEASE + 10)
    now = story.ours.ask("process")
    assert now["descriptors"] == story.process["descriptors"]
    assert now["memory"] < story.process["memory"] + ROOM
    objects = story.ours.ask("tables")["objects"] - story.tables["objects"]
    assert objects < 2000
    # And the living still talk.
    story.lives("kilted", [story.ours])
