"""A node on MicroPython with rclpy on Fast DDS and with CycloneDDS, both directions, in a heap of 1 MB: user-defined
types, an image of 32 KB, services, parameters, the log; and a peer that is killed and back."""

from __future__ import annotations

import os
import pathlib
import time
from collections.abc import Iterator

import pytest

import peers
from interop import boards
from interop.namespace import Program
from interop.ros2_exchange import STRING, UINT32
from interop.ros2_peers import Host, Peer, wait_until
from roslet.bundle.build import Bundle

HEAP = "1m"
TURNS = 20 if os.environ.get("ROSLET_LONG") else 3
IMAGE = "sensor_msgs/msg/Image"
COORDINATE = "mros_comm_measure/msg/Coordinate"


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Host]:
    with Host(tmp_path_factory.mktemp("board-host")) as started:
        yield started


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Bundle:
    return boards.bundle("ros2", tmp_path_factory.mktemp("board-ros2"))


@pytest.fixture(scope="module")
def board(host: Host, made: Bundle) -> Iterator[Program]:
    program = host.namespace.start(*boards.command(made, HEAP), name="board")
    program.wait_for("ready")
    yield program
    assert program.process.poll() is None, program.errors.read_text()


@pytest.fixture(scope="module", params=["kilted", "cyclone"])
def peer(request: pytest.FixtureRequest, host: Host, board: Program) -> Iterator[Peer]:
    started = host.peer(request.param, "peer_" + request.param)
    yield started
    started.quit()


def echoed(peer: Peer, type_name: str, topic: str, size: int, count: int) -> None:
    """The peer's messages come back whole and in order."""
    back = topic + "_back"
    peer.ask("subscription", back, back, type_name, size, {})
    peer.ask("publisher", topic, topic, type_name, {})
    peer.wait(1, "matched", topic)
    peer.wait(1, "matched", back)
    for i in range(count):
        peer.ask("publish", topic, i, 1, size, 0.0)
        peer.wait([list(range(i + 1)), []], "heard", back)
    peer.ask("close", topic)
    peer.ask("close", back)


@pytest.mark.parametrize("size", [-1, 8, 4096])
def test_texts_come_back(peer: Peer, size: int) -> None:
    echoed(peer, STRING, "/text", size, 5)


def test_an_image_of_32_kb_comes_from_the_board(peer: Peer) -> None:
    peer.ask("subscription", "image", "/image", IMAGE, 32768, {})
    peer.ask("publisher", "want", "/want_image", UINT32, {})
    peer.wait(1, "matched", "image")
    peer.wait(1, "matched", "want")
    for i in range(3):
        peer.ask("publish", "want", i, 1, 0, 0.0)
        peer.wait([list(range(i + 1)), []], "heard", "image")
    for one in ("image", "want"):
        peer.ask("close", one)


def test_coordinates_come_back(host: Host, board: Program) -> None:
    """Of CycloneDDS, which has the type by hand; the wheels of rclpy have no generator for a type of our own."""
    cyclone = host.peer("cyclone", "coordinates")
    echoed(cyclone, COORDINATE, "/coordinate", 0, 20)
    cyclone.quit()


def test_the_peer_calls_the_boards_service(peer: Peer) -> None:
    peer.ask("client", "set", "/set", "std_srvs/srv/SetBool")
    peer.wait(True, "ready", "set")
    assert peer.ask("call", "set", 0, 10, 0, 10.0) == []
    peer.ask("close", "set")


def test_the_board_calls_the_peers_service(peer: Peer) -> None:
    peer.ask("service", "served", "/served", "std_srvs/srv/SetBool")
    peer.ask("subscription", "right", "/right", UINT32, 0, {})
    peer.ask("publisher", "ask", "/ask", UINT32, {})
    peer.wait(1, "matched", "ask")
    peer.wait(1, "matched", "right")
    peer.ask("publish", "ask", 7, 1, 0, 0.0)
    peer.wait([[7], []], "heard", "right")
    for one in ("served", "right", "ask"):
        peer.ask("close", one)


def test_parameters_and_the_log_reach_rclpy(host: Host, board: Program) -> None:
    looker = host.namespace.start(
        str(peers.require("kilted")), str(boards.PROGRAMS / "rclpy_board.py"), name="looker"
    )
    assert looker.finish() == [
        "names ['speed', 'use_sim_time']",
        "speed 1.5",
        "range 10.0",
        "refused False",
        "taken True",
        "log [(30, 'speed is 2.5')]",
    ]


def test_a_peer_is_killed_and_back(host: Host, board: Program) -> None:
    mortals = host.peer("cyclone")
    for _ in range(TURNS):
        pid = mortals.ask("mortal", "mortal")
        mortals.ask("kill", pid)
    after = host.peer("cyclone", "after")
    echoed(after, STRING, "/text", 8, 5)
    after.quit()


def test_a_node_lives_beside_other_tasks_of_asyncio(host: Host, tmp_path: pathlib.Path) -> None:
    made = boards.bundle("ros2", tmp_path, peers.ROOT / "examples/micropython/tasks.py")
    tasks = host.namespace.start(*boards.command(made, "1m"), name="tasks")
    peer = host.peer("cyclone", "beside")
    peer.ask("subscription", "count", "/count", UINT32, 0, {})
    peer.ask("publisher", "chatter", "/chatter", STRING, {})
    peer.wait(1, "matched", "chatter")
    peer.wait(1, "matched", "count")
    peer.ask("publish", "chatter", 7, 3, 12, 0.0)
    tasks.wait_until(lambda lines: [line[:1] for line in lines] == ["7", "8", "9"], 10.0, "three messages")
    before, wrong = peer.ask("heard", "count")
    assert wrong == []
    wait_until(lambda: len(peer.ask("heard", "count")[0]) >= len(before) + 2, "it goes on counting")
    numbers = peer.ask("heard", "count")[0]
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    peer.quit()


def test_the_network_is_gone_and_back(made: Bundle, tmp_path: pathlib.Path) -> None:
    with Host(tmp_path) as host:
        board = host.namespace.start(*boards.command(made, HEAP), name="board")
        board.wait_for("ready")
        peer = host.peer("cyclone", "constant")
        peer.ask("subscription", "text_back", "/text_back", STRING, 8, {})
        peer.ask("publisher", "text", "/text", STRING, {})
        peer.wait(1, "matched", "text")
        peer.wait(1, "matched", "text_back")
        for turn in range(TURNS):
            host.namespace.run("ip link set lo down")
            peer.ask("publish", "text", turn, 1, 8, 0.0)
            time.sleep(1.0)
            host.namespace.run(
                "ip link set lo up && ip link set lo multicast on && ip route replace 239.0.0.0/8 dev lo"
            )
            peer.wait([list(range(turn + 1)), []], "heard", "text_back")
        assert board.process.poll() is None
        peer.quit()


LATE = """
import roslet

node = roslet.Node("late", network="ros2://")
early = node.publisher("early", "std_msgs/msg/UInt32")
print("ready")
node.spin_until(lambda: early.subscriber_count, 20.0)
node.spin(1.0)
node.subscribe("text", "std_msgs/msg/String", lambda message: print(message.data[0]))
print("subscribed")
node.spin()
"""


@pytest.fixture(scope="module")
def late_node(tmp_path_factory: pytest.TempPathFactory) -> Bundle:
    folder = tmp_path_factory.mktemp("late")
    (folder / "late.py").write_text(LATE)
    return boards.bundle("ros2", folder / "bundle", folder / "late.py")


@pytest.mark.parametrize("kind", ["kilted", "cyclone", "roslet"])
def test_a_topic_that_is_named_late_finds_who_was_there(
    kind: str, late_node: Bundle, tmp_path: pathlib.Path
) -> None:
    """What peers announced of it was not kept: they are asked again."""
    with Host(tmp_path) as host:
        peer = host.peer(kind, "early_bird")
        peer.ask("publisher", "text", "/text", STRING, {})
        peer.ask("subscription", "early", "/early", UINT32, 0, {})
        late = host.namespace.start(*boards.command(late_node, "1m"), name="late")
        late.wait_for("subscribed")
        peer.wait(1, "matched", "text")
        peer.ask("publish", "text", 5, 1, 8, 0.0)
        late.wait_until(lambda lines: lines[-1] == "5", 10.0, "the message")
        peer.quit()
