"""What a node is linked by: the pins that it has then, and what it refuses."""

from __future__ import annotations

from typing import Any

import pytest

from roslet.gateware.tops.links import Ethernet, Serial, piece
from roslet.gateware.tops.ros_node import Publish, RosNode, Subscribe

TYPE = "std_msgs/msg/UInt32"
MII = {"phy_rx_clk", "phy_rxd", "phy_rx_dv", "phy_rx_er", "phy_tx_clk", "phy_txd", "phy_tx_en", "phy_rst_n"}
OTHERS = {"clk", "rst_n", "alive", "matched", "out", "in_"}


def node(**options: Any) -> RosNode:
    return RosNode("node", topics=[Publish("out", TYPE), Subscribe("in", TYPE, port="in_")], **options)


def test_a_node_on_a_serial_line_has_two_pins_in_place_of_those_of_a_phy() -> None:
    assert set(node().signature.members) == OTHERS | MII
    assert set(node(link=Serial()).signature.members) == OTHERS | {"uart_rx", "uart_tx"}
    assert set(node(link=Serial(), counters=True).signature.members) == OTHERS | {
        "uart_rx",
        "uart_tx",
        "drop_reason",
        "drop_count",
    }


def test_what_a_node_on_a_serial_line_counts_is_of_the_line_and_not_of_ethernet() -> None:
    def blocks(**options: Any) -> set[str]:
        return {reason.split("_")[0] for reason in node(counters=True, **options).reasons}

    shared = {"reassembly", "ipv4", "protocol", "icmp", "udp", "rtps"}
    assert blocks() == blocks(link=Ethernet()) == shared | {"mac", "ethernet", "arp", "igmp"}
    assert blocks(link=Serial()) == shared | {"line", "groups"}
    assert blocks(link=Serial(echo_data=None)) == (shared - {"icmp"}) | {"line", "groups"}
    reasons = node(counters=True, link=Serial(), fragments=1).reasons
    assert [name for name in reasons if name.startswith("reassembly")] == ["reassembly_none"]
    assert {"line_uart_framing", "line_uart_overrun", "line_rx_escape", "line_tx_too_long"} <= set(reasons)


def test_a_bit_takes_whole_cycles_and_eight_of_them_at_least() -> None:
    assert Serial(115200).divisor(25e6) == 217
    assert Serial(1e6).divisor(8e6) == 8
    with pytest.raises(ValueError, match=r"with a clock of 1.35e\+07 Hz a line has 964286 baud, not 1e\+06"):
        Serial(1e6).divisor(13.5e6)
    with pytest.raises(ValueError, match="a bit takes 8 cycles at least, not 4"):
        node(link=Serial(25e6), clk_hz=100e6)


@pytest.mark.parametrize(
    ("mtu", "fragments", "octets"), [(1500, 2, 1480), (1500, 1, 1480), (1000, 2, 976), (1000, 1, 980)]
)
def test_fragments_have_a_multiple_of_8_octets_where_there_are_several(
    mtu: int, fragments: int, octets: int
) -> None:
    assert piece(mtu, fragments) == octets


def test_a_packet_is_no_longer_than_on_ethernet() -> None:
    with pytest.raises(ValueError, match="1500 octets at most, not 1501"):
        node(link=Serial(mtu=1501))
