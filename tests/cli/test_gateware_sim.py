"""`roslet gateware sim`, as a process."""

from __future__ import annotations

import json
import pathlib
import subprocess
import sys

import pytest


def sim(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "roslet", "gateware", "sim", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=390, check=False)


@pytest.mark.timeout(300)
def test_the_example_hears_and_is_heard_and_all_is_told(tmp_path: pathlib.Path) -> None:
    done = sim("udp-tx-rx", "--seconds", "3.2", "--pcap", str(tmp_path / "wire.pcap"))
    assert (done.returncode, done.stderr) == (0, "compiling the design, unless that was done before\n")
    assert "LEDs  LD4 *  LD5 *  LD6 .  LD7 ." in done.stdout
    assert "b'UDP Send Test\\n' from 192.168.1.100:1234" in done.stdout
    assert "faults: none\ndropped: none\n" in done.stdout
    assert (tmp_path / "wire.pcap").stat().st_size > 1000


@pytest.mark.timeout(300)
def test_as_json_and_with_losses_that_a_seed_repeats() -> None:
    runs = [sim("udp-tx-rx", "--seconds", "2.2", "--json", "--loss", "0.5", "--seed", "3") for _ in range(2)]
    lines = [[json.loads(line) for line in done.stdout.splitlines()] for done in runs]
    assert lines[0][:-1] == lines[1][:-1]
    assert lines[0][-1]["frames"] == lines[1][-1]["frames"]
    assert lines[0][-1]["cycles"] == 440_000


@pytest.mark.timeout(400)
def test_coordinates_come_back_from_a_node_in_gates_as_they_were() -> None:
    done = sim("typed-echo", "--seconds", "4", "--json")
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    sent, received = (
        [line[key] for line in lines if key in line and "time" in line] for key in ("sent", "received")
    )
    assert done.returncode == 0, done.stderr
    assert len(sent) >= 5
    assert sent[0] == [1.0, 0.25, -1.0]
    assert received == sent[: len(received)]
    assert len(received) >= len(sent) - 1  # the last one may be on its way
    assert (lines[-1]["altered"], lines[-1]["faults"]) == (0, {})


@pytest.mark.timeout(400)
def test_a_sensor_in_gates_tells_its_measurements_one_after_the_other_and_takes_velocities() -> None:
    done = sim("imu-node", "--seconds", "4", "--json")
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    measured = [line["received"] for line in lines if "received" in line and "time" in line]
    assert done.returncode == 0, done.stderr
    assert (
        len(measured) >= 8
    )  # 1,000 a second of the node's own time, of which a second of the wire has a 250th
    for kind, (frame, turn, force) in enumerate(measured):
        before = measured[kind - 1] if kind else (frame, turn - 2.0**-20, force - 2.0**-17)
        assert (frame, turn - before[1], force - before[2]) == ("imu", 2.0**-20, 2.0**-17), kind
    assert [line["leds"] for line in lines if "leds" in line][:3] == [15, 0, 15]


def test_an_unknown_example_is_named() -> None:
    done = sim("nothing")
    assert done.returncode == 2
    assert "invalid choice: 'nothing'" in done.stderr
