"""tshark watches two of roslet's nodes: goals, calls, parameters, fragments. It finds nothing wrong in what they say."""

from __future__ import annotations

import pathlib
import subprocess
import sys
import time

import peers
from interop.namespace import Namespace, Program

PROGRAMS = peers.ROOT / "tests/interop/peers"
TYPES = peers.ROOT / "tests/compat/programs/rclpy/ws/test_msgs"

LARGE = """
import roslet
qos = roslet.QoS(durability="transient_local")
with roslet.Node("large") as node:
    publisher = node.publisher("large", "std_msgs/String", qos=qos)
    publisher.publish(data="x" * 300000)
    print("published", flush=True)
    node.spin()
"""

HEAR = """
import roslet
qos = roslet.QoS(durability="transient_local")
with roslet.Node("hears") as node:
    subscription = node.subscribe("large", "std_msgs/String", qos=qos)
    print(len(subscription.take(20).data))
"""


def _watch(namespace: Namespace, file: pathlib.Path) -> Program:
    """A running tshark that already writes to `file`."""
    program = str(peers.require("tshark"))
    watcher = namespace.start(program, "-q", "-i", "lo", "-f", "udp", "-w", str(file), name="tshark")
    end = time.monotonic() + 20.0
    while "Capturing on" not in watcher.errors.read_text() or not file.exists():
        assert watcher.process.poll() is None and time.monotonic() < end, watcher.errors.read_text()
        time.sleep(0.05)
    return watcher


def _fields(file: pathlib.Path, *names: str) -> list[list[str]]:
    """Of each packet."""
    program = str(peers.require("tshark"))
    wanted = [argument for name in names for argument in ("-e", name)]
    command = [program, "-r", str(file), "-T", "fields", *wanted]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    return [line.split("\t") for line in done.stdout.splitlines()]


def test_tshark_finds_nothing_malformed_in_what_nodes_say(tmp_path: pathlib.Path) -> None:
    file = tmp_path / "nodes.pcap"
    tasks = [sys.executable, str(PROGRAMS / "roslet_tasks.py")]
    with Namespace(tmp_path) as namespace:
        watcher = _watch(namespace, file)
        namespace.start(*tasks, "serve", str(TYPES), name="server").wait_for("serving")
        assert namespace.start(*tasks, "ask", str(TYPES), name="client").finish(90.0)[0] == "server True"
        namespace.start(sys.executable, "-c", LARGE, name="large").wait_for("published")
        assert namespace.start(sys.executable, "-c", HEAR, name="hears").finish() == ["300000"]
        time.sleep(1.0)  # the kernel hands packets to the watcher in batches
        watcher.process.terminate()
        watcher.process.wait(10)
    packets = _fields(
        file, "frame.protocols", "_ws.malformed", "_ws.expert.message", "rtps.sm.id", "rtps.param.id"
    )
    assert len(packets) > 100
    kinds: set[int] = set()
    parameters: set[str] = set()
    for protocols, malformed, expert, ids, parameter in packets:
        assert "rtps" in protocols, protocols
        assert (malformed, expert) == ("", "")
        kinds.update(int(one, 16) for one in ids.split(",") if one)
        parameters.update(parameter.split(","))
    # DATA, DATA_FRAG, HEARTBEAT, ACKNACK, INFO_TS, INFO_DST
    assert kinds >= {0x15, 0x16, 0x07, 0x06, 0x09, 0x0E}, kinds
    assert {"0x0083", "0x800f"} <= parameters, (
        parameters
    )  # of a reply: which request it is for, in both spellings
