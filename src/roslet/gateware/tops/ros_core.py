"""A ROS 2 node from the pins of a PHY on, whose user gives and takes serialised messages, as streams of words."""

from __future__ import annotations

import ipaddress
from collections.abc import Sequence
from dataclasses import dataclass

from amaranth.hdl import Module, ResetInserter, Signal
from amaranth.lib import memory
from amaranth.lib.wiring import connect

from roslet.gateware.mac import Mac
from roslet.gateware.multicast import number
from roslet.gateware.rtps import tables
from roslet.gateware.rtps.loader import Loader
from roslet.gateware.rtps.participant import Participant
from roslet.gateware.rtps.periods import QUICK_PERIOD, Periods
from roslet.gateware.rtps.rom import entity_id
from roslet.gateware.rtps.tables import Local
from roslet.gateware.stack import UdpStack
from roslet.gateware.tops.ethernet_node import EthernetNode
from roslet.gateware.udp import PortSwitch
from roslet.gateware.wires import expose
from roslet.wire import discovery_info
from roslet.wire.net import ethernet, icmp, ipv4, udp
from roslet.wire.rtps import guid, locator

ARP_TRIES, ARP_INTERVAL, ARP_TIMEOUT = 4, 0.5, 30.0
"""How often, and how many seconds apart, a hardware address is asked for; and seconds for which it is remembered."""
ANNOUNCEMENT, REMINDER = 3.0, 0.1
"""Seconds between announcements, and between reminders of what has not been acknowledged."""
STEP = 64
"""Cycles in which periods are counted: the manual's PRESCALER_DIV."""
FRAGMENT = ethernet.MTU - ipv4.SIZE
FRAGMENT_EXPIRATION = 1.0
"""Seconds for which fragments wait for the others."""
SILENCE = 1.0
"""Seconds for which a node waits for somebody else to speak, before it does."""
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


class RosCore(EthernetNode):
    """A node with these topics.

    `writers` and `readers` have the names of DDS; `participants`, `endpoints` as `Participant` has them; `fragments`, of
    which a datagram that is received may consist.

    A node that is reset is somebody else then, or peers would take its first numbers for old ones: in the end of its GUID
    prefix is the cycle, counted since the power is on, in which the first frame came; or that of SILENCE after its reset.

    Ports: those of `EthernetNode`, and `publish0` .., `receive0` .., `room`, `alive`, `matched`, as `Participant` has them.
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
    ) -> None:
        self.identity = identity
        self._clk_hz = clk_hz
        self._payloads = fragments * FRAGMENT
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
        )
        self._switch = PortSwitch((0, 0, 0))
        self._loader = self._session(participant, identity, info)
        bits = self._steps(ANNOUNCEMENT).bit_length()  # the longest period
        self._periods = Periods(round(clk_hz), self._steps(QUICK_PERIOD), 1, bits)
        members = participant.signature.members
        self._user_ports = [
            name for name in members if name.startswith(("publish", "receive")) or name in NODE
        ]
        super().__init__(
            Mac(phy),
            UdpStack(
                round(clk_hz),
                groups=1,
                cache_width=cache_width,
                echo_data=self._payloads - icmp.SIZE,
                fragments=fragments,
                fragment_size=FRAGMENT,
            ),
            clk_hz,
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

    def _steps(self, seconds: float) -> int:
        """So many steps of `Periods`."""
        return max(1, round(seconds * self._clk_hz / STEP))

    def _user(self, m: Module) -> None:
        stack, identity = self._stack, self.identity
        rtps = self._participant
        running = Signal()
        m.submodules.switch = switch = self._switch
        m.submodules.rtps = ResetInserter(~running)(rtps)
        m.submodules.periods = periods = self._periods
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
            stack.retry_count.eq(ARP_TRIES),
            stack.retry_interval.eq(round(self._clk_hz * ARP_INTERVAL)),
            stack.timeout.eq(round(self._clk_hz * ARP_TIMEOUT)),
            stack.expiration.eq(round(self._clk_hz * FRAGMENT_EXPIRATION)),
            periods.enable.eq(running),
            periods.prescaler_div.eq(STEP),
            periods.announcement.eq(self._steps(ANNOUNCEMENT)),
            periods.sweep0.eq(self._steps(REMINDER)),
            rtps.tick.eq(periods.tick),
            rtps.announce.eq(periods.announce),
            rtps.sweep.eq(periods.sweep),
            *(getattr(switch, f"port{n}").eq(port) for n, port in enumerate(identity.ports)),
        ]
        expose(m, rtps, self, self._user_ports)
        self._begin(m, running)
        self._memory(m)

    def _begin(self, m: Module, running: Signal) -> None:
        """`running` from when the number of the session is known and written."""
        m.submodules.loader = loader = self._loader
        rx = self._stack.rx.stream
        cycles = Signal(32, reset_less=True)
        session = Signal(32)
        silence = Signal(range(round(self._clk_hz * SILENCE) + 1))
        m.d.sync += [cycles.eq(cycles + 1), running.eq(loader.done)]
        with m.If(self.phy_rst_n & ~loader.enable):
            m.d.sync += [session.eq(cycles), silence.eq(silence + 1)]
            came = rx.valid & rx.ready & rx.payload.end & ~rx.payload.bad
            with m.If(came | (silence == round(self._clk_hz * SILENCE))):
                m.d.sync += loader.enable.eq(1)
        m.d.comb += loader.word.eq(session)
        connect(m, loader.write, self._participant.own)

    def _memory(self, m: Module) -> None:
        """Where fragments wait."""
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
