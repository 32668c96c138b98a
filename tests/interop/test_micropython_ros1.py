"""A node on MicroPython with roscpp and rospy, both directions, in a heap of 512 KB: user-defined types, an image of 32 KB,
services, parameters, the log; and a peer that is killed and back."""

from __future__ import annotations

import os
import pathlib
import sys
import time
from collections.abc import Iterator

import pytest

import peers
from interop import boards
from interop.namespace import Namespace
from interop.ros1 import Master, Peer, Program, wait_until

HEAP = "512k"
# In a network namespace of a test's own.
MASTER_PORT = "11311"
MASTER_URI = f"http://127.0.0.1:{MASTER_PORT}"
TURNS = 20 if os.environ.get("ROSLET_LONG") else 3


@pytest.fixture(scope="module")
def master(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Master]:
    started = Master("debian", tmp_path_factory.mktemp("board-master"))
    yield started
    started.stop()


@pytest.fixture(scope="module")
def board(master: Master, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Program]:
    made = boards.bundle("ros1", tmp_path_factory.mktemp("board-ros1"))
    environment = {**os.environ, "ROS_MASTER_URI": master.uri, "ROS_IP": "127.0.0.1"}
    program = Program(boards.command(made, HEAP), environment)
    program.wait_for("ready")
    yield program
    assert program.process.poll() is None, program.errors
    program.stop()


@pytest.fixture(scope="module", params=["roscpp", "rospy"])
def peer(request: pytest.FixtureRequest, master: Master, board: Program) -> Iterator[Peer]:
    started = Peer(request.param, master)
    yield started
    started.quit()


def echoed(peer: Peer, type_name: str, topic: str, size: int, count: int) -> None:
    """The peer's messages come back whole and in order."""
    peer.ask(f"advertise {type_name} {topic} 0", f"advertised {topic}")
    peer.ask(f"subscribe {type_name} {topic}_back {size}", f"subscribed {topic}_back")
    wait_until(lambda: peer.subscribers(topic) == 1, "the board subscribes")
    wait_until(lambda: peer.publishers(f"{topic}_back") == 1, "the peer is connected")
    before = len(peer.told(f"got {topic}_back "))
    for i in range(count):
        peer.ask(f"publish {topic} {i} {size}", f"published {topic} {i}")
        peer.wait_for(f"got {topic}_back ", before + i + 1)
    lines = peer.told(f"got {topic}_back ")[before:]
    assert lines == [f"got {topic}_back {i} ok" for i in range(count)]
    peer.ask(f"unadvertise {topic}", f"unadvertised {topic}")
    peer.ask(f"unsubscribe {topic}_back", f"unsubscribed {topic}_back")


def test_coordinates_come_back(peer: Peer) -> None:
    echoed(peer, "mros_comm_measure/Coordinate", "/coordinate", 0, 20)


@pytest.mark.parametrize("size", [-1, 0, 4096])
def test_texts_come_back(peer: Peer, size: int) -> None:
    echoed(peer, "std_msgs/String", "/text", size, 5)


def test_an_image_of_32_kb_comes_back(peer: Peer) -> None:
    echoed(peer, "sensor_msgs/Image", "/image", 32768, 3)


def test_a_latched_message_that_comes_with_the_header_is_heard(peer: Peer) -> None:
    peer.ask("subscribe std_msgs/String /text_back 10", "subscribed /text_back")
    wait_until(lambda: peer.publishers("/text_back") == 1, "the peer is connected")
    before = len(peer.told("got /text_back "))
    peer.ask("advertise std_msgs/String /text 1", "advertised /text")
    peer.ask("publish /text 0 10", "published /text 0")
    peer.wait_for("got /text_back ", before + 1)
    assert peer.told("got /text_back ")[before:] == ["got /text_back 0 ok"]
    peer.ask("unadvertise /text", "unadvertised /text")
    peer.ask("unsubscribe /text_back", "unsubscribed /text_back")


def test_the_peer_calls_the_boards_service(peer: Peer) -> None:
    assert peer.ask("call /scale 5 2.5 0", "called /scale") == "ok"
    failed = peer.ask("call /scale 5 0 0", "called /scale")
    assert failed.startswith("failed") and (peer.kind == "roscpp" or "factor is zero" in failed)


def test_the_board_calls_the_peers_service(peer: Peer, looker: Looker) -> None:
    service = f"/scale_{peer.kind}"
    peer.ask(f"serve {service}", f"serving {service}")
    assert looker.asked(f"call {service}") == "scaled 1 3.0"


class Looker:
    """A rospy program that asks the board, and hears what it says and logs."""

    def __init__(self, master: Master) -> None:
        command = [peers.DEBIAN_PYTHON, boards.PROGRAMS / "rospy_board.py"]
        self.program = Program(command, master.environment())
        self.program.wait_for("ready")

    def asked(self, words: str) -> str:
        """What the board says to a request."""
        before = len(self.program.told("said "))
        self.program.say(words)
        return self.program.wait_for("said ", before + 1)[before].partition(" ")[2]


@pytest.fixture(scope="module")
def looker(master: Master, board: Program) -> Iterator[Looker]:
    peers.require("rospy")
    started = Looker(master)
    yield started
    started.program.stop()


def test_rospy_sees_parameters_topics_and_the_log(looker: Looker) -> None:
    program = looker.program
    program.say("param /board/mood")
    assert program.wait_for("param ") == ["param calm"]
    program.say("set /elsewhere 7")
    program.wait_for("set")
    assert looker.asked("get /elsewhere") == "7"
    assert looker.asked("watch /elsewhere") == "watching"
    before = len(program.told("said "))
    program.say("set /elsewhere 8")
    assert program.wait_for("said ", before + 1)[before] == "said changed 8"
    program.say("topics")
    assert "('/beat', 'std_msgs/UInt32')" in program.wait_for("topics ")[0]
    program.say("log hot")
    program.wait_for("logged /board 4 hot")


def test_a_peer_is_killed_and_back(board: Program, master: Master) -> None:
    for _ in range(TURNS):
        mortal = Peer("rospy", master)
        mortal.ask("advertise mros_comm_measure/Coordinate /coordinate 0", "advertised /coordinate")
        mortal.ask("subscribe mros_comm_measure/Coordinate /coordinate_back 0", "subscribed /coordinate_back")
        wait_until(lambda mortal=mortal: mortal.subscribers("/coordinate") == 1, "the board subscribes")  # type: ignore[misc]
        wait_until(lambda mortal=mortal: mortal.publishers("/coordinate_back") == 1, "connected")  # type: ignore[misc]
        mortal.say("publish /coordinate 0 0")
        assert mortal.wait_for("got /coordinate_back ") == ["got /coordinate_back 0 ok"]
        mortal.process.kill()
        mortal.process.wait()
        time.sleep(0.1)
    assert board.process.poll() is None


ASKER = """
import roslet

with roslet.Node("asker", network="ros1://") as node:
    text = node.publisher("text", "std_msgs/String")
    node.subscribe("text_back", "std_msgs/String", lambda message: print(message.data, flush=True))
    text.wait_for_subscribers(1, 20.0)
    print("ready", flush=True)
    numbers = iter(range(1000))
    node.timer(0.1, lambda: text.publish(data=str(next(numbers))))
    node.spin(90.0)
"""


def test_the_network_is_gone_and_back(tmp_path: pathlib.Path) -> None:
    made = boards.bundle("ros1", tmp_path)
    ours = {"PYTHONPATH": str(peers.ROOT / "src"), "ROS_MASTER_URI": MASTER_URI, "ROS_IP": "127.0.0.1"}
    with Namespace(tmp_path, route=False) as namespace:
        master = namespace.start(
            sys.executable, "-m", "roslet", "master", "--port", MASTER_PORT, name="master", **ours
        )
        master.wait_until(bool, 30.0, "where it is")
        board = namespace.start(*boards.command(made, HEAP), name="board", **ours)
        board.wait_for("ready")
        asker = namespace.start(sys.executable, "-c", ASKER, name="asker", **ours)
        asker.wait_for("ready")
        for _ in range(TURNS):
            namespace.run("ip link set lo down")
            time.sleep(1.0)
            before = len(asker.lines())
            namespace.run("ip link set lo up")
            asker.wait_until(lambda lines, before=before: len(lines) > before + 5, 30.0, "answers come again")
        numbers = [int(line) for line in asker.lines()[1:]]
        assert numbers == sorted(set(numbers))
        assert board.process.poll() is None and master.process.poll() is None
