"""Nodes in gates that send back what comes, with six topics each way and with the longest messages, and rclpy at the other
side of a TAP device, in its default configuration."""

from __future__ import annotations

import os
import pathlib
import sys

import pytest

import peers
from gateware.tops.echo_nodes import PAIRS
from interop.namespace import Namespace, wait
from roslet.gateware.tops.ros_node import MAX_MESSAGE

pytestmark = [
    pytest.mark.skipif(os.geteuid() != 0, reason="only root makes TAP devices"),
    pytest.mark.timeout(400),
]
SECONDS = "300"
"""How long the programs may live; they are ended before."""


class Bench:
    """A node of `echo_nodes` on a TAP device in a namespace, and rclpy beside it."""

    def __init__(self, namespace: Namespace, design: str, kind: str, program: str) -> None:
        script = str(pathlib.Path(__file__).parent / "echo_on_tap.py")
        namespace.start(sys.executable, script, design, SECONDS, name="gates").wait_for("up", 300)
        self.peer = namespace.start(
            *(str(peers.require(kind)), str(peers.ROOT / "tests/interop/peers" / program), SECONDS),
            name=kind,
            FASTDDS_BUILTIN_TRANSPORTS="DEFAULT",
        )


@pytest.mark.parametrize("kind", ["kilted", "jazzy"])
def test_rclpy_has_all_of_its_topics_and_each_message_comes_back_on_its_own(
    kind: str, tmp_path: pathlib.Path
) -> None:
    topics = {way: {f"/{way}{n}": [pair[0]] for n, pair in enumerate(PAIRS)} for way in ("in", "out")}
    with Namespace(tmp_path) as namespace:
        said = wait(
            Bench(namespace, "many", kind, "gates_many.py").peer,
            "ten messages of each topic",
            lambda said: (
                min(map(len, said["got"].values())) >= 10 and said["publishes"] and said["subscribes"]
            ),
        )
    assert (said["publishes"], said["subscribes"]) == (topics["out"], topics["in"])
    for numbers in said["got"].values():
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))


@pytest.mark.parametrize("kind", ["kilted", "jazzy"])
def test_the_longest_messages_of_rclpy_come_back_as_they_were(kind: str, tmp_path: pathlib.Path) -> None:
    longest = MAX_MESSAGE - 5  # the text of a message: before it its length, behind it a NUL
    with Namespace(tmp_path) as namespace:
        peer = Bench(namespace, "longest", kind, "gates_longest.py").peer
        said = wait(peer, "the longest of all", lambda said: longest in said["same"])
    assert said == {"same": list(range(longest - 10, longest + 1)), "other": []}
