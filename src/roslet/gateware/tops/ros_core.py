"""A ROS 2 node from the pins of its link on, whose user gives and takes serialised messages, as streams of words."""

from __future__ import annotations

import ipaddress
from collections.abc import Sequence
from dataclasses import dataclass

from amaranth.hdl import Cat, Module, ResetInserter, Signal
from amaranth.lib import memory
from amaranth.lib.wiring import connect

from roslet.gateware.multicast import number
from roslet.gateware.rtps import tables
from roslet.gateware.rtps.loader import Loader
from roslet.gateware.rtps.participant import Participant
from roslet.gateware.rtps.periods import QUICK, QUICK_PERIOD, every
from roslet.gateware.rtps.rom import entity_id
from roslet.gateware.rtps.tables import Local
from roslet.gateware.tops.linked_node import LinkedNode
from roslet.gateware.tops.links import Ethernet, Serial, piece
from roslet.gateware.udp import PortSwitch
from roslet.gateware.wires import expose
from roslet.wire import discovery_info
from roslet.wire.net import udp
from roslet.wire.rtps import guid, locator

ANNOUNCEMENT = 3
"""Whole seconds between announcements. At start, and between reminders of what has not been acknowledged, it is
QUICK_PERIOD."""
LEASE = 20.0
"""Seconds that peers are told to wait for the next sign of us."""
FRAGMENT_EXPIRATION = 1.0
"""Seconds for which fragments wait for the others."""
NODE = ("room", "alive", "matched")
"""Ports of the participant, beside messages, that are the node's."""


@dataclass(frozen=True)
class Identity:
    """Who a node is: its name, and where it is on the network.

    `mac` as in 02:00:00:00:00:01, `address` with its prefix length.
    """

    name: str
    namespace: str = "/"
    domain: int = 0
    participant: int = 1
    mac: str = "02:00:00:00:00:01"
    address: str = "192.168.1.100/24"
    gateway: str = "0.0.0.0"

    @property
    def hardware(self) -> bytes:
        """The octets of `mac`."""
        return bytes.fromhex(self.mac.replace(":", ""))

    @property
    def interface(self) -> ipaddress.IPv4Interface:
        """`address` as address and network. Raises ValueError where it is none."""
        return ipaddress.IPv4Interface(self.address)

    @property
    def guid_prefix(self) -> bytes:
        """Of the vendor and the hardware address; the last four octets are of the session, and zero here."""
        return guid.VENDORID_ROSLET + self.hardware + bytes(4)

    @property
    def ports(self) -> tuple[int, int, int]:
        """Of the discovery of all, of our own, and of the user's messages."""
        return (
            locator.metatraffic_multicast_port(self.domain),
            locator.metatraffic_unicast_port(self.domain, self.participant),
            locator.user_unicast_port(self.domain, self.participant),
        )

    def graph(self, writers: int, readers: int) -> bytes:
        """What the graph says of us: ParticipantEntitiesInfo, without its encapsulation header."""
        ours = [
            tuple(self.guid_prefix + entity_id(n, writer) for n in range(count))
            for count, writer in ((readers, False), (writers, True))
        ]
        node = discovery_info.NodeEntities(self.namespace, self.name, *ours)
        whole = discovery_info.ParticipantEntities(self.guid_prefix + guid.ENTITYID_PARTICIPANT, (node,))
        return whole.emit()[4:]


class RosCore(LinkedNode):
    """A node with these topics.

    `writers` and `readers` have the names of DDS; `participants`, `endpoints` as `Participant` has them; `fragments`, of
    which a datagram that is received may consist: with 1 there is nothing to put them together. `link`, by which it is on
    the network: Ethernet with `phy` and `cache_width`, unless another is given.

    A node that is reset is somebody else then, or peers would take its first numbers for old ones: in the end of its GUID
    prefix is the cycle in which the first frame came, or that of a second after its reset: not its number, counted since
    the power is on, but what a shift register has then that has each other value before it has one again.

    Ports: those of `LinkedNode`, and `publish0` .., `receive0` .., `room`, `alive`, `matched`, as `Participant` has them.
    """

    def __init__(
        self,
        identity: Identity,
        writers: Sequence[Local] = (),
        readers: Sequence[Local] = (),
        clk_hz: float = 100e6,
        phy: str = "mii",
        participants: int = 8,
        endpoints: int = 16,
        fragments: int = 2,
        counters: bool = False,
        cache_width: int = 4,
        link: Ethernet | Serial | None = None,
    ) -> None:
        self.identity = identity
        self._clk_hz = clk_hz
        carrier = link or Ethernet(phy, cache_width)
        self._fragments = fragments
        self._settings = carrier.settings(clk_hz)
        self._payloads = fragments * piece(carrier.mtu, fragments)
        info = identity.graph(len(writers), len(readers))
        graph = Local(
            discovery_info.TOPIC,
            discovery_info.TYPE,
            reliable=True,
            transient_local=True,
            words=(len(info) + 3) // 4,
            type_hash=discovery_info.TYPE_HASH,
        )
        self._participant = participant = Participant(
            writers,
            readers,
            identity.guid_prefix,
            identity.interface.ip.packed,
            identity.ports,
            identity.domain,
            ((graph, info),),
            participants,
            endpoints,
            longest=self._payloads - udp.SIZE,
            lease=LEASE,
        )
        made, stack = carrier.build(clk_hz, fragments, participant.most)
        self._switch = PortSwitch((0, 0, 0))
        self._loader = self._session(participant, identity, info)
        members = participant.signature.members
        self._user_ports = [
            name for name in members if name.startswith(("publish", "receive")) or name in NODE
        ]
        super().__init__(
            made,
            stack,
            {"udp": self._switch, "rtps": participant},
            {name: members[name] for name in self._user_ports},
            counters,
        )

    @staticmethod
    def _session(participant: Participant, identity: Identity, info: bytes) -> Loader:
        """What writes the number of the session wherever our GUID prefix stands in the node's memory."""
        own = participant.own_map
        prefix = identity.guid_prefix
        last = len(prefix) // 4 - 1
        at = own.samples[-1] + 1  # of the graph's message, behind its length
        found = [at + n // 4 + last for n in range(0, len(info), 4) if info[n:].startswith(prefix)]
        places = [own.own(tables.OWN_PREFIX) + last, *found]
        return Loader([(place, 0, False) for place in places], 1, own.address_bits, 1)

    def _user(self, m: Module) -> None:
        stack, identity = self._stack, self.identity
        rtps = self._participant
        running = Signal()
        m.submodules.switch = switch = self._switch
        m.submodules.rtps = ResetInserter(~running)(rtps)
        connect(m, stack.udp_rx, switch.i)
        connect(m, switch.o0, rtps.udp_rx)
        connect(m, rtps.udp_tx, stack.udp_tx)
        connect(m, rtps.lookup, stack.lookup0)
        for addresses in (stack.addresses, rtps.addresses):
            m.d.comb += [
                addresses.mac.eq(number(identity.hardware)),
                addresses.ip.eq(number(identity.interface.ip.packed)),
                addresses.mask.eq(number(identity.interface.netmask.packed)),
                addresses.gateway.eq(number(ipaddress.IPv4Address(identity.gateway).packed)),
            ]
        m.d.comb += [
            stack.groups[0].valid.eq(1),
            stack.groups[0].ip.eq(number(locator.SPDP_MULTICAST_ADDRESS)),
            *(getattr(stack, name).eq(value) for name, value in self._settings.items()),
            *(getattr(switch, f"port{n}").eq(port) for n, port in enumerate(identity.ports)),
        ]
        expose(m, rtps, self, self._user_ports)
        self._begin(m, running)
        if self._fragments > 1:
            self._memory(m)

    def _begin(self, m: Module, running: Signal) -> None:
        """`running` from when the number of the session is known and written, and what is done by the clock from then on."""
        m.submodules.loader = loader = self._loader
        rx, rtps = self._stack.rx.stream, self._participant
        cycle = Signal(32, reset_less=True)
        session = Signal(32)
        changed = ~(cycle[31] ^ cycle[21] ^ cycle[1] ^ cycle[0])
        step = every(m, max(1, round(self._clk_hz * QUICK_PERIOD)), self._link.up)
        second = every(m, round(1 / QUICK_PERIOD), step)
        m.d.sync += [cycle.eq(Cat(changed, cycle)), running.eq(loader.done)]
        with m.If(self._link.up & ~loader.enable):
            m.d.sync += session.eq(cycle)
            came = rx.valid & rx.ready & rx.payload.end & ~rx.payload.bad
            with m.If(came | second):
                m.d.sync += loader.enable.eq(1)
        with m.If(running):
            m.d.sync += session.eq(0)
        quick = Signal(range(QUICK + 1), init=QUICK)
        with m.If(running & step & (quick != 0)):
            m.d.sync += quick.eq(quick - 1)
        first = Signal(init=1)  # is to come
        with m.If(running):
            m.d.sync += first.eq(0)
        m.d.comb += [
            loader.word.eq(session),
            rtps.tick.eq(second),
            rtps.sweep.eq(step),
            rtps.announce.eq(first | (step & (quick != 0)) | every(m, ANNOUNCEMENT, second)),
        ]
        connect(m, loader.write, rtps.own)

    def _memory(self, m: Module) -> None:
        """Where fragments wait."""
        m.d.comb += self._stack.expiration.eq(round(self._clk_hz * FRAGMENT_EXPIRATION))
        port = self._stack.ip_payloadsmem
        m.submodules.payloads = payloads = memory.Memory(shape=8, depth=self._payloads, init=[])
        read, write = payloads.read_port(), payloads.write_port()
        m.d.comb += [
            read.addr.eq(port.addr),
            read.en.eq(port.ce & ~port.we),
            port.rdata.eq(read.data),
            write.addr.eq(port.addr),
            write.en.eq(port.ce & port.we),
            write.data.eq(port.wdata),
        ]
