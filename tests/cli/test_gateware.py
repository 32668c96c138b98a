"""`roslet gateware`: what it writes, says and refuses."""

from __future__ import annotations

import json
import pathlib
import shutil
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import pytest

from roslet.gateware.boards import lattice

Run = Callable[..., Any]

FIGURES = {
    "device": "some chip",
    "luts": {"total": 7, "logic": 4, "carry": 3},
    "flip_flops": 9,
    "block_rams": 2,
    "clocks": {"clk": {"fmax": 90.0, "goal": 100.0}, "phy_rx_clk": {"fmax": 140.5, "goal": 25.0}},
    "met": False,
    "seed": 1,
}


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Any, ...]]:
    """What the placer is asked for; it answers FIGURES."""
    asked: list[tuple[Any, ...]] = []

    def build(*given: Any, **how: Any) -> dict[str, Any]:
        asked.append((*given, how))
        return dict(FIGURES)

    monkeypatch.setattr(lattice, "build", build)
    return asked


def test_verilog_comes_with_the_headers_of_the_manual(run: Run, tmp_path: pathlib.Path) -> None:
    outcome = run("gateware", "build", "--output", tmp_path / "out", "--json")
    assert outcome.code == 0, outcome.err
    files = json.loads(outcome.out)["files"]
    assert files == ["ethernet_udp.v", "ros2_config.vh", "ros2_ether_config.vh"]
    assert all((tmp_path / "out" / file).is_file() for file in files)
    assert "`define ROS2CLK_HZ" in (tmp_path / "out" / "ros2_config.vh").read_text()


@pytest.mark.parametrize("example", ["imu-node", "topic-pub-sub", "typed-echo", "udp-tx-rx"])
def test_a_board_gets_a_project_of_the_example(run: Run, tmp_path: pathlib.Path, example: str) -> None:
    outcome = run("gateware", "build", example, "--target", "arty-a7", "--output", tmp_path)
    assert outcome.code == 0, outcome.err
    verilog = f"{example.replace('-', '_')}.v"
    names = [verilog, "arty_a7.v", "arty_a7.xdc", "arty_a7.tcl"]
    assert outcome.out.splitlines() == [str(tmp_path / name) for name in names]
    assert "NOT RUN" in (tmp_path / "arty_a7.tcl").read_text()
    if shutil.which("iverilog") is None:
        pytest.skip("no Icarus Verilog: tools/debian.sh installs it")
    sources = [tmp_path / verilog, tmp_path / "arty_a7.v"]
    subprocess.run(["iverilog", "-t", "null", "-s", "arty_a7", *sources], check=True, timeout=60)


def test_a_clock_that_is_too_slow_is_shown_and_fails(
    run: Run, tmp_path: pathlib.Path, built: list[tuple[Any, ...]]
) -> None:
    outcome = run("gateware", "build", "udp-tx-rx", "--target", "ecp5", "--output", tmp_path)
    assert outcome.code == 1
    assert outcome.out.splitlines() == [
        "udp-tx-rx (mii) on some chip",
        "LUT4        7 (logic 4, carry 3)",
        "flip-flops  9",
        "block RAM   2",
        "seed        1",
        "clock         MHz   goal",
        "clk          90.0  100.0  too slow",
        "phy_rx_clk  140.5   25.0",
    ]
    chip, _, name, folder, goals, how = built[0]
    assert (chip, name, folder) == (lattice.ECP5, "udp_tx_rx", tmp_path)
    assert how == {"seed": 1, "seeds": 1}
    assert goals == {"clk": 100.0, "phy_rx_clk": 25.0, "phy_tx_clk": 25.0}


def test_it_can_be_placed_again(run: Run, tmp_path: pathlib.Path, built: list[tuple[Any, ...]]) -> None:
    words = ("--target", "ecp5", "--seed", "3", "--seeds", "4", "--output", tmp_path)
    run("gateware", "build", "udp-tx-rx", *words)
    assert built[0][-1] == {"seed": 3, "seeds": 4}


@pytest.mark.parametrize(
    ("words", "clk", "phy"),
    [
        (["--target", "ice40"], 25.0, 25.0),
        (["--target", "ecp5", "--phy", "gmii"], 125.0, 125.0),
        (["--target", "ecp5", "--frequency", "50"], 50.0, 25.0),
    ],
)
def test_goals_follow_from_chip_and_phy(
    words: list[str], clk: float, phy: float, run: Run, tmp_path: pathlib.Path, built: list[tuple[Any, ...]]
) -> None:
    outcome = run("gateware", "build", *words, "--output", tmp_path, "--json")
    assert built[0][4] == {"clk": clk, "phy_rx_clk": phy, "phy_tx_clk": phy}
    assert json.loads(outcome.out)["settings_flip_flops"] == 48 + 3 * 32 + 32 + 6 + 36 + 36 + 16


@pytest.mark.parametrize(
    ("target", "chip", "clk"), [("ice40", lattice.ICE40, 25.0), ("ecp5", lattice.ECP5, 100.0)]
)
def test_an_example_with_a_serial_line_has_one_clock(
    target: str, chip: Any, clk: float, run: Run, tmp_path: pathlib.Path, built: list[tuple[Any, ...]]
) -> None:
    words = ("serial-count", "--target", target, "--output", tmp_path)
    outcome = run("gateware", "build", *words)
    assert outcome.out.splitlines()[0] == "serial-count (serial) on some chip"
    used, top, name, _, goals, _ = built[0]
    assert (used, name, goals) == (chip, "serial_count", {"clk": clk})
    assert set(top.signature.members) == {"clk", "rst_n", "uart_rx", "uart_tx", "led"}


@pytest.mark.parametrize(
    ("words", "error"),
    [
        (
            ["nothing", "--target", "verilog"],
            "there is no design nothing: there are ethernet-udp, ros2-ether, imu-node, ",
        ),
        (["--target", "arty-a7"], "takes an example with LEDs: udp-tx-rx"),
        (["udp-tx-rx", "--target", "arty-a7", "--phy", "gmii"], "the Arty A7 has a PHY with MII"),
        (["serial-count", "--target", "arty-a7"], "takes an example with a PHY: udp-tx-rx"),
        (["serial-count", "--target", "ecp5", "--phy", "gmii"], "has a serial line and no PHY"),
        (
            ["serial-count", "--target", "ecp5", "--frequency", "13.5"],
            "with a clock of 1.35e+07 Hz a line has 964286 baud, not 1e+06",
        ),
        (["udp-tx-rx", "--target", "arty-a7", "--frequency", "50"], "the Arty A7 has a clock of 100 MHz"),
    ],
)
def test_what_cannot_be_built_is_said(words: list[str], error: str, run: Run, tmp_path: pathlib.Path) -> None:
    outcome = run("gateware", "build", *words, "--output", tmp_path / "out")
    assert outcome.code == 1
    assert error in outcome.err
    assert not (tmp_path / "out").exists()


def test_without_amaranth_the_extra_is_named(
    run: Run, tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "amaranth", None)
    for name in [name for name in sys.modules if name.startswith(("roslet.gateware", "amaranth."))]:
        monkeypatch.delitem(sys.modules, name)
    outcome = run("gateware", "build", "--target", "verilog", "--output", tmp_path / "out")
    assert (outcome.code, outcome.out) == (1, "")
    assert "pip install 'roslet[gateware]'" in outcome.err
