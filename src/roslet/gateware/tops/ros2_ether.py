"""A ROS 2 node with one topic each way, from the pins of a PHY on: the manual's `ros2_ether`. Table A-1."""

from __future__ import annotations

from collections.abc import Sequence

from amaranth.hdl import C, Cat, Module, Mux, ResetInserter, Signal, Value
from amaranth.lib.wiring import In, Out, connect

from roslet.gateware.arbiter import FrameArbiter
from roslet.gateware.config import Config, rtps_ports
from roslet.gateware.fifo import FrameStage
from roslet.gateware.gather import gather
from roslet.gateware.meta import UDP_TX
from roslet.gateware.rtps import tables
from roslet.gateware.rtps.loader import Loader, Store
from roslet.gateware.rtps.participant import Participant
from roslet.gateware.rtps.periods import BITS, PRESCALER_BITS, QUICK_PERIOD, Periods
from roslet.gateware.rtps.rom import entity_id
from roslet.gateware.rtps.tables import Local
from roslet.gateware.tops.app_data import AppDataRx, AppDataTx
from roslet.gateware.tops.ethernet_udp import EthernetUdp
from roslet.gateware.udp import PortSwitch
from roslet.wire import discovery_info
from roslet.wire.net import udp
from roslet.wire.rtps import guid, locator

PERIODS = {
    "tx_period_spdp_wr_count": "announcement",
    "tx_period_sedp_pub_hb_count": "sweep0",
    "tx_period_sedp_sub_hb_count": "sweep1",
    "tx_period_app_wr_count": "message",
    "tx_interval_count": "interval",
}
"""Ports for the parameters of Table A-2 that say when something is sent, and what they are of `Periods`."""
WITHOUT_EFFECT = (
    "tx_period_sedp_pub_wr_count",
    "tx_period_sedp_sub_wr_count",
    "tx_period_sedp_pub_an_count",
    "tx_period_sedp_sub_an_count",
)
"""Ports for those of what is sent when a peer asks for it, and at no other time."""

_SEED = locator.metatraffic_multicast_port(0)
_HEAD = bytes(12) + guid.ENTITYID_PARTICIPANT + (1).to_bytes(4, "little")  # one node
_HEAD += (2).to_bytes(4, "little") + b"/\0\0\0"  # its namespace
"""Of what the graph says of us, before the length of the node's name. See `discovery_info`."""
_TAIL_WORDS = 10
"""Behind the name: one reader's GUID, one writer's, each with a count before it."""


class Ros2Ether(EthernetUdp):
    """A node that publishes one topic and subscribes to one, and does all that `EthernetUdp` does.

    Ports have the names, directions, widths and meanings of the manual's Table A-1; and there are, for the parameters of
    Table A-2, `prescaler_div` and `tx_..._count`, steady. docs/gateware-ports.md has what the manual leaves open.

    config           the manual's constants
    phy, counters    as `EthernetUdp` has them
    history          how many messages are kept for readers that miss some, a power of two
    on_change        a message goes at once when the user gives back the right to change it, not only by the clock
    reliable_reader  what is missed is asked for again; such a reader does not match publishers that are best effort
    participants, endpoints
                     how many others, and how many of their endpoints that match ours, are known at once

    The publisher is reliable, so that it matches every subscription. Who the node is, and its names, is read from the ports
    once, when the first of `ros2pub_en` and `ros2sub_en` rises: nothing of RTPS is sent or received before.
    """

    def __init__(
        self,
        config: Config | None = None,
        phy: str = "mii",
        counters: bool = False,
        history: int = 1,
        on_change: bool = True,
        reliable_reader: bool = False,
        participants: int = 8,
        endpoints: int = 16,
    ) -> None:
        config = Config() if config is None else config
        self._offsets = {
            name: port - _SEED for name, port in rtps_ports(0, config.target_participant_id, _SEED).items()
        }
        size = config.ros2_max_app_data_len
        rooms = config.ros2_max_topic_name_len, config.ros2_max_topic_type_name_len
        name_words = _words(config.ros2_max_node_name_len)
        writer = Local("", "", reliable=True, words=_words(size), depth=history, rooms=rooms)
        reader = Local("", "", reliable=reliable_reader, rooms=rooms)
        graph = Local(
            discovery_info.TOPIC,
            discovery_info.TYPE,
            reliable=True,
            transient_local=True,
            words=len(_HEAD) // 4 + 1 + name_words + _TAIL_WORDS,
            type_hash=discovery_info.TYPE_HASH,
        )
        self._participant = Participant(
            [writer],
            [reader],
            bytes(12),
            bytes(4),
            (0, 0, 0),
            None,
            ((graph, _HEAD),),
            participants,
            endpoints,
            longest=config.max_ip_fragments * config.ip_max_payload_len - udp.SIZE,
        )
        self._publisher, self._subscriber = AppDataTx(size, on_change), AppDataRx(size)
        self._switch = PortSwitch((0, 0, 0, 1))
        self._periods = Periods(
            config.ros2clk_hz, round(config.ros2clk_hz / config.prescaler_div * QUICK_PERIOD)
        )
        self._build(
            config,
            phy,
            counters,
            groups=1,
            askers=2,
            longest=self._participant.most,
            blocks={
                "udp": self._switch,
                "rtps": self._participant,
                "pub": self._publisher,
                "sub": self._subscriber,
            },
            more={
                "ros2pub_en": In(1),
                "ros2sub_en": In(1),
                "ros2_node_name": In(8 * config.ros2_max_node_name_len),
                "ros2_node_name_len": In(8),
                "ros2_node_udp_port": In(16),
                "ros2_port_num_seed": In(16),
                "ros2_guid_prefix": In(96),
                "ros2_pub_topic_name": In(8 * rooms[0]),
                "ros2_pub_topic_name_len": In(8),
                "ros2_pub_topic_type_name": In(8 * rooms[1]),
                "ros2_pub_topic_type_name_len": In(8),
                "ros2_pub_app_data": In(8 * size),
                "ros2_pub_app_data_len": In(8),
                "ros2_pub_app_data_req": In(1),
                "ros2_pub_app_data_rel": In(1),
                "ros2_pub_app_data_grant": Out(1),
                "ros2_sub_topic_name": In(8 * rooms[0]),
                "ros2_sub_topic_name_len": In(8),
                "ros2_sub_topic_type_name": In(8 * rooms[1]),
                "ros2_sub_topic_type_name_len": In(8),
                "ros2_sub_app_data_len": Out(8),
                "ros2_sub_app_data_rep_id": Out(16),
                "ros2_sub_app_data_req": In(1),
                "ros2_sub_app_data_rel": In(1),
                "ros2_sub_app_data_grant": Out(1),
                "ros2_sub_app_data_recv": Out(1),
                "ros2_sub_app_data_addr": Out(config.ros2_app_data_awidth),
                "ros2_sub_app_data_ce": Out(1),
                "ros2_sub_app_data_we": Out(1),
                "ros2_sub_app_data_wdata": Out(8),
                "prescaler_div": In(PRESCALER_BITS, init=config.prescaler_div),
                **{
                    name: In(BITS, init=config.tx_counts[name.upper()])
                    for name in (*PERIODS, *WITHOUT_EFFECT)
                },
            },
        )

    def _user(self, m: Module) -> None:
        stack, rtps, switch = self._stack, self._participant, self._switch
        loaded, running = Signal(), Signal()
        m.submodules.switch = switch
        # What it knows of others is forgotten with a reset; what it has been loaded with, meanwhile, is not.
        m.submodules.rtps = ResetInserter(~running)(rtps)
        m.submodules.udp_senders = senders = FrameArbiter(2, UDP_TX)
        m.submodules.udp_register = datagrams = FrameStage(UDP_TX, late=True)
        m.d.sync += running.eq(loaded)
        for source, sink in (
            (stack.udp_rx, switch.i),
            (switch.o0, rtps.udp_rx),
            (switch.o1, self._rx.i),
            (rtps.udp_tx, senders.i0),
            (self._tx.o, senders.i1),
            (senders.o, datagrams.i),
            (datagrams.o, stack.udp_tx),
            (rtps.lookup, stack.lookup0),
            (self._tx.lookup, stack.lookup1),
        ):
            connect(m, source, sink)
        self._memories(m)

        publishing, subscribing, known = Signal(), Signal(), Signal(2)
        m.d.sync += [
            publishing.eq(self.ros2pub_en & running),
            subscribing.eq(self.ros2sub_en & running),
            known.eq(Cat(publishing, subscribing)),
        ]
        ports = [self._port(m, name) for name in self._offsets]
        m.d.comb += [
            *(getattr(switch, f"port{n}").eq(port) for n, port in enumerate(ports)),
            switch.port3.eq(self.ros2_rx_udp_port),
            rtps.addresses.eq(stack.addresses),
            rtps.group_port.eq(ports[0]),
            rtps.source_port.eq(self.ros2_node_udp_port),
            rtps.writers_enabled.eq(Cat(publishing, C(1, 1))),
            rtps.readers_enabled.eq(subscribing),
            stack.groups[0].valid.eq(1),
            stack.groups[0].ip.eq(int.from_bytes(locator.SPDP_MULTICAST_ADDRESS, "little")),
        ]
        self._clock(m, running, publishing)
        self._load_and_publish(m, loaded, publishing, ports)
        self._subscribe(m, subscribing)

    def _port(self, m: Module, name: str) -> Signal:
        """A port of RTPS. The manual, 7.3."""
        port = Signal(16, name=name.lower())
        m.d.sync += port.eq(self.ros2_port_num_seed + self._offsets[name])
        return port

    def _clock(self, m: Module, running: Value, publishing: Value) -> None:
        rtps = self._participant
        m.submodules.periods = periods = self._periods
        m.d.comb += [
            periods.enable.eq(running & self.phy_rst_n),
            periods.publishing.eq(publishing),
            periods.prescaler_div.eq(self.prescaler_div),
            rtps.tick.eq(periods.tick),
            rtps.announce.eq(periods.announce),
            rtps.sweep.eq(periods.sweep),
            *(getattr(periods, inside).eq(getattr(self, outside)) for outside, inside in PERIODS.items()),
        ]

    def _load_and_publish(self, m: Module, loaded: Value, publishing: Value, ports: Sequence[Value]) -> None:
        """Words of ports, one at a time: of the message, and before, once, of all that has to be in the node's memory."""
        m.submodules.publisher = publisher = self._publisher
        own = self._participant.own_map
        words = _split(self.ros2_pub_app_data)
        program: list[Store] = []

        def store(address: int, *values: Value, moved: bool = False) -> None:
            for n, value in enumerate(values):
                index = next((index for index, word in enumerate(words) if word is value), len(words))
                if index == len(words):
                    words.append(value)
                program.append((address + n, index, moved))

        prefix = _split(self.ros2_guid_prefix)
        store(own.own(tables.OWN_PREFIX), *prefix, self.ip_addr, *ports[1:])
        store(own.own(tables.GROUP_PORT_OWN), ports[0], ports[0] + tables.USER_GROUP_PORT)
        for reader, kind in enumerate(("pub", "sub")):
            for is_type, text in enumerate(("topic_name", "topic_type_name")):
                port = getattr(self, f"ros2_{kind}_{text}")
                length = getattr(self, f"ros2_{kind}_{text}_len")
                store(own.text_address(bool(reader), bool(is_type), 0), length, *_split(port))
        self._graph(store, prefix)

        name_words = Signal(7)
        m.submodules.loader = loader = Loader(program, len(words), own.address_bits, len(name_words))
        # From block RAM, and to another: both through a register.
        loading, found = Signal.like(loader.index), Signal(32)
        word = gather(m, words, loading | publisher.index)  # of which one is zero
        m.d.sync += [
            loading.eq(Mux(loader.done, 0, loader.index)),
            found.eq(Mux(loader.done, 0, word)),
            name_words.eq((self.ros2_node_name_len + 3)[2:]),
        ]
        connect(m, loader.write, self._participant.own)
        connect(m, publisher.o, self._participant.publish0)
        m.d.comb += [
            loader.enable.eq(self.ros2pub_en | self.ros2sub_en),
            loader.word.eq(found),
            loader.name_words.eq(name_words),
            loaded.eq(loader.done),
            publisher.word.eq(word),
            publisher.enable.eq(publishing),
            publisher.periodic.eq(self._periods.publish),
            publisher.length.eq(self.ros2_pub_app_data_len),
            publisher.req.eq(self.ros2_pub_app_data_req),
            publisher.rel.eq(self.ros2_pub_app_data_rel),
            self.ros2_pub_app_data_grant.eq(publisher.grant),
        ]

    def _graph(self, store: object, prefix: list[Value]) -> None:
        """The sample that says in the graph which node is ours, and which endpoints are its."""
        assert callable(store)
        own = self._participant.own_map
        at = own.samples[1]
        words = len(_HEAD) // 4 + 1 + _TAIL_WORDS
        store(at, (words + (self.ros2_node_name_len + 3)[2:])[:16])  # how many there are; no padding
        store(at + 1, *prefix)
        name = at + 1 + len(_HEAD) // 4
        store(name, self.ros2_node_name_len, *_split(self.ros2_node_name))
        one = C(1, 32)
        ends = [C(int.from_bytes(entity_id(0, writer), "little"), 32) for writer in (False, True)]
        tail = [word for end in ends for word in (one, *prefix, end)]
        store(name + 1, *tail, moved=True)

    def _subscribe(self, m: Module, subscribing: Value) -> None:
        m.submodules.subscriber = subscriber = self._subscriber
        connect(m, self._participant.receive0, subscriber.i)
        m.d.comb += [
            self._participant.room.eq(subscriber.room),
            subscriber.enable.eq(subscribing),
            subscriber.req.eq(self.ros2_sub_app_data_req),
            subscriber.rel.eq(self.ros2_sub_app_data_rel),
        ]
        for outside, inside in (
            ("len", "length"),
            ("rep_id", "representation"),
            *((name, name) for name in ("grant", "recv", "addr", "ce", "we", "wdata")),
        ):
            m.d.comb += getattr(self, f"ros2_sub_app_data_{outside}").eq(getattr(subscriber, inside))


def _words(octets: int) -> int:
    return (octets + 3) // 4


def _split(port: Value) -> list[Value]:
    """The words of a port, the first octet in the lowest bits."""
    return [port[at : at + 32] for at in range(0, len(port), 32)]
