"""A roslet Context beside real peers: what they see of each other, and calls between them."""

from __future__ import annotations

import pathlib
import signal
import sys
import time

import peers
from interop.namespace import Namespace, Program

PROGRAMS = peers.ROOT / "tests/interop/peers"
STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
ANSWERS = ["answer " + ("yes", "no")[number % 2] for number in range(5)]


def ours(namespace: Namespace, *words: str) -> Program:
    """Our program."""
    return namespace.start(sys.executable, str(PROGRAMS / "roslet_graph.py"), *words, name="ours" + words[0])


def theirs(namespace: Namespace, peer: str, role: str, count: int) -> Program:
    """A peer that serves or calls /ask."""
    program = "cyclone_rmw.py" if peer == "cyclone" else "rclpy_rtps.py"
    return namespace.start(
        str(peers.require(peer)), str(PROGRAMS / program), role, str(count), name=f"{peer}_{role}"
    )


def last(lines: list[str], what: str) -> str | None:
    """The newest of a program's lines of one kind."""
    return next((line for line in reversed(lines) if line.split()[0] == what), None)


def check_graph(folder: pathlib.Path, peer: str) -> None:
    """The peer lists our node, endpoints, QoS and hashes, and we it; a second after the end neither lists the other."""
    with Namespace(folder) as namespace:
        talker = ours(namespace, "talker")
        talker.wait_until(lambda lines: lines, 20, "ready")
        words = ["/robot/ours", "/chatter", "/ask"]
        witness = namespace.start(
            str(peers.require(peer)), str(PROGRAMS / "rclpy_graph.py"), *words, name="witness"
        )
        _, publisher, subscription = talker.lines()[0].split()
        what = f"ours /robot std_msgs/msg/String {STRING_HASH} RELIABLE"
        expected = [
            "nodes /robot/ours /; /witness /",
            f"publishers {what} TRANSIENT_LOCAL {publisher}",
            f"subscriptions {what} VOLATILE {subscription}",
            "types ['std_srvs/srv/SetBool']",
            "of [('/chatter', ['std_msgs/msg/String'])]",
        ]
        witness.wait_until(
            lambda lines: all(last(lines, line.split()[0]) == line for line in expected),
            20,
            "\n".join(expected),
        )
        talker.wait_for("nodes /robot/ours /; /witness /")
        talker.wait_for("subscribed /witnessed")
        begin = time.monotonic()
        talker.process.send_signal(signal.SIGTERM)
        gone = ["nodes /witness /", "publishers ", "subscriptions ", "types None"]
        witness.wait_until(
            lambda lines: all(last(lines, line.split()[0]) == line for line in gone), 20, "\n".join(gone)
        )
        assert time.monotonic() - begin < 1.0
        again = ours(namespace, "server")
        again.wait_for("nodes /robot/ours /; /witness /")
        witness.process.send_signal(signal.SIGTERM)
        again.wait_until(
            lambda lines: last(lines, "nodes") == "nodes /robot/ours /", 5, "the peer's node is gone"
        )


def check_server(folder: pathlib.Path, *clients: str) -> None:
    """Clients, all at once, each get their answers from our server, and nothing else."""
    with Namespace(folder) as namespace:
        server = ours(namespace, "server")
        server.wait_for("ready")
        programs = [theirs(namespace, peer, "client", len(ANSWERS)) for peer in clients]
        for program in programs:
            assert [line for line in program.finish() if line != "ready"] == ANSWERS
        assert len([line for line in server.lines() if line.startswith("asked")]) == len(ANSWERS) * len(
            programs
        )


def check_client(folder: pathlib.Path, peer: str) -> None:
    """Our client gets its answers from a peer's server, which was there before, or comes later."""
    with Namespace(folder) as namespace:
        server = theirs(namespace, peer, "server", 2 * len(ANSWERS))
        server.wait_for("ready")
        for _ in range(2):
            lines = ours(namespace, "client", str(len(ANSWERS))).finish()
            assert [line for line in lines if line.startswith("answer")] == ANSWERS
        server.finish()
        later = ours(namespace, "client", str(len(ANSWERS)))
        later.wait_for("ready")
        theirs(namespace, peer, "server", len(ANSWERS)).wait_for("ready")
        assert [line for line in later.finish() if line.startswith("answer")] == ANSWERS
