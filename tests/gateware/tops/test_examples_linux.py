"""The examples that are ROS 2 nodes, by their one command, and real peers at the other side of a TAP device:
`Ros2Ether` with user logic in Verilog, and `RosNode` with ports typed by .msg files."""

from __future__ import annotations

import os
import pathlib
import sys

import pytest

import peers
from interop.namespace import Namespace, Program, wait

pytestmark = [
    pytest.mark.skipif(os.geteuid() != 0, reason="only root makes TAP devices"),
    pytest.mark.timeout(400),
]

SECONDS = 200
"""How long the programs may live; they are ended before."""
EXAMPLES = {
    "topic-pub-sub": ("topic_pub_sub", "std_msgs/msg/String"),
    "imu-node": ("imu_node", "sensor_msgs/msg/Imu"),
}


class Bench:
    """An example on a TAP device in a namespace, and a peer beside it."""

    def __init__(self, namespace: Namespace, example: str) -> None:
        self._namespace = namespace
        command = (sys.executable, "-m", "roslet", "gateware", "sim", example, "--json", "--tap", "tap0")
        self.simulation = namespace.start(*command, "--seconds", str(SECONDS), name="simulation")
        self.simulation.wait_for('{"time": 0.0, "tap": "tap0"}', 200)

    def peer(self, kind: str, *program: str) -> Program:
        """In its default configuration."""
        folder = peers.ROOT / "tests/interop/peers"
        python = str(peers.require(kind))
        return self._namespace.start(
            *(python, str(folder / program[0]), *program[1:], str(SECONDS)),
            name=kind,
            FASTDDS_BUILTIN_TRANSPORTS="DEFAULT",
        )


@pytest.mark.parametrize("kind", ["kilted", "jazzy"])
@pytest.mark.parametrize("example", EXAMPLES)
def test_rclpy_sees_it_hears_it_and_lights_its_leds(example: str, kind: str, tmp_path: pathlib.Path) -> None:
    name, type_ = EXAMPLES[example]
    with Namespace(tmp_path) as namespace:
        bench = Bench(namespace, example)
        peer = bench.peer(kind, "gates_example.py", example)
        said = wait(peer, "ten messages", lambda said: len(said["got"]) >= 10 and name in said["nodes"])
        assert (said["publishers"], said["types"], said["subscribers"]) == ([name], [type_], 1)
        if example == "topic-pub-sub":
            first = int(said["got"][0][-4:])
            assert said["got"] == [f"Message from FPGA - {first + n:04}" for n in range(len(said["got"]))]
        else:  # its types are known where it is generated
            assert said["hashes"] == said["own"] and len(said["own"]) == 1
        wait(bench.simulation, "the LEDs", lambda said: said.get("leds") == 15)


def test_coordinates_of_cyclone_come_back_as_they_were(tmp_path: pathlib.Path) -> None:
    with Namespace(tmp_path) as namespace:
        peer = Bench(namespace, "typed-echo").peer("cyclone", "gates_coordinates.py")
        said = wait(peer, "ten of them", lambda said: len(said["got"]) >= 10)
        assert said["got"] == [[n, n / 4, -n, [-n, 1000 + n]] for n in range(1, len(said["got"]) + 1)]
