"""The manual's numbers, Tables A-2 and A-3 and appendix 7.3, as they are printed."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from roslet.gateware import toolchain
from roslet.gateware.config import (
    Config,
    check_rx_udp_port,
    ros2_config_vh,
    ros2_ether_config_vh,
    rtps_ports,
)

TABLE_A3 = {
    "ROS2_MAX_NODE_NAME_LEN": 32,
    "ROS2_MAX_TOPIC_NAME_LEN": 32,
    "ROS2_MAX_TOPIC_TYPE_NAME_LEN": 64,
    "ROS2_MAX_APP_DATA_LEN": 64,
    "TARGET_PARTICIPANT_ID": 1,
    "PAYLOADSMEM_DEPTH": 2960,
    "PAYLOADSMEM_AWIDTH": 12,
    "MAX_PENDINGS": 1,
    "IP_MAX_PAYLOAD_LEN": 1480,
    "MAX_IP_FRAGMENTS": 2,
    "ROS2CLK_HZ": 100000000,
}
TABLE_A3_ETHER = {
    "UDP_RXBUF_AWIDTH": 6,
    "UDP_TXBUF_AWIDTH": 6,
    "MAC_TX_FIFO_DEPTH": 512,
    "MAC_RX_FIFO_DEPTH": 2048,
    "EXT_TX_FIFO_DEPTH": 2,
    "EXT_RX_FIFO_DEPTH": 2048,
    "ARP_CACHE_ADDR_WIDTH": 4,
}


def defined(header: str) -> dict[str, int]:
    """The macros of a header that are defined as numbers."""
    words = [line.split() for line in header.splitlines()]
    return {line[1]: int(line[2]) for line in words if line[0] == "`define" and len(line) == 3}


def test_the_headers_say_every_constant_of_table_a3() -> None:
    assert defined(ros2_config_vh(Config())) == TABLE_A3
    assert defined(ros2_ether_config_vh(Config())) == TABLE_A3_ETHER


def test_what_is_derived_follows_what_it_is_derived_from() -> None:
    config = Config(max_pendings=4, max_ip_fragments=4, ros2_max_app_data_len=100)
    macros = defined(ros2_config_vh(config))
    assert (macros["PAYLOADSMEM_DEPTH"], macros["PAYLOADSMEM_AWIDTH"]) == (23680, 15)
    assert config.ros2_app_data_awidth == 7
    assert Config().ros2_app_data_awidth == 6


def test_the_periods_of_table_a2_are_counted_in_divided_clocks() -> None:
    counts = Config().tx_counts
    assert counts.pop("TX_INTERVAL_COUNT") == 100_000_000 // 64 // 100
    assert set(counts) == {
        f"TX_PERIOD_{name}_COUNT"
        for name in (
            *("SPDP_WR", "SEDP_PUB_WR", "SEDP_SUB_WR", "SEDP_PUB_HB", "SEDP_SUB_HB"),
            *("SEDP_PUB_AN", "SEDP_SUB_AN", "APP_WR"),
        )
    }
    assert set(counts.values()) == {100_000_000 // 64 * 3}
    assert Config(ros2clk_hz=50_000_000).tx_counts["TX_INTERVAL_COUNT"] == 50_000_000 // 64 // 100


def test_a_verilog_tool_reads_the_headers(tmp_path: Path) -> None:
    (tmp_path / "ros2_config.vh").write_text(ros2_config_vh(Config()))
    (tmp_path / "ros2_ether_config.vh").write_text(ros2_ether_config_vh(Config()))
    (tmp_path / "top.v").write_text(
        '`include "ros2_config.vh"\n`include "ros2_ether_config.vh"\n`include "ros2_config.vh"\n'
        "module top(output [`PAYLOADSMEM_AWIDTH-1:0] a, output [`UDP_RXBUF_AWIDTH-1:0] b);\n"
        "assign a = `PAYLOADSMEM_DEPTH - 1; assign b = `EXT_TX_FIFO_DEPTH;\nendmodule\n"
    )
    commands = "read_verilog top.v; hierarchy -check -top top; proc; sat -prove a 2959 -prove b 2 -verify"
    toolchain.run("yosys", ["-q", "-p", commands], tmp_path)


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("mac_tx_fifo_depth", 500, "mac_tx_fifo_depth is a power of two, not 500"),
        ("ext_rx_fifo_depth", 0, "ext_rx_fifo_depth is at least 1, not 0"),
        ("ros2_max_topic_name_len", 256, "ros2_max_topic_name_len is at most 255, not 256"),
        ("target_participant_id", 120, "target_participant_id is at most 119, not 120"),
        ("udp_rxbuf_awidth", 1, "an address of 2 to 14 bits, not 1"),
        ("udp_txbuf_awidth", 15, "an address of 2 to 14 bits, not 15"),
    ],
)
def test_what_cannot_be_built_is_refused(name: str, value: int, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        dataclasses.replace(Config(), **{name: value})


@pytest.mark.parametrize(
    ("domain", "participant", "seed", "ports"),
    [
        (0, 1, None, [7400, 7412, 7413]),
        (0, 0, None, [7400, 7410, 7411]),
        (42, 3, None, [17900, 17916, 17917]),
        (0, 1, 30000, [30000, 30012, 30013]),
    ],
)
def test_ports_of_rtps_are_those_of_the_appendix_and_refused(
    domain: int, participant: int, seed: int | None, ports: list[int]
) -> None:
    assert list(rtps_ports(domain, participant, seed).values()) == ports
    for port in ports:
        with pytest.raises(ValueError, match=f"UDP port {port} is taken by RTPS"):
            check_rx_udp_port(port, domain, participant, seed)
    for port in (1234, ports[0] - 1, ports[0] + 1, ports[2] + 1, 65535):
        check_rx_udp_port(port, domain, participant, seed)


def test_a_port_that_is_none_is_refused() -> None:
    for port in (0, 65536, -1):
        with pytest.raises(ValueError, match=f"from 1 to 65535, not {port}"):
            check_rx_udp_port(port, 0, 1)
    with pytest.raises(ValueError, match="METATRAFFIC_UNICAST_LOCATOR of RTPS would be 65541"):
        rtps_ports(0, 0, 65531)
    with pytest.raises(ValueError, match="SPDP_WELL_KNOWN_MULTICAST_PORT of RTPS would be 65650"):
        rtps_ports(233, 0)
