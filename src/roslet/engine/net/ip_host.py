"""What software hosts have in common, whatever their link: IPv4, ICMP echo, IGMP, UDP."""

from roslet.engine.net import events
from roslet.engine.net.endpoint import Endpoint
from roslet.engine.net.groups import Groups
from roslet.engine.net.limits import Limits
from roslet.engine.net.reassembly import Reassembly
from roslet.wire.net import ethernet, icmp, igmp, ipv4, udp
from roslet.wire.net.icmp import Echo
from roslet.wire.net.igmp import Igmp
from roslet.wire.net.ipv4 import Packet
from roslet.wire.net.udp import Datagram

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

# IANA's ports for whoever does not care, RFC 6335, 6.
EPHEMERAL, LAST_PORT = 49152, 65535
# Seconds for the answer to an echo request.
ECHO_TIMEOUT = 5.0
ALL_BROADCAST = b"\xff\xff\xff\xff"
NO_ADDRESS = bytes(4)
# RFC 1112, 6.1: multicast stays on the network unless somebody says otherwise.
MULTICAST_TTL = 1
MAX_UDP = ipv4.MAX_TOTAL_LENGTH - ipv4.SIZE - udp.SIZE
MAX_ECHO = ipv4.MAX_TOTAL_LENGTH - ipv4.SIZE - icmp.SIZE


class IpHost:
    """One host with one address, on a link that whoever inherits from this knows: what all have in common.

    address    its IPv4 address, and behind a slash the length of its network's prefix: "192.168.1.2/24"
    seed       what its chance comes from: two hosts of one link should differ in it
    counters   of what was dropped, by reason: see `engine.net.reasons`

    Sends and answers at the time of a call; `frames_to_send` has it. Datagrams to itself, and to groups that other endpoints
    of it have joined, reach them without a frame.
    """

    def __init__(
        self,
        address: str,
        seed: int = 0,
        mtu: int = ethernet.MTU,
        limits: "Limits | None" = None,
    ) -> None:
        self.address, _, bits = address.partition("/")
        self.ip = ipv4.octets_of(self.address)
        prefix = int(bits or "24")
        if not 1 <= prefix <= 30:
            raise ValueError("a network's prefix has 1 to 30 bits, not %d" % prefix)
        if mtu < 68:
            raise ValueError("every module must take 68 octets (RFC 791, 3.2), so no MTU is %d" % mtu)
        self._mask = (1 << 32) - (1 << (32 - prefix))
        self._network = int.from_bytes(self.ip, "big") & self._mask
        self._broadcast = (self._network | (~self._mask & 0xFFFFFFFF)).to_bytes(4, "big")
        self.mtu = mtu
        self.limits = limits or Limits()
        self.counters: dict[str, int] = {}
        self._chance = (seed * 2654435761 + 12345) % (1 << 32)
        self._identification = self._next_chance() >> 16
        self._frames: list[bytes] = []
        self._events: list[Any] = []
        self._echoes: dict[int, tuple[bytes, float]] = {}  # sequence -> whom, when
        self._sequence = 0
        self._identifier = self._next_chance() >> 16
        self.endpoints: dict[int, Endpoint] = {}
        self.reassembly = Reassembly(self.limits, self.count)
        self.groups = Groups(self._send_igmp, self._fraction)

    # -- the link: what differs

    def _link(self, destination: bytes, packets: "list[bytes]", now: float) -> bool:
        """Packets, the parts of one datagram, on their way to one address or all; false where there is none."""
        raise NotImplementedError

    def _link_to_group(self, group: bytes, packet: bytes) -> None:
        """A packet to a multicast group."""
        raise NotImplementedError

    # -- what a runtime does

    def frames_to_send(self, now: float) -> "list[bytes]":
        """Everything that is to be sent now, as the link carries it."""
        found, self._frames = self._frames, []
        return found

    def next_event(self) -> "Any":
        """What happened since, oldest first; None where nothing did."""
        return self._events.pop(0) if self._events else None

    def deadline(self) -> "float | None":
        """When `frames_to_send` has something, or `handle_deadline` something to do."""
        if self._frames:
            return 0.0
        times = [self.reassembly.deadline(), self.groups.deadline()]
        times += [when + ECHO_TIMEOUT for _, when in self._echoes.values()]
        due = [at for at in times if at is not None]
        return min(due) if due else None

    def handle_deadline(self, now: float) -> None:
        """Do what is due."""
        self.reassembly.handle_deadline(now)
        self.groups.handle_deadline(now)
        for sequence in [one for one, (_, when) in self._echoes.items() if when + ECHO_TIMEOUT <= now]:
            self._tell(events.EchoLost(ipv4.text_of(self._echoes.pop(sequence)[0]), sequence))

    # -- what an owner does

    def open(self, port: int = 0) -> Endpoint:
        """A UDP port; any free one for 0. Raises ValueError where it is taken, or there are too many."""
        if not 0 <= port <= LAST_PORT:
            raise ValueError("no port is %d" % port)
        if len(self.endpoints) >= self.limits.endpoints:
            raise ValueError("more than %d ports" % self.limits.endpoints)
        if not port:
            port = EPHEMERAL + (self._next_chance() >> 16) % (LAST_PORT - EPHEMERAL + 1)
            while port in self.endpoints:
                port = port + 1 if port < LAST_PORT else EPHEMERAL
        if port in self.endpoints:
            raise ValueError("port %d is taken" % port)
        self.endpoints[port] = Endpoint(self, port)
        return self.endpoints[port]

    def ping(self, address: str, now: float, data: "bytes | bytearray | memoryview" = bytes(56)) -> int:
        """Send an echo request; its sequence number, which an EchoReplied or an EchoLost will have. Raises ValueError for
        what is no address of one host, for too much data, and where too many are under way."""
        ip = ipv4.octets_of(address)
        if ipv4.is_multicast(ip) or ip in (ALL_BROADCAST, self._broadcast, NO_ADDRESS):
            raise ValueError("%s is not the address of one host" % address)
        if len(data) > MAX_ECHO:
            raise ValueError("an echo holds at most %d octets, not %d" % (MAX_ECHO, len(data)))
        if len(self._echoes) >= self.limits.echoes:
            raise ValueError("more than %d echoes under way" % self.limits.echoes)
        self._sequence = (self._sequence + 1) & 0xFFFF
        self._echoes[self._sequence] = ip, now
        request = Echo(icmp.ECHO_REQUEST, self._identifier, self._sequence, data)
        self._send(ip, ipv4.ICMP, request.emit(), now)
        return self._sequence

    # -- what its endpoints and parts do

    def count(self, reason: str) -> None:
        """Something was dropped."""
        self.counters[reason] = self.counters.get(reason, 0) + 1

    def send_datagram(
        self,
        endpoint: Endpoint,
        data: "bytes | bytearray | memoryview",
        destination: bytes,
        port: int,
        now: float,
    ) -> bool:
        """See `Endpoint.send`."""
        if not 0 < port <= LAST_PORT:
            raise ValueError("no datagram goes to port %d" % port)
        if len(data) > MAX_UDP:
            raise ValueError("a datagram holds at most %d octets, not %d" % (MAX_UDP, len(data)))
        if destination == self.ip or ipv4.is_multicast(destination):
            self._deliver(bytes(data), (self.address, endpoint.port), destination, port, endpoint)
            if destination == self.ip:
                return True
        datagram = Datagram(endpoint.port, port, data).emit(self.ip, destination)
        return self._send(destination, ipv4.UDP, datagram, now)

    def join(self, group: bytes, now: float) -> None:
        """See `Endpoint.join`."""
        if not ipv4.is_multicast(group):
            raise ValueError("%s is no multicast group" % ipv4.text_of(group))
        if group not in self.groups.joined and len(self.groups.joined) >= self.limits.groups:
            raise ValueError("more than %d groups" % self.limits.groups)
        self.groups.join(group, now)

    def leave(self, group: bytes) -> None:
        """See `Endpoint.leave`."""
        self.groups.leave(group)

    def forget(self, endpoint: Endpoint) -> None:
        """See `Endpoint.close`."""
        self.endpoints.pop(endpoint.port, None)

    # -- receiving

    def _near(self, ip: bytes) -> bool:
        return int.from_bytes(ip, "big") & self._mask == self._network

    def _receive_ipv4(self, packet: Packet, now: float) -> None:
        destination = packet.destination
        single = destination == self.ip
        if not (single or destination in (ALL_BROADCAST, self._broadcast) or self.groups.has(destination)):
            self.count("ipv4-not-for-us")
            return
        if ipv4.is_multicast(packet.source) or packet.source in (ALL_BROADCAST, self._broadcast):
            self.count("ipv4-source-a-group")
            return
        if packet.is_fragment:
            whole = self.reassembly.add(packet, now)
            if whole is None:
                return
            packet = whole
        if packet.protocol == ipv4.UDP:
            datagram = udp.parse(packet.payload, packet.source, destination)
            source = (ipv4.text_of(packet.source), datagram.source_port)
            if not self._deliver(bytes(datagram.payload), source, destination, datagram.destination_port):
                self.count("udp-port-closed")
        elif packet.protocol == ipv4.ICMP:
            self._receive_echo(icmp.parse(packet.payload), packet.source, single, now)
        elif packet.protocol == ipv4.IGMP:
            if not self.groups.receive(igmp.parse(packet.payload), now):
                self.count("igmp-type-unknown")
        else:
            self.count("ipv4-protocol-unknown")

    def _receive_echo(self, echo: Echo, source: bytes, single: bool, now: float) -> None:
        if echo.kind == icmp.ECHO_REQUEST:
            # RFC 1122, 3.2.2.6: one to a group may be left without an answer, and would raise a storm.
            if single:
                reply = Echo(icmp.ECHO_REPLY, echo.identifier, echo.sequence, echo.data)
                self._send(source, ipv4.ICMP, reply.emit(), now)
            else:
                self.count("icmp-to-a-group")
            return
        asked = self._echoes.get(echo.sequence)
        if echo.identifier != self._identifier or asked is None or asked[0] != source:
            self.count("icmp-reply-unasked")
            return
        del self._echoes[echo.sequence]
        self._tell(events.EchoReplied(ipv4.text_of(source), echo.sequence, bytes(echo.data), now - asked[1]))

    def _deliver(
        self,
        data: bytes,
        source: "tuple[str, int]",
        destination: bytes,
        port: int,
        sender: "Endpoint | None" = None,
    ) -> bool:
        """To the endpoint of the port; to one that has joined, where the destination is a group. Whether there was one."""
        endpoint = self.endpoints.get(port)
        if endpoint is None:
            return False
        if ipv4.is_multicast(destination) and (endpoint is sender or destination not in endpoint.groups):
            return False
        reason = endpoint.deliver(data, source)
        if reason:
            self.count(reason)
        return True

    # -- sending

    def _send(self, destination: bytes, protocol: int, payload: "bytes | bytearray", now: float) -> bool:
        """One datagram, in fragments where it must be; false where there is no way."""
        self._identification = (self._identification + 1) & 0xFFFF
        multicast = ipv4.is_multicast(destination)
        packet = Packet(
            self.ip,
            destination,
            protocol,
            payload,
            self._identification,
            MULTICAST_TTL if multicast else ipv4.DEFAULT_TTL,
        )
        packets = [bytes(part.emit()) for part in ipv4.fragments(packet, self.mtu)]
        if not multicast:
            return self._link(destination, packets, now)
        for one in packets:
            self._link_to_group(destination, one)
        return True

    def _send_igmp(self, destination: bytes, message: Igmp) -> None:
        packet = Packet(
            self.ip, destination, ipv4.IGMP, message.emit(), 0, MULTICAST_TTL, options=igmp.ROUTER_ALERT
        )
        self._link_to_group(destination, bytes(packet.emit()))

    def _put(self, frame: bytes) -> None:
        if len(self._frames) >= self.limits.frames:
            self.count("frames-full")
            return
        self._frames.append(frame)

    def _tell(self, event: "Any") -> None:
        if len(self._events) >= self.limits.events:
            self.count("events-full")
            return
        self._events.append(event)

    # -- chance

    def _next_chance(self) -> int:
        """A linear congruential generator, good enough to keep hosts apart; the same on every interpreter."""
        self._chance = (self._chance * 1664525 + 1013904223) % (1 << 32)
        return self._chance

    def _fraction(self) -> float:
        return self._next_chance() / (1 << 32)
