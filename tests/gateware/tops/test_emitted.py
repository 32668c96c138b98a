"""The module `ros2_ether` and its headers as they are written, in a board's Verilog as the manual describes it: simulated
beside a software participant."""

from __future__ import annotations

import pathlib
import re
from typing import Any

import pytest
from amaranth.lib.wiring import Out

from engine.rtps.network import RELIABLE
from gateware.running import started
from gateware.tops.ros2_node import (
    CLOCK,
    CLOCK_HZ,
    FACTOR,
    PREFIX,
    PUBLISHED,
    SUBSCRIBED,
    TYPE,
    number,
)
from gateware.tops.written import Written
from roslet.engine.rtps import events
from roslet.gateware.config import Config
from roslet.gateware.tops.ros2_ether import Ros2Ether
from roslet.gateware.verilog import write_ros2_ether
from roslet.sim.model import Model
from roslet.sim.wire import Wire
from sim.test_wire import ParticipantStation

pytestmark = pytest.mark.timeout(400)  # the design is compiled
USER = pathlib.Path(__file__).parents[3] / "examples/gateware/topic_pub_sub.v"
SETTINGS: dict[str, tuple[int | str, bytes]] = {
    "mac_addr": (48, bytes.fromhex("020000000001")),
    "ip_addr": (32, bytes((192, 168, 1, 100))),
    "gateway_ip_addr": (32, bytes((192, 168, 1, 1))),
    "subnet_mask": (32, bytes((255, 255, 255, 0))),
    "ros2_guid_prefix": (96, PREFIX),
    "ros2_node_name": ("`ROS2_MAX_NODE_NAME_LEN", b"emitted"),
    "ros2_pub_topic_name": ("`ROS2_MAX_TOPIC_NAME_LEN", PUBLISHED.encode()),
    "ros2_pub_topic_type_name": ("`ROS2_MAX_TOPIC_TYPE_NAME_LEN", TYPE.encode()),
    "ros2_sub_topic_name": ("`ROS2_MAX_TOPIC_NAME_LEN", SUBSCRIBED.encode()),
    "ros2_sub_topic_type_name": ("`ROS2_MAX_TOPIC_TYPE_NAME_LEN", TYPE.encode()),
}
"""Of each port that has octets: its bits, or which constant has its octets; and these."""
HANDSHAKE = [
    *(f"ros2_pub_app_data{end}" for end in ("", "_len", "_req", "_rel", "_grant")),
    *(
        f"ros2_sub_app_data_{end}"
        for end in ("len", "req", "rel", "grant", "recv", "addr", "ce", "we", "wdata")
    ),
]
BOARD = """
module board(
  input wire clk, rst_n, phy_rx_clk, phy_tx_clk, phy_rx_dv, phy_rx_er, input wire [3:0] phy_rxd,
  output wire phy_tx_en, phy_rst_n, output wire [3:0] phy_txd, led
);
  reg [1:0] synchronized;
  always @(posedge clk) synchronized <= {synchronized[0], rst_n};
  wire ready = synchronized[1];

  reg  [7:0] payloads [0:`PAYLOADSMEM_DEPTH-1];
  reg  [7:0] payload;
  wire [`PAYLOADSMEM_AWIDTH-1:0] addr;
  wire [7:0] wdata;
  wire ce, we;
  always @(posedge clk) if (ce) begin
    if (we) payloads[addr] <= wdata;
    else payload <= payloads[addr];
  end

  wire [`ROS2_MAX_APP_DATA_LEN*8-1:0] ros2_pub_app_data;
  wire [7:0] ros2_pub_app_data_len, ros2_sub_app_data_len, ros2_sub_app_data_wdata;
  wire [$clog2(`ROS2_MAX_APP_DATA_LEN)-1:0] ros2_sub_app_data_addr;
  wire ros2_pub_app_data_req, ros2_pub_app_data_rel, ros2_pub_app_data_grant;
  wire ros2_sub_app_data_req, ros2_sub_app_data_rel, ros2_sub_app_data_grant, ros2_sub_app_data_recv;
  wire ros2_sub_app_data_ce, ros2_sub_app_data_we;

  ros2_ether #(
    .PRESCALER_DIV(64), .TX_PERIOD_APP_WR_COUNT(`ROS2CLK_HZ), .TX_PERIOD_SEDP_PUB_HB_COUNT(`ROS2CLK_HZ / 64 / 10)
  ) node (
    .clk(clk), .rst_n(rst_n), .ether_en(ready), .ros2pub_en(ready), .ros2sub_en(ready),
    .phy_rx_clk(phy_rx_clk), .phy_rxd(phy_rxd), .phy_rx_dv(phy_rx_dv), .phy_rx_er(phy_rx_er),
    .phy_tx_clk(phy_tx_clk), .phy_txd(phy_txd), .phy_tx_en(phy_tx_en), .phy_rst_n(phy_rst_n),
    %SETTINGS%,
    .ros2_fragment_expiration(`ROS2CLK_HZ), .arp_req_retry_count(6'd4),
    .arp_req_retry_interval(`ROS2CLK_HZ / 2), .arp_req_timeout(30 * `ROS2CLK_HZ),
    .ros2_rx_udp_port(16'd1234), .ros2_node_udp_port(16'd52000), .ros2_port_num_seed(16'd7400),
    .udp_rxbuf_rel(1'b0), .udp_txbuf_rel(1'b0), .udp_txbuf_rdata(32'd0),
    .ip_payloadsmem_addr(addr), .ip_payloadsmem_ce(ce), .ip_payloadsmem_we(we),
    .ip_payloadsmem_wdata(wdata), .ip_payloadsmem_rdata(payload),
    %HANDSHAKE%
  );
  topic_pub_sub_user #(.PERIOD(%PERIOD%), .MAX(`ROS2_MAX_APP_DATA_LEN)) user (
    .clk(clk), .rst_n(ready), .led(led),
    %HANDSHAKE%
  );
endmodule
"""


def board(folder: pathlib.Path) -> Written:
    """The board, whose text is in `folder`: one file, as what is simulated has no place for others to include."""
    names = write_ros2_ether(Ros2Ether(Config(ros2clk_hz=CLOCK_HZ)), folder)
    node, *headers = [(folder / name).read_text() for name in names]
    node, included = re.subn(r'^`include "ros2_.*\n', "", node, flags=re.M)
    assert included == len(headers)
    words = {
        "SETTINGS": ",\n    ".join(
            f".{name}({_constant(bits, octets)})"
            + (f", .{name}_len(8'd{len(octets) + 1})" if name.endswith("name") else "")
            for name, (bits, octets) in SETTINGS.items()
        ),
        "HANDSHAKE": ", ".join(f".{name}({name})" for name in HANDSHAKE),
        "PERIOD": str(CLOCK_HZ // 10),
    }
    text = re.sub("%([A-Z]+)%", lambda found: words[found[1]], BOARD)
    whole = folder / "whole.v"
    whole.write_text("\n".join([*headers, node, USER.read_text(), text]))
    return Written("board", [whole], {"led": Out(4)})


def _constant(bits: int | str, octets: bytes) -> str:
    """The first octet in the lowest bits."""
    if isinstance(bits, str):
        return f"{{{bits}*8{{1'b0}}}} | {8 * len(octets)}'h{number(octets):x}"
    return f"{bits}'h{number(octets):x}"


def test_messages_go_both_ways_through_what_was_written(tmp_path: pathlib.Path) -> None:
    with Model(board(tmp_path)) as model:
        wire = Wire(FACTOR)
        started(model, wire, CLOCK)
        peer = ParticipantStation(2, wire.hub.port())
        wire.add(peer)
        peer.participant.create_reader(PUBLISHED, TYPE, RELIABLE, wire.now)
        writer = peer.participant.create_writer(SUBSCRIBED, TYPE, RELIABLE, wire.now)

        def of(kind: type) -> list[Any]:
            return [event for event in peer.events if isinstance(event, kind)]

        assert wire.run(5.0, lambda: len(of(events.EndpointMatched)) >= 2), "they find each other"
        for text, leds in ((b"short", 0b0011), (b"fifteen octets!", 0b1111)):
            body = (len(text) + 1).to_bytes(4, "little") + text + b"\0"
            writer.write(b"\0\1\0\0" + body, wire.now)
            assert wire.run(2.0, lambda leds=leds: model.get("led") == leds), text  # type: ignore[misc]
        assert wire.run(5.0, lambda: len(of(events.SampleReceived)) >= 12)
        wire.close()
    said = [bytes(event.payload) for event in of(events.SampleReceived)]
    first = int(said[0][28:32])
    for count, payload in enumerate(said, first):
        text = b"Message from FPGA - %04d\0" % count
        assert payload[4:].rstrip(b"\0") + b"\0" == len(text).to_bytes(4, "little") + text
