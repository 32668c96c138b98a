"""Linux programs and the gateware: `roslet gateware sim` with a TAP device in a namespace, in the time of the wall clock."""

from __future__ import annotations

import json
import os
import pathlib
import subprocess
import sys
import textwrap
from collections.abc import Iterator

import pytest

import peers
from gateware.tops.udp_node import OUR_MAC, OURS, PORT, THEIRS
from interop.namespace import Namespace, Program

pytestmark = [
    pytest.mark.skipif(os.geteuid() != 0, reason="only root makes TAP devices"),
    pytest.mark.timeout(300),
]

SECONDS = 60
"""How long the simulation may live; it is ended before."""


class Linux:
    def __init__(self, namespace: Namespace, capture: pathlib.Path) -> None:
        self.namespace = namespace
        self.capture = capture
        command = (sys.executable, "-m", "roslet", "gateware", "sim", "udp-tx-rx", "--json")
        self.simulation: Program = namespace.start(
            *command, "--tap", "tap0", "--pcap", str(capture), "--seconds", str(SECONDS), name="simulation"
        )
        self.simulation.wait_for('{"time": 0.0, "tap": "tap0"}', 200)

    def call(self, *command: str) -> str:
        """What a program printed, which must do well."""
        return "\n".join(self.namespace.start(*command, LC_ALL="C").finish(40))


@pytest.fixture(scope="module")
def linux(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Linux]:
    folder = tmp_path_factory.mktemp("linux")
    with Namespace(folder) as namespace:
        yield Linux(namespace, folder / "wire.pcap")


def test_arping_finds_it(linux: Linux) -> None:
    arping = str(peers.require("arping"))
    assert f"[{OUR_MAC}]" in linux.call(arping, "-I", "tap0", "-c", "2", "-f", OURS)


@pytest.mark.parametrize("size", [0, 56, 1472, 1473, 2952])
def test_it_answers_the_pings_of_linux_in_fragments_too(linux: Linux, size: int) -> None:
    ping = str(peers.require("ping"))
    said = linux.call(ping, "-c", "5", "-i", "0.1", "-W", "5", "-s", str(size), OURS)
    assert "5 received, 0% packet loss" in said


def test_it_answers_a_flood_of_pings(linux: Linux) -> None:
    ping = str(peers.require("ping"))
    assert "300 received, 0% packet loss" in linux.call(ping, "-f", "-c", "300", "-W", "5", OURS)


def test_programs_send_it_datagrams_in_bursts_and_receive_its_own(linux: Linux) -> None:
    program = textwrap.dedent(f"""
        import socket, time
        end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        end.bind(("{THEIRS}", {PORT}))
        end.settimeout(10)
        for size in (1, 5, 10, 15):
            for _ in range(20):
                end.sendto(bytes(size), ("{OURS}", {PORT}))
            time.sleep(0.2)
        for _ in range(3):
            assert end.recvfrom(2000) == (b"UDP Send Test\\n", ("{OURS}", {PORT}))
        print("all")
    """)
    assert linux.call(sys.executable, "-c", program) == "all"
    leds = [one["leds"] for line in linux.simulation.lines() if "leds" in (one := json.loads(line))]
    assert leds == [0b1, 0b11, 0b111, 0b1111]


def test_tshark_finds_nothing_malformed_on_the_wire(linux: Linux) -> None:
    """The last of these tests: it ends the simulation."""
    linux.simulation.process.send_signal(2)
    report = json.loads(linux.simulation.finish(30)[-1])
    assert report["faults"] == {}
    # What the kernel says in IPv6, to groups, and of texts for a port that nobody has.
    assert set(report["dropped"]) <= {"ethernet_address", "ethernet_type", "icmp_type"}
    tshark = str(peers.require("tshark"))
    checks = [f"-o{protocol}.check_checksum:TRUE" for protocol in ("ip", "udp")]
    wrong = (
        "_ws.malformed || ip.checksum.status == 0 || udp.checksum.status == 0 || icmp.checksum.status == 0"
    )
    command = [tshark, "-r", str(linux.capture), *checks]
    ours = f"eth.src == {OUR_MAC}"
    everything = subprocess.run([*command, "-Y", ours], capture_output=True, text=True, check=True).stdout
    assert len(everything.splitlines()) > 300
    found = subprocess.run(
        [*command, "-Y", f"{ours} && ({wrong})"], capture_output=True, text=True, check=True
    )
    assert found.stdout == ""
