"""A Ctrl-C is raised between any two bytecodes of the main thread, also in the midst of a call of the master."""

from __future__ import annotations

import os
import pathlib
import subprocess
import sys
import threading
from collections.abc import Callable
from typing import Any

import pytest

from roslet import Node
from roslet.master.server import MasterServer
from roslet.wire import xmlrpc

SOURCE = str(pathlib.Path(__file__).resolve().parents[2] / "src")


def test_a_node_is_unregistered_though_ctrl_c_came_while_an_answer_was_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole: Callable[[Any], Any] = xmlrpc.parse_response
    interrupted = threading.Event()

    def parse(data: Any) -> Any:
        if threading.current_thread() is threading.main_thread() and not interrupted.is_set():
            interrupted.set()
            raise KeyboardInterrupt
        return whole(data)

    with MasterServer("127.0.0.1", 0) as master:
        with pytest.raises(KeyboardInterrupt), Node("n", network=f"ros1://127.0.0.1:{master.port}") as node:
            node.publisher("chatter", "std_msgs/String")
            monkeypatch.setattr(xmlrpc, "parse_response", parse)
            for _ in range(
                1000
            ):  # until it is this thread that serves the loop, not the one in the background
                node.has_parameter("/x")
        assert interrupted.is_set()
        assert master.call("getSystemState", "/test")[2] == [[], [], []]


STARTS = """
import random, signal, sys, threading, time
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may have had it ignored
import roslet

network, rounds = sys.argv[1], int(sys.argv[2])
chance = random.Random(1)
span = 0.0

def start(name, seconds):
    global span
    begin = time.monotonic()
    with roslet.Node(name, network=network) as node:
        node.subscribe("/in", "std_msgs/String", print)
        node.publisher("/out", "std_msgs/String")
        span = time.monotonic() - begin
        node.spin(seconds)

def interrupt(after):
    time.sleep(after)
    signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)

start("first", 0.05)
start("second", 0.0)
interrupted = 0
for index in range(rounds):
    try:
        threading.Thread(target=interrupt, args=(chance.random() * span,)).start()
        start("n%d" % index, 5.0)
    except KeyboardInterrupt:
        interrupted += 1
    for node in list(roslet.node.node._open_nodes):
        node.close()  # as at exit: it came between the node and its `with`
print(interrupted)
"""


def test_nodes_interrupted_at_any_moment_of_their_start_are_all_unregistered() -> None:
    """Of 1200 such nodes two stayed with the master before Ctrl-C waited for the loop."""
    rounds = 60
    with MasterServer("127.0.0.1", 0) as master:
        child = subprocess.run(
            [sys.executable, "-c", STARTS, f"ros1://127.0.0.1:{master.port}", str(rounds)],
            env={**os.environ, "PYTHONPATH": SOURCE},
            capture_output=True,
            encoding="utf-8",
            timeout=100,
            check=False,
        )
        assert (child.stdout, child.returncode) == (f"{rounds}\n", 0), child.stderr
        assert master.call("getSystemState", "/test")[2] == [[], [], []]
