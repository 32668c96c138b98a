"""Real peers and the node in gates, over a TAP device in a namespace of their own, in their default configuration."""

from __future__ import annotations

import os
import pathlib
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import peers
from interop.namespace import PATIENCE, Namespace, Program, last, wait

pytestmark = [
    pytest.mark.skipif(os.geteuid() != 0, reason="only root makes TAP devices"),
    pytest.mark.timeout(400),
]

HERE = pathlib.Path(__file__).parent
SECONDS = 900
"""How long a simulation may live; it is ended before."""
PROGRAMS = {"kilted": "gates_rclpy.py", "jazzy": "gates_rclpy.py", "cyclone": "gates_cyclone.py"}


class Gates:
    """The node, in a namespace in which peers may be started."""

    def __init__(self, folder: pathlib.Path) -> None:
        self.namespace = Namespace(folder)
        self.capture = folder / "wire.pcap"
        self.peers: list[Program] = []

    def __enter__(self) -> Gates:
        self.namespace.__enter__()
        self.program = self.namespace.start(
            sys.executable, str(HERE / "on_tap.py"), str(SECONDS), "pcap", str(self.capture), name="gates"
        )
        self.program.wait_for("up", 300)
        return self

    def __exit__(self, *error: Any) -> None:
        self.namespace.__exit__(*error)

    def peer(self, kind: str, name: str, *mode: str, seconds: float = 120.0) -> Program:
        program = self.namespace.start(
            str(peers.require(kind)),
            str(peers.ROOT / "tests/interop/peers" / PROGRAMS[kind]),
            name,
            str(seconds),
            *mode,
            name=f"{kind}-{name}",
            FASTDDS_BUILTIN_TRANSPORTS="DEFAULT",
        )
        self.peers.append(program)
        return program

    def status(self) -> dict[str, Any]:
        return last(self.program)

    def captured(self, which: str, *fields: str) -> list[list[str]]:
        """Of the frames so far, which tshark's filter `which` lets pass, these fields."""
        command = [str(peers.require("tshark")), "-r", str(self.capture), "-Y", which]
        command += ["-o", "udp.check_checksum:TRUE", "-T", "fields", "-E", "separator=|"]
        self.program.process.send_signal(signal.SIGSTOP)
        try:
            done = subprocess.run(
                command + [part for field in fields for part in ("-e", field)],
                capture_output=True,
                text=True,
                timeout=120,
                check=False,
            )
        finally:
            self.program.process.send_signal(signal.SIGCONT)
        return [line.split("|") for line in done.stdout.splitlines()]

    def wait(
        self, what: str, seen: Callable[[dict[str, Any]], bool], seconds: float = PATIENCE
    ) -> dict[str, Any]:
        return wait(self.program, what, seen, seconds)


@pytest.fixture(scope="module")
def gates(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Gates]:
    with Gates(tmp_path_factory.mktemp("gates")) as found:
        yield found


@pytest.fixture
def alone(gates: Gates) -> Iterator[Gates]:
    """The node, and nobody else: whom a test starts ends with it."""
    gates.wait("nobody is there", lambda said: said["alive"] == 0, 90)
    yield gates
    for program in gates.peers:
        if program.process.poll() is None:
            program.process.send_signal(signal.SIGINT)
            program.process.wait(30)
    gates.peers.clear()


def end(program: Program) -> None:
    program.process.send_signal(signal.SIGINT)
    program.process.wait(30)


@pytest.mark.parametrize("kind", sorted(PROGRAMS))
def test_messages_pass_both_ways(alone: Gates, kind: str) -> None:
    before = alone.status()["count"]
    peer = alone.peer(kind, "peer")
    said = wait(peer, "ten messages", lambda said: len(said["got"]) >= 10, 60)
    got = said["got"]
    assert got == list(range(got[0], got[0] + len(got))), "none is missing, none comes twice"
    now = alone.wait("messages of the peer", lambda said: said["count"] >= before + 5)
    assert 1000 < now["received"] < 2000
    assert said["subscribers"] == 1
    end(peer)
    alone.wait("it notices that the peer has gone", lambda said: said["alive"] == 0, 10)


@pytest.mark.parametrize("kind", ["kilted", "jazzy"])
def test_the_node_is_in_the_graph_with_its_endpoints_and_their_types(alone: Gates, kind: str) -> None:
    peer = alone.peer(kind, "watcher")
    said = wait(
        peer, "the node", lambda said: "counter" in said["nodes"] and said["publishers"] == ["counter"], 60
    )
    assert said["hashes"] == said["own"] != [], "of the type, as the peer has it for its own publisher"


def test_several_peers_of_all_kinds_at_once(alone: Gates) -> None:
    kinds = ("kilted", "jazzy", "cyclone", "kilted", "jazzy")
    programs = [alone.peer(kind, f"{kind}{n}") for n, kind in enumerate(kinds)]
    for program in programs:
        got = wait(program, "ten messages", lambda said: len(said["got"]) >= 10, 90)["got"]
        assert got == list(range(got[0], got[0] + len(got)))
    said = alone.wait("all of them", lambda said: said["alive"] >= 5 and said["matched"] >= 10)
    assert said["alive"] <= 8


def test_two_of_cyclone_get_messages_together_by_the_group(alone: Gates) -> None:
    by_group = "ip.src == 192.168.1.100 && ip.dst == 239.255.0.1 && udp.dstport == 7401 && rtps.sm.id == 0x15"
    before = len(alone.captured(by_group, "frame.number"))
    programs = [alone.peer("cyclone", f"cyclone{n}") for n in range(2)]
    alone.wait("both", lambda said: said["matched"] >= 4)
    sent = alone.status()["sent"]
    for program in programs:
        got = wait(program, "ten more", lambda said: (said["got"] or [0])[-1] >= sent + 10, 60)["got"]
        assert got == list(range(got[0], got[0] + len(got)))
    end = time.monotonic() + PATIENCE  # until the capture has been written that far
    while len(alone.captured(by_group, "frame.number")) < before + 10:
        assert time.monotonic() < end, "they are by themselves"
        time.sleep(1.0)


def test_a_full_table_keeps_whom_it_has(alone: Gates) -> None:
    peer = alone.peer("cyclone", "many", "many")
    alone.wait("it is full", lambda said: said["alive"] == 8)
    got = wait(peer, "messages", lambda said: len(said["got"]) >= 60, 60)["got"]
    assert got == list(range(got[0], got[0] + len(got))), "it does not stop for those who come"
    assert alone.status()["alive"] == 8, "of ten"


def test_fifty_peers_come_and_go_one_after_another(alone: Gates) -> None:
    peer = alone.peer("cyclone", "again", "again", seconds=200)
    said = wait(peer, "fifty arrivals", lambda said: said["came"] >= 50, 180)
    assert said["came"] >= 50
    end(peer)
    alone.wait("nobody is left", lambda said: said["alive"] == 0 and said["matched"] == 0, 15)


@pytest.mark.parametrize("kind", ["kilted", "jazzy"])
def test_a_subscription_that_wants_what_was_before_it_is_not_matched(alone: Gates, kind: str) -> None:
    peer = alone.peer(kind, "latched", "latched")
    said = wait(peer, "the publisher", lambda said: said["publishers"] == ["counter"] and said["unmet"], 60)
    assert said["unmet"] == ["DURABILITY"]
    time.sleep(2.0)
    assert last(peer)["got"] == [] and alone.status()["matched"] == 2, "its publisher, and the graph"


def test_a_killed_peer_expires(alone: Gates) -> None:
    peer = alone.peer("kilted", "victim")
    wait(peer, "a message", lambda said: len(said["got"]) >= 1, 60)
    peer.process.kill()
    said = alone.wait("its lease of 20 s is over", lambda said: said["alive"] == 0, 60)
    assert said["matched"] == 0


def test_a_node_that_falls_silent_is_forgotten_and_found_again(alone: Gates) -> None:
    peer = alone.peer("jazzy", "patient", seconds=180)
    wait(peer, "the node", lambda said: "counter" in said["nodes"] and said["got"], 60)
    alone.program.process.send_signal(signal.SIGUSR1)
    wait(peer, "it is forgotten", lambda said: "counter" not in said["nodes"], 60)
    before = len(last(peer)["got"])
    alone.program.process.send_signal(signal.SIGUSR2)
    said = wait(
        peer, "it is back", lambda said: "counter" in said["nodes"] and len(said["got"]) >= before + 5, 60
    )
    assert said["publishers"] == ["counter"]


def test_what_the_node_sent_is_well_formed(alone: Gates) -> None:
    lines = alone.captured("ip.src == 192.168.1.100", "_ws.malformed", "_ws.expert.message")
    assert len(lines) > 100
    assert [line for line in lines if line[0] or re.search("hecksum|alformed", line[1])] == []
