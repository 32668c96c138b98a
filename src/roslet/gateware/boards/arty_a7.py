"""Digilent's Arty A7: the design at its 100 MHz oscillator, its PHY (a DP83848J on MII) and the LEDs LD4 to LD7, for Vivado.

Nothing here has been run: Vivado is not a tool that can be had as a package.
"""

from __future__ import annotations

import pathlib
from typing import Any

from roslet.gateware import toolchain

PART = "xc7a35ticsg324-1L"  # of the A7-35T; the A7-100T has xc7a100tcsg324-1

PINS = {
    "clk": "E3",
    "rst_n": "C2",  # the red button
    "eth_ref_clk": "G18",
    "eth_rst_n": "C16",
    "eth_rx_clk": "F15",
    "eth_rx_dv": "G16",
    "eth_rxd[0]": "D18",
    "eth_rxd[1]": "E17",
    "eth_rxd[2]": "E18",
    "eth_rxd[3]": "G17",
    "eth_rx_er": "C17",
    "eth_tx_clk": "H16",
    "eth_tx_en": "H15",
    "eth_txd[0]": "H14",
    "eth_txd[1]": "J14",
    "eth_txd[2]": "J13",
    "eth_txd[3]": "H17",
    "led[0]": "H5",  # LD4
    "led[1]": "J5",
    "led[2]": "T9",
    "led[3]": "T10",  # LD7
}
"""As remembered of the board's public constraints, and compared with nothing: check them before a board is programmed."""

_WRAPPER = """\
// The design on an Arty A7. The PHY has no crystal: its 25 MHz come from here.
module arty_a7 (
    input  wire       clk,
    input  wire       rst_n,
    output wire       eth_ref_clk,
    output wire       eth_rst_n,
    input  wire       eth_rx_clk,
    input  wire       eth_rx_dv,
    input  wire [3:0] eth_rxd,
    input  wire       eth_rx_er,
    input  wire       eth_tx_clk,
    output wire       eth_tx_en,
    output wire [3:0] eth_txd,
    output wire [3:0] led
);
    reg half = 1'b0;
    reg quarter = 1'b0;
    always @(posedge clk) begin
        half <= ~half;
        quarter <= quarter ^ half;
    end
    assign eth_ref_clk = quarter;

    NAME node (
        .clk(clk), .rst_n(rst_n), .led(led),
        .phy_rx_clk(eth_rx_clk), .phy_rxd(eth_rxd), .phy_rx_dv(eth_rx_dv), .phy_rx_er(eth_rx_er),
        .phy_tx_clk(eth_tx_clk), .phy_txd(eth_txd), .phy_tx_en(eth_tx_en), .phy_rst_n(eth_rst_n)
    );
endmodule
"""

_TIMING = """
create_clock -name clk -period 10.000 [get_ports clk]
create_clock -name phy_rx_clk -period 40.000 [get_ports eth_rx_clk]
create_clock -name phy_tx_clk -period 40.000 [get_ports eth_tx_clk]
# Queues between clocks, and whatever else crosses, have synchronizers.
set_clock_groups -asynchronous -group clk -group phy_rx_clk -group phy_tx_clk
# IEEE 802.3, 22.3.2: 10 ns of setup and hold at the receiver. 22.3.1: out between 0 and 25 ns after the edge.
set_input_delay -clock phy_rx_clk -max 30.000 [get_ports {eth_rxd[*] eth_rx_dv eth_rx_er}]
set_input_delay -clock phy_rx_clk -min 10.000 [get_ports {eth_rxd[*] eth_rx_dv eth_rx_er}]
set_output_delay -clock phy_tx_clk -max 15.000 [get_ports {eth_txd[*] eth_tx_en}]
set_output_delay -clock phy_tx_clk -min 0.000 [get_ports {eth_txd[*] eth_tx_en}]
set_property CFGBVS VCCO [current_design]
set_property CONFIG_VOLTAGE 3.3 [current_design]
"""

_PROJECT = """\
# vivado -mode batch -source arty_a7.tcl    (NOT RUN by those who wrote it: they have no Vivado)
set here [file dirname [file normalize [info script]]]
create_project -force arty_a7 $here/vivado -part PART
add_files [list $here/NAME.v $here/arty_a7.v]
add_files -fileset constrs_1 $here/arty_a7.xdc
set_property top arty_a7 [current_fileset]
launch_runs impl_1 -to_step write_bitstream -jobs 2
wait_on_run impl_1
open_run impl_1
report_utilization -file $here/utilization.txt
report_timing_summary -file $here/timing.txt
"""


def constraints() -> str:
    """The XDC: pins, and clocks."""
    lines = [
        f"set_property -dict {{PACKAGE_PIN {pin} IOSTANDARD LVCMOS33}} [get_ports {{{port}}}]"
        for port, pin in PINS.items()
    ]
    return "\n".join(lines) + "\n" + _TIMING


def build(top: Any, name: str, folder: pathlib.Path) -> list[str]:
    """Write a Vivado project of `top`, which has MII and four LEDs; its files' names. Raises ToolMissing, ToolFailed."""
    toolchain.write_verilog(top, name, folder)
    files = {
        "arty_a7.v": _WRAPPER.replace("NAME", name),
        "arty_a7.xdc": constraints(),
        "arty_a7.tcl": _PROJECT.replace("NAME", name).replace("PART", PART),
    }
    for file, text in files.items():
        (folder / file).write_text(text, encoding="utf-8")
    return [f"{name}.v", *files]
