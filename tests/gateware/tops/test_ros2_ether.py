"""The manual's node among software participants, on a simulated wire: its ports, and what they do."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from engine.rtps.network import BEST_EFFORT, LATCHED, RELIABLE
from gateware.tops.ros2_node import (
    ADDRESS,
    CLOCK,
    CLOCK_HZ,
    NODE,
    OUR_MAC,
    PREFIX,
    PUBLISHED,
    SUBSCRIBED,
    TYPE,
    UDP_PORT,
    Ros2Node,
    number,
)
from roslet.engine.net.host import Host
from roslet.engine.rtps import events
from roslet.gateware.config import Config
from roslet.gateware.tops.ros2_ether import Ros2Ether
from sim.test_wire import ParticipantStation

# Table A-1, by hand; N, T, Y, A are ROS2_MAX_NODE_NAME_LEN, .._TOPIC_NAME_LEN, .._TOPIC_TYPE_NAME_LEN, .._APP_DATA_LEN.
TABLE_A_1 = """
clk input 1
rst_n input 1
ether_en input 1
ros2pub_en input 1
ros2sub_en input 1
phy_rx_clk input 1
phy_rxd input 4
phy_rx_dv input 1
phy_rx_er input 1
phy_tx_clk input 1
phy_txd output 4
phy_tx_en output 1
phy_rst_n output 1
mac_addr input 48
ip_addr input 32
gateway_ip_addr input 32
subnet_mask input 32
ros2_fragment_expiration input 32
arp_req_retry_count input 6
arp_req_retry_interval input 36
arp_req_timeout input 36
ros2_rx_udp_port input 16
ros2_node_name input N*8
ros2_node_name_len input 8
ros2_node_udp_port input 16
ros2_port_num_seed input 16
ros2_guid_prefix input 96
ros2_pub_topic_name input T*8
ros2_pub_topic_name_len input 8
ros2_pub_topic_type_name input Y*8
ros2_pub_topic_type_name_len input 8
ros2_pub_app_data input A*8
ros2_pub_app_data_len input 8
ros2_pub_app_data_req input 1
ros2_pub_app_data_rel input 1
ros2_pub_app_data_grant output 1
ros2_sub_topic_name input T*8
ros2_sub_topic_name_len input 8
ros2_sub_topic_type_name input Y*8
ros2_sub_topic_type_name_len input 8
ros2_sub_app_data_len output 8
ros2_sub_app_data_rep_id output 16
ros2_sub_app_data_req input 1
ros2_sub_app_data_rel input 1
ros2_sub_app_data_grant output 1
ros2_sub_app_data_recv output 1
ros2_sub_app_data_addr output AW
ros2_sub_app_data_ce output 1
ros2_sub_app_data_we output 1
ros2_sub_app_data_wdata output 8
udp_rxbuf_addr output R
udp_rxbuf_ce output 1
udp_rxbuf_we output 1
udp_rxbuf_wdata output 32
udp_rxbuf_rel input 1
udp_rxbuf_grant output 1
udp_txbuf_addr output X
udp_txbuf_ce output 1
udp_txbuf_rdata input 32
udp_txbuf_rel input 1
udp_txbuf_grant output 1
ip_payloadsmem_addr output PW
ip_payloadsmem_ce output 1
ip_payloadsmem_we output 1
ip_payloadsmem_wdata output 8
ip_payloadsmem_rdata input 8
"""
# Table A-2, as ports of the component.
TABLE_A_2 = """
prescaler_div tx_interval_count tx_period_spdp_wr_count tx_period_sedp_pub_wr_count tx_period_sedp_sub_wr_count
tx_period_sedp_pub_hb_count tx_period_sedp_sub_hb_count tx_period_sedp_pub_an_count tx_period_sedp_sub_an_count
tx_period_app_wr_count
"""


def wanted_ports(**sizes: int) -> set[tuple[str, str, int]]:
    """The manual's ports with these sizes."""
    found = set()
    for line in TABLE_A_1.strip().splitlines():
        name, direction, width = line.split()
        bits = 1
        for factor in width.split("*"):
            bits *= sizes[factor] if factor in sizes else int(factor)
        found.add((name, direction, bits))
    return found


MANUAL = {"N": 32, "T": 32, "Y": 64, "A": 64, "AW": 6, "R": 6, "X": 6, "PW": 12}
LIFTED = {"N": 40, "T": 48, "Y": 80, "A": 200, "AW": 8, "R": 8, "X": 7, "PW": 13}


@pytest.mark.parametrize(
    ("config", "sizes"),
    [
        (Config(), MANUAL),
        (
            Config(
                ros2_max_node_name_len=40,
                ros2_max_topic_name_len=48,
                ros2_max_topic_type_name_len=80,
                ros2_max_app_data_len=200,
                udp_rxbuf_awidth=8,
                udp_txbuf_awidth=7,
                max_ip_fragments=4,
            ),
            LIFTED,
        ),
    ],
)
def test_the_ports_are_those_of_the_manual_and_constants_lift_them(
    config: Config, sizes: dict[str, int]
) -> None:
    found = {
        (name, "input" if member.flow.name == "In" else "output", len(getattr(Ros2Ether(config), name)))
        for name, member in Ros2Ether(config).signature.members.items()
    }
    beside = {name for name, _, _ in found} - {name for name, _, _ in wanted_ports(**sizes)}
    assert beside == set(TABLE_A_2.split())
    assert {port for port in found if port[0] not in beside} == wanted_ports(**sizes)


class Bench:
    """The node with a software participant, both enabled; `reader` and `writer` are the software's."""

    def __init__(self, clock: float = CLOCK, **ports: int) -> None:
        self.node = Ros2Node(clock, **ports)
        self.peer = ParticipantStation(2, self.node.wire.hub.port())
        self.node.wire.add(self.peer)
        self.reader = self.peer.participant.create_reader(PUBLISHED, TYPE, RELIABLE, 0.0)
        self.writer = self.peer.participant.create_writer(SUBSCRIBED, TYPE, RELIABLE, 0.0)
        self.frames: list[bytes] = []
        self.node.wire.hub.listeners.append(lambda frame, now: self.frames.append(bytes(frame)))

    def run(self, seconds: float, until: Callable[[], bool] | None = None) -> bool:
        return self.node.wire.run(seconds, until)

    def of(self, kind: type) -> list[object]:
        return [event for event in self.peer.events if isinstance(event, kind)]

    def received(self) -> list[bytes]:
        """The messages, without their encapsulation header and padding."""
        found = []
        for event in self.peer.events:
            if isinstance(event, events.SampleReceived):
                payload = bytes(event.payload)
                found.append(payload[4 : len(payload) - (payload[3] & 3)])
        return found

    def write(self, data: bytes) -> None:
        self.writer.write(b"\0\1\0\0" + data, self.node.wire.now)

    def matched(self) -> bool:
        return len(self.of(events.EndpointMatched)) >= 2

    def announced(self) -> bool:
        """The last that was heard of the node's message is in memory."""
        return bool(self.node.model.get("ros2_sub_app_data_recv"))


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench()
    with made.node:
        made.node.enable()
        assert made.run(2.0, made.matched)
        yield made


def test_nothing_of_rtps_is_sent_before_something_is_enabled() -> None:
    made = Bench()
    with made.node as node:
        made.run(1.0)
        mine = bytes.fromhex(OUR_MAC.replace(":", ""))
        assert not [frame for frame in made.frames if frame[6:12] == mine and b"RTPS" in frame]
        assert not made.of(events.ParticipantDiscovered)
        node.enable()
        assert made.run(2.0, made.matched)


def test_peers_learn_who_it_is_from_its_ports(bench: Bench) -> None:
    (found,) = bench.of(events.ParticipantDiscovered)
    data = found.data  # type: ignore[attr-defined]
    assert data.guid == PREFIX + b"\0\0\x01\xc1"
    assert [str(one) for one in data.metatraffic_unicast] == [f"{ADDRESS}:7412"]
    assert [str(one) for one in data.default_unicast] == [f"{ADDRESS}:7413"]
    ends = {event.data.topic: event.data for event in bench.of(events.EndpointDiscovered)}  # type: ignore[attr-defined]
    assert set(ends) == {PUBLISHED, SUBSCRIBED, "ros_discovery_info"}
    assert {ends[name].type_name for name in (PUBLISHED, SUBSCRIBED)} == {TYPE}
    assert ends[PUBLISHED].guid == PREFIX + b"\0\0\x01\x03"
    assert ends[SUBSCRIBED].guid == PREFIX + b"\0\0\x01\x04"


def test_the_graph_says_its_name_and_its_endpoints(bench: Bench) -> None:
    bench.peer.participant.create_reader(
        "ros_discovery_info",
        "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_",
        LATCHED,
        bench.node.wire.now,
    )
    assert bench.run(2.0, lambda: bool(bench.received()))
    name = NODE.encode() + b"\0"
    info = PREFIX + b"\0\0\x01\xc1" + b"\1\0\0\0" + b"\2\0\0\0/\0\0\0" + len(name).to_bytes(4, "little")
    info += name + bytes(-len(name) % 4)
    info += b"\1\0\0\0" + PREFIX + b"\0\0\x01\x04" + b"\1\0\0\0" + PREFIX + b"\0\0\x01\x03"
    assert bench.received() == [info]


@pytest.mark.parametrize("size", [1, 2, 3, 4, 24, 63, 64])
def test_a_message_goes_when_the_right_to_change_it_is_given_back(bench: Bench, size: int) -> None:
    data = bytes(range(1, size + 1))
    bench.node.publish(data)
    assert bench.run(0.5, lambda: bool(bench.received()))
    assert bench.received() == [data]
    bench.run(1.0)
    assert bench.received() == [data]


def test_messages_come_from_the_port_of_the_node(bench: Bench) -> None:
    bench.frames.clear()
    bench.node.publish(b"from where?!")
    bench.run(0.5, lambda: bool(bench.received()))
    (frame,) = [frame for frame in bench.frames if b"from where?!" in frame]
    assert frame[34:36] == (52000).to_bytes(2, "big")


def test_the_message_is_published_again_each_period() -> None:
    made = Bench(tx_period_app_wr_count=CLOCK_HZ // 64 // 2)
    with made.node as node:
        node.model.set("ros2_pub_app_data", number(b"again"))
        node.model.set("ros2_pub_app_data_len", 5)
        node.enable()
        assert made.run(2.0, made.matched)
        before = len(made.received())
        made.run(5.0)
        assert 9 <= len(made.received()) - before <= 11
        assert set(made.received()) == {b"again"}


def test_a_message_that_is_too_long_is_not_sent_and_counted(bench: Bench) -> None:
    bench.node.acquire("pub")
    bench.node.model.set("ros2_pub_app_data_len", 65)
    bench.node.pulse("ros2_pub_app_data_rel")
    bench.run(0.5)
    assert bench.received() == []
    assert bench.node.drops()["pub_long"] == 1
    bench.node.publish(b"short")
    assert bench.run(0.5, lambda: bench.received() == [b"short"])


@pytest.mark.parametrize("size", [0, 1, 2, 3, 4, 25, 63, 64])
def test_a_message_of_a_peer_is_written_into_the_memory(bench: Bench, size: int) -> None:
    data = bytes(range(100, 100 + size))
    bench.writer.write(bytes((0, 1, 0, -size % 4)) + data + bytes(-size % 4), bench.node.wire.now)
    assert bench.run(0.5, bench.announced)
    model = bench.node.model
    assert model.get("ros2_sub_app_data_rep_id") == 1  # CDR_LE: RTPS 2.3, 10.5
    assert model.get("ros2_sub_app_data_len") == size
    assert bench.node.take() == data
    assert not bench.announced()


def test_the_other_byte_order_is_told_of(bench: Bench) -> None:
    bench.writer.write(b"\0\0\0\0\0\0\0\7", bench.node.wire.now)
    assert bench.run(0.5, bench.announced)
    assert bench.node.model.get("ros2_sub_app_data_rep_id") == 0  # CDR_BE


def test_a_longer_message_than_the_memory_is_dropped_whole(bench: Bench) -> None:
    bench.write(b"kept")
    assert bench.run(0.5, bench.announced)
    bench.write(bytes(68))
    bench.run(0.5)
    assert bench.node.drops()["sub_long"] == 1
    assert bench.node.take() == b"kept"
    bench.write(b"next")
    assert bench.run(0.5, bench.announced)
    assert bench.node.take() == b"next"


def test_the_memory_is_left_alone_while_the_user_reads_it(bench: Bench) -> None:
    bench.write(b"one!")
    assert bench.run(0.5, bench.announced)
    bench.node.acquire("sub")
    for text in (b"two!", b"three!!!"):
        bench.write(text)
        bench.run(0.3)
        assert bench.node.memory() == b"one!"
    assert not bench.announced()
    bench.node.pulse("ros2_sub_app_data_rel")
    assert bench.run(0.1, bench.announced)
    assert bench.node.take() == b"two!"
    assert bench.node.drops()["rtps_submessages_busy"] == 1


def test_each_may_be_disabled_and_enabled_again(bench: Bench) -> None:
    node = bench.node
    for round_ in range(3):
        node.enable(publisher=False)
        assert bench.run(2.0, lambda: len(bench.of(events.EndpointUnmatched)) == 2 * round_ + 1)  # noqa: B023
        node.publish(b"unheard")
        bench.write(b"heard %d!" % round_)
        assert bench.run(0.5, bench.announced)
        assert node.take()[:7] == b"heard %d" % round_
        node.enable(subscriber=False)
        assert bench.run(2.0, lambda: len(bench.of(events.EndpointUnmatched)) == 2 * round_ + 2)  # noqa: B023
        assert bench.run(2.0, lambda: len(bench.of(events.EndpointMatched)) == 2 * round_ + 3)  # noqa: B023
        node.publish(b"again %d" % round_)
        assert bench.run(1.0, lambda: bench.received()[-1:] == [b"again %d" % round_])  # noqa: B023
        bench.write(b"unheard!")
        bench.run(0.3)
        assert not bench.announced()
        node.enable()
        assert bench.run(2.0, lambda: len(bench.of(events.EndpointMatched)) == 2 * round_ + 4)  # noqa: B023
    assert bench.received() == [b"again 0", b"again 1", b"again 2"]
    assert not bench.of(events.ParticipantLost)
    assert len(bench.of(events.ParticipantDiscovered)) == 1


def test_who_asks_for_what_it_does_not_have_is_not_matched() -> None:
    made = Bench()
    with made.node as node:
        made.peer.participant.create_reader(PUBLISHED, "std_msgs::msg::dds_::Bool_", RELIABLE, 0.0)
        made.peer.participant.create_reader(PUBLISHED, TYPE, LATCHED, 0.0)
        made.peer.participant.create_reader("rt/bb", TYPE, BEST_EFFORT, 0.0)
        made.peer.participant.create_reader("rt/bbbb", TYPE, BEST_EFFORT, 0.0)
        node.enable()
        assert made.run(2.0, made.matched)
        made.run(1.0)  # the node, too, has heard of all
        node.publish(b"one")
        made.run(0.5)
        assert made.received() == [b"one"]


def test_the_udp_memories_work_beside_it(bench: Bench) -> None:
    node, model = bench.node, bench.node.model
    host = Host("02:00:00:00:00:10", "192.168.1.10/24")
    node.wire.host(host)
    endpoint = host.open(5000)
    bench.write(b"first")
    assert bench.run(0.5, bench.announced)
    endpoint.send(b"by UDP", (ADDRESS, UDP_PORT), node.wire.now)
    assert bench.run(0.5, lambda: bool(model.get("udp_rxbuf_grant")))
    words = []
    for at in range(4):
        model.set("rxbuf_addr", at)
        model.run_cycles("clk", 1)
        words.append(model.get("rxbuf_data"))
    assert words[0] == number(bytes((192, 168, 1, 10)))
    assert words[1] == 5000 | 6 << 16
    assert b"".join(word.to_bytes(4, "little") for word in words[2:]) == b"by UDP\0\0"
    node.pulse("udp_rxbuf_rel")
    assert node.take()[:5] == b"first"

    text = b"to the host"
    octets = bytes((192, 168, 1, 10)) + (5000).to_bytes(2, "little") + (UDP_PORT).to_bytes(2, "little")
    octets += len(text).to_bytes(4, "little") + text + b"\0"
    for n in range(0, len(octets), 4):
        model.set("txbuf_addr", n // 4)
        model.set("txbuf_data", number(octets[n : n + 4]))
        node.pulse("txbuf_en")
    node.pulse("udp_txbuf_rel")
    node.publish(b"and by RTPS")
    assert bench.run(1.0, lambda: bool(bench.received()))
    got: list[tuple[bytes, tuple[str, int]]] = []
    while (found := endpoint.receive()) is not None:
        got.append((bytes(found[0]), found[1]))
    assert got == [(text, (ADDRESS, UDP_PORT))]
    assert bench.received() == [b"and by RTPS"]


def cycles_until(node: Ros2Node, pin: str, limit: int = 1000) -> int:
    for count in range(limit):
        if node.model.get(pin):
            return count
        node.model.run_cycles("clk", 1)
    raise TimeoutError(pin)


@pytest.fixture
def quick() -> Iterator[Bench]:
    """With a clock of 100 MHz, at which times are said."""
    made = Bench(clock=100e6)
    with made.node:
        made.node.enable()
        assert made.run(2.0, made.matched)
        yield made


def test_a_message_is_on_the_wire_two_microseconds_after_rel(quick: Bench) -> None:
    quick.node.publish(b"the first one asks for an address")
    quick.run(0.5)
    for size in (4, 16, 64):
        quick.node.publish(bytes(size))
        assert cycles_until(quick.node, "phy_tx_en") <= 200
        quick.run(0.3)


def test_recv_rises_a_microsecond_after_the_last_nibble(quick: Bench) -> None:
    for size in (4, 16, 64):
        data = bytes(range(size))
        quick.frames.clear()
        quick.write(data)
        assert quick.run(0.5, quick.announced)
        quick.node.take()
        quick.run(0.3)
        ours = bytes.fromhex(OUR_MAC.replace(":", ""))
        (frame,) = [frame for frame in quick.frames if frame[:6] == ours and data in frame]
        # The next number, which the peer does not know of, and no checksum.
        again = bytearray(frame)
        again[40:42] = b"\0\0"
        at = frame.index(data) - 4 - 4
        again[at : at + 4] = (int.from_bytes(frame[at : at + 4], "little") + 1).to_bytes(4, "little")
        quick.node.mii.send(bytes(again))
        cycles_until(quick.node, "phy_rx_dv")
        while quick.node.model.get("phy_rx_dv"):
            quick.node.model.run_cycles("clk", 1)
        assert cycles_until(quick.node, "ros2_sub_app_data_recv") <= 100
        quick.node.take()
        quick.writer.write(b"\0\1\0\0", quick.node.wire.now)  # its number has been used
        quick.run(0.3)
