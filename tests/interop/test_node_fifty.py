"""Fifty roslet participants on one domain, beside rclpy Kilted and Jazzy and CycloneDDS."""

from __future__ import annotations

import pathlib

from interop import ros2_exchange as exchange
from interop.ros2_peers import Host, wait_until

PROCESSES, EACH = 5, 10
FIFTY = PROCESSES * EACH


def test_fifty_participants_and_real_ones_all_hear_each_other(tmp_path: pathlib.Path) -> None:
    with Host(tmp_path) as host:
        others = [host.peer(kind, kind) for kind in ("kilted", "jazzy", "cyclone")]
        for peer in others:
            peer.ask("subscription", "in", "/crowd", exchange.UINT32, 0, {"depth": 200})
            peer.ask("publisher", "out", "/crowd", exchange.UINT32, {"depth": 200})
        crowds = [host.peer("roslet", f"crowd{k}") for k in range(PROCESSES)]
        for k, crowd in enumerate(crowds):
            crowd.tell("crowd", EACH * k, EACH)
        for crowd in crowds:
            crowd.answer(60)
        everybody = FIFTY + len(others)
        for crowd in crowds:
            crowd.wait([everybody - 1], "crowd_matched", patience=60)
        for peer in others:
            peer.wait(everybody, "matched", "in", patience=60)
            peer.wait(everybody, "matched", "out", patience=60)
        for crowd in crowds:
            crowd.tell("crowd_publish")
        for k, peer in enumerate(others):
            peer.tell("publish", "out", 1000 + k, 1, 0, 0.0)
        for peer in (*crowds, *others):
            peer.answer(60)
        said = [*range(FIFTY), *range(1000, 1000 + len(others))]
        for k, crowd in enumerate(crowds):
            expected = [[one for one in said if one != EACH * k + i] for i in range(EACH)]
            crowd.wait(expected, "crowd_heard", patience=60)
        for peer in others:
            wait_until(lambda peer=peer: sorted(peer.ask("heard", "in")[0]) == said, f"{peer.kind} hears all")  # type: ignore[misc]
        # The graph: everybody's nodes, a participant for each, and then none of them.
        names = (
            {f"/crowd_{i}" for i in range(FIFTY)}
            | {f"/crowd{k}" for k in range(PROCESSES)}
            | {"/kilted", "/jazzy"}
        )
        for peer in others[:2]:
            wait_until(lambda peer=peer: set(peer.ask("nodes")) == names, f"{peer.kind} lists all nodes")  # type: ignore[misc]
        assert others[2].ask("participants") == FIFTY + PROCESSES + 3
        assert crowds[0].ask("tables")["remotes"] == FIFTY + PROCESSES + 3 - 1
        for crowd in crowds:
            crowd.ask("crowd_close")
        for peer in others[:2]:
            wait_until(lambda peer=peer: len(peer.ask("nodes")) == PROCESSES + 2, f"{peer.kind} forgets")  # type: ignore[misc]
            peer.wait([2 + 1, 2 + 1], "counts", "/crowd")
