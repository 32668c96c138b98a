"""A node in gates with six topics each way, and rclpy at the other side of a TAP device, in its default configuration."""

from __future__ import annotations

import os
import pathlib
import sys

import pytest

import peers
from gateware.tops.many_node import PAIRS
from interop.namespace import Namespace, wait

pytestmark = [
    pytest.mark.skipif(os.geteuid() != 0, reason="only root makes TAP devices"),
    pytest.mark.timeout(400),
]
SECONDS = "300"
"""How long the programs may live; they are ended before."""


@pytest.mark.parametrize("kind", ["kilted", "jazzy"])
def test_rclpy_has_all_of_its_topics_and_each_message_comes_back_on_its_own(
    kind: str, tmp_path: pathlib.Path
) -> None:
    script = str(pathlib.Path(__file__).parent / "many_on_tap.py")
    topics = {way: {f"/{way}{n}": [pair[0]] for n, pair in enumerate(PAIRS)} for way in ("in", "out")}
    with Namespace(tmp_path) as namespace:
        namespace.start(sys.executable, script, SECONDS, name="gates").wait_for("up", 300)
        peer = namespace.start(
            *(str(peers.require(kind)), str(peers.ROOT / "tests/interop/peers/gates_many.py"), SECONDS),
            name=kind,
            FASTDDS_BUILTIN_TRANSPORTS="DEFAULT",
        )
        said = wait(
            peer,
            "ten messages of each topic",
            lambda said: (
                min(map(len, said["got"].values())) >= 10 and said["publishes"] and said["subscribes"]
            ),
        )
    assert (said["publishes"], said["subscribes"]) == (topics["out"], topics["in"])
    for numbers in said["got"].values():
        assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
