"""`roslet gateware sim`, as a process."""

from __future__ import annotations

import json
import pathlib
import subprocess
import sys

import pytest


def sim(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "roslet", "gateware", "sim", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=250, check=False)


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


def test_an_unknown_example_is_named() -> None:
    done = sim("nothing")
    assert done.returncode == 2
    assert "invalid choice: 'nothing'" in done.stderr
