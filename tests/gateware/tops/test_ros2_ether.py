"""`Ros2Ether`: the ports of the manual's Table A-1, and what happens at them, with the software engine on the same wire."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from amaranth.hdl import Shape
from amaranth.lib.wiring import In

from engine.rtps.network import LATCHED, RELIABLE
from gateware.tops.ros2_node import NODE, PUBLISHED, SUBSCRIBED, TYPE, Ros2Node
from roslet.engine.rtps import events
from roslet.gateware.config import Config
from roslet.gateware.tops.ros2_ether import Ros2Ether
from roslet.wire import discovery_info
from sim.test_wire import ParticipantStation

# Table A-1: inputs, then outputs, with their widths by the defaults of Table A-3; a node's name has 32 octets.
INPUTS = {
    "clk": 1, "rst_n": 1, "ether_en": 1, "ros2pub_en": 1, "ros2sub_en": 1, "phy_rx_clk": 1, "phy_rxd": 4, "phy_rx_dv": 1,
    "phy_rx_er": 1, "phy_tx_clk": 1, "mac_addr": 48, "ip_addr": 32, "gateway_ip_addr": 32, "subnet_mask": 32,
    "ros2_fragment_expiration": 32, "arp_req_retry_count": 6, "arp_req_retry_interval": 36, "arp_req_timeout": 36,
    "ros2_rx_udp_port": 16, "ros2_node_name": 256, "ros2_node_name_len": 8, "ros2_node_udp_port": 16,
    "ros2_port_num_seed": 16, "ros2_guid_prefix": 96, "ros2_pub_topic_name": 256, "ros2_pub_topic_name_len": 8,
    "ros2_pub_topic_type_name": 512, "ros2_pub_topic_type_name_len": 8, "ros2_pub_app_data": 512,
    "ros2_pub_app_data_len": 8, "ros2_pub_app_data_req": 1, "ros2_pub_app_data_rel": 1, "ros2_sub_topic_name": 256,
    "ros2_sub_topic_name_len": 8, "ros2_sub_topic_type_name": 512, "ros2_sub_topic_type_name_len": 8,
    "ros2_sub_app_data_req": 1, "ros2_sub_app_data_rel": 1, "udp_rxbuf_rel": 1, "udp_txbuf_rdata": 32, "udp_txbuf_rel": 1,
    "ip_payloadsmem_rdata": 8,
}  # fmt: skip
OUTPUTS = {
    "phy_txd": 4, "phy_tx_en": 1, "phy_rst_n": 1, "ros2_pub_app_data_grant": 1, "ros2_sub_app_data_len": 8,
    "ros2_sub_app_data_rep_id": 16, "ros2_sub_app_data_grant": 1, "ros2_sub_app_data_recv": 1, "ros2_sub_app_data_addr": 6,
    "ros2_sub_app_data_ce": 1, "ros2_sub_app_data_we": 1, "ros2_sub_app_data_wdata": 8, "udp_rxbuf_addr": 6,
    "udp_rxbuf_ce": 1, "udp_rxbuf_we": 1, "udp_rxbuf_wdata": 32, "udp_rxbuf_grant": 1,
    "udp_txbuf_addr": 6, "udp_txbuf_ce": 1,
    "udp_txbuf_grant": 1, "ip_payloadsmem_addr": 12, "ip_payloadsmem_ce": 1, "ip_payloadsmem_we": 1,
    "ip_payloadsmem_wdata": 8,
}  # fmt: skip


@pytest.mark.filterwarnings("ignore::amaranth.hdl.UnusedElaboratable")
def test_it_has_every_port_of_the_manuals_table_with_its_direction_and_width() -> None:
    members = Ros2Ether(Config()).signature.members
    for flow, table in ((True, INPUTS), (False, OUTPUTS)):
        for name, width in table.items():
            assert (members[name].flow == In) == flow, name
            assert Shape.cast(members[name].shape).width == width, name


class Session:
    def __init__(self) -> None:
        self.node = Ros2Node()
        self.peer = ParticipantStation(2, self.node.wire.hub.port())
        self.node.wire.add(self.peer)
        participant = self.peer.participant
        participant.create_reader(PUBLISHED, TYPE, RELIABLE, 0.0)
        participant.create_reader(discovery_info.TOPIC, discovery_info.TYPE, LATCHED, 0.0)
        self.writer = participant.create_writer(SUBSCRIBED, TYPE, RELIABLE, 0.0)

    def seen(self, kind: type) -> list[object]:
        return [event for event in self.peer.events if isinstance(event, kind)]

    def matches(self) -> int:
        return len(self.seen(events.EndpointMatched)) - len(self.seen(events.EndpointUnmatched))

    def payloads(self) -> list[bytes]:
        return [bytes(one.payload) for one in self.seen(events.SampleReceived)]  # type: ignore[attr-defined]

    def run(self, what: str, until: object) -> None:
        assert callable(until)
        assert self.node.wire.run(20.0, until), f"not within 20 s of the wire: {what}"


@pytest.fixture(scope="module")
def session() -> Iterator[Session]:
    made = Session()
    with made.node:
        yield made


def string(text: str) -> bytes:
    octets = text.encode() + b"\0"
    return len(octets).to_bytes(4, "little") + octets


def test_what_is_enabled_is_matched_and_the_node_is_in_the_graph(session: Session) -> None:
    session.node.enable()
    session.run("both topics and the graph", lambda: session.matches() == 3)
    session.run("the graph's message", lambda: bool(session.payloads()))
    info, _ = discovery_info.parse(session.payloads()[0])
    assert [node.name for node in info.nodes] == [NODE]
    assert len(info.nodes[0].readers) == 1 and len(info.nodes[0].writers) == 1


@pytest.mark.parametrize("text", ["", "a", "Message from FPGA - 1", "x" * 59])
def test_a_message_goes_out_when_it_has_been_changed(session: Session, text: str) -> None:
    session.node.publish(string(text))
    whole = string(text)
    padded = whole + bytes(-len(whole) % 4)
    session.run("the message", lambda: session.payloads()[-1][4:] == padded)
    assert session.payloads()[-1][:4] == bytes((0, 1, 0, -len(whole) % 4))


@pytest.mark.parametrize("text", ["", "a", "hello", "y" * 59])
def test_a_message_comes_into_the_users_memory(session: Session, text: str) -> None:
    octets = string(text)
    padding = -len(octets) % 4
    session.writer.write(bytes((0, 1, 0, padding)) + octets + bytes(padding), session.node.wire.now)
    session.run("its announcement", lambda: session.node.model.get("ros2_sub_app_data_recv"))
    assert session.node.model.get("ros2_sub_app_data_rep_id") == 1
    assert session.node.take() == octets
    session.node.wire.run(0.05)


def test_topics_that_are_disabled_go_and_come_again(session: Session) -> None:
    session.node.enable(publisher=False)
    session.run("one less", lambda: session.matches() == 2)
    session.node.enable(publisher=False, subscriber=False)
    session.run("two less", lambda: session.matches() == 1)
    session.node.enable()
    session.run("both again", lambda: session.matches() == 3)
    session.node.publish(string("again"))
    session.run("a message", lambda: session.payloads()[-1][4:12] == string("again")[:8])


def test_nothing_was_dropped_that_should_not_be(session: Session) -> None:
    assert session.node.gates.faults == {}
    assert not [
        name for name in session.node.drops() if "long" in name or "invalid" in name or "malformed" in name
    ]
