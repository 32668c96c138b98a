"""`roslet gateware sim`, as a process."""

from __future__ import annotations

import json
import pathlib
import subprocess
import sys
from itertools import pairwise

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


@pytest.mark.timeout(400)
def test_a_counter_in_gates_goes_over_a_serial_line_and_is_preset() -> None:
    done = sim("serial-count", "--seconds", "12", "--json")
    assert done.returncode == 0, done.stderr
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    sent, received = (
        [line[key] for line in lines if key in line and "time" in line] for key in ("sent", "received")
    )
    assert sent[:2] == [1000, 2000] and len(received) >= 12
    follows = [number for before, number in pairwise(received) if number != before + 1]
    assert follows and follows == sent[: len(follows)], "what it was preset to, and it counts on from there"
    assert (lines[-1]["faults"], lines[-1]["dropped"]) == ({}, {})


@pytest.mark.timeout(400)
def test_a_pseudo_terminal_is_a_line_to_a_node_of_software() -> None:
    command = [sys.executable, "-m", "roslet", "gateware", "sim", "serial-count", "--pty", "--json"]
    process = subprocess.Popen([*command, "--seconds", "300"], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    try:
        said = json.loads(process.stdout.readline())
        echo = [sys.executable, "-m", "roslet", "topic", "echo", "/count", "--network", said["network"]]
        done = subprocess.run(
            [*echo, "--count", "3", "--json"], capture_output=True, text=True, timeout=120, check=False
        )
        assert done.returncode == 0, done.stderr
        numbers = [json.loads(line)["data"] for line in done.stdout.splitlines()]
        assert numbers == list(range(numbers[0], numbers[0] + 3))
    finally:
        process.kill()
        process.communicate()


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (("serial-count", "--tap", "tap0"), "serial-count has a serial line: there is no --tap for it"),
        (("serial-count", "--loss", "0.1"), "serial-count has a serial line: there is no --loss for it"),
        (("typed-echo", "--pty"), "typed-echo has Ethernet: there is no --pty for it"),
    ],
)
def test_an_option_for_another_link_is_refused(words: tuple[str, ...], error: str) -> None:
    done = sim(*words)
    assert (done.returncode, done.stdout) == (1, "")
    assert error in done.stderr


def test_an_unknown_example_is_named() -> None:
    done = sim("nothing")
    assert done.returncode == 2
    assert "invalid choice: 'nothing'" in done.stderr
