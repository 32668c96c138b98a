"""UDP sockets around an RTPS participant: discovery by multicast, everything else unicast. IPv4 only.

Sends what the participant has pending and re-arms one timer; its events go to one function, in the loop's thread, with the
reactor's lock held.
"""

from __future__ import annotations

import os
import socket
import struct
import time
from time import monotonic

from roslet.engine.rtps.participant import Participant
from roslet.engine.rtps.writer import HEARTBEAT_DELAY
from roslet.errors import Unreachable
from roslet.io.memory import keep_large_blocks
from roslet.wire.rtps import locator
from roslet.wire.rtps.guid import VENDORID_ROSLET

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

    from roslet.engine.rtps.outbox import Address
    from roslet.io.select import Reactor, Timer

GROUP = "239.255.0.1"
LOOPBACK = "127.0.0.1"
# Participants of one host and domain: the ports of more would run into those of the next domain.
MAX_PARTICIPANT_ID = 119
# Participant ids that are announced to on this host where multicast does not work.
UNICAST_IDS = 10
# Octets of the kernel's receive buffer; it grants less where net.core.rmem_max says so.
RECEIVE_BUFFER = 4 << 20
# Addresses of which it is remembered how they are reached.
MAX_WAYS = 4096
# Datagrams read in one go before others get their turn.
BATCH = 64
# Octets of a datagram that is likely a part of a large message: their memory is worth keeping.
LARGE = 32 << 10
_SIOCGIFADDR = 0x8915  # linux/sockios.h


def interface_addresses() -> list[str]:
    """The IPv4 address of each interface that has one, loopback last. Linux; elsewhere loopback and the default route's."""
    found: list[str] = []
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            import fcntl

            for _, name in socket.if_nameindex():
                request = struct.pack("256s", name.encode()[:15])
                try:
                    reply = fcntl.ioctl(probe.fileno(), _SIOCGIFADDR, request)
                except OSError:
                    continue  # an interface without IPv4
                found.append(socket.inet_ntoa(reply[20:24]))
        except ImportError:
            try:
                probe.connect((GROUP, 7400))
                found.append(probe.getsockname()[0])
            except OSError:
                found.append(LOOPBACK)
    found.sort(key=lambda address: address.startswith("127."))
    return found or [LOOPBACK]


def new_guid_prefix() -> bytes:
    """Our vendor id, the process, and chance."""
    return VENDORID_ROSLET + struct.pack(">H", os.getpid() & 0xFFFF) + os.urandom(8)


class Domain:
    """One participant of a domain and its sockets, on a reactor.

    `addresses`: of the interfaces to use, all of them where None; loopback only if there is no other, or `localhost`.
    `peers`: hosts or (host, port) that are announced to besides the multicast group. `fields` go to the Participant.
    Call `flush()` after every call of the participant. Raises Unreachable where no port is free.
    """

    def __init__(
        self,
        reactor: Reactor,
        on_event: Callable[[Any], None],
        domain_id: int = 0,
        addresses: Sequence[str] | None = None,
        localhost: bool = False,
        peers: Sequence[str | Address] = (),
        **fields: Any,
    ) -> None:
        if not 0 <= domain_id <= locator.MAX_DOMAIN_ID:
            raise ValueError(f"a domain id is 0 to {locator.MAX_DOMAIN_ID}, not {domain_id}")
        self.reactor = reactor
        self.domain_id = domain_id
        self.addresses = [LOOPBACK] if localhost else self._usable(addresses)
        self.errors: dict[str, int] = {}
        self._on_event = on_event
        self._timer: Timer | None = None
        self._armed = 0.0
        self._closed = False
        self._buffer = bytearray(65536)
        self._view = memoryview(self._buffer)
        self.participant_id, self._meta, self._user = self._bind(domain_id)
        self._group = self._join()
        self._senders = self._multicast_senders()
        self._ways: dict[Address, Sequence[socket.socket]] = {}
        group = (GROUP, locator.metatraffic_multicast_port(domain_id))
        announce_to: list[Address] = [group] if self._senders and self._group is not None else []
        for peer in peers:
            if isinstance(peer, str):
                for number in range(UNICAST_IDS):
                    announce_to.append((peer, locator.metatraffic_unicast_port(domain_id, number)))
            else:
                announce_to.append(peer)
        if not announce_to:
            for number in range(UNICAST_IDS):
                announce_to.append((LOOPBACK, locator.metatraffic_unicast_port(domain_id, number)))
        meta_port = self._meta.getsockname()[1]
        user_port = self._user.getsockname()[1]
        self.participant = Participant(
            fields.pop("guid_prefix", None) or new_guid_prefix(),
            domain_id,
            tuple(locator.udp4(one, meta_port) for one in self.addresses),
            tuple(locator.udp4(one, user_port) for one in self.addresses),
            tuple(announce_to),
            epoch=time.time_ns() - int(time.monotonic() * 1e9),
            **fields,
        )
        for one in (self._meta, self._user, self._group):
            if one is not None:
                reactor.register(one.fileno(), self._reader_of(one))
        with reactor.lock:
            self.participant.start(reactor.now())
            self.flush()

    # -- sockets

    @staticmethod
    def _usable(addresses: Sequence[str] | None) -> list[str]:
        found = list(addresses) if addresses is not None else interface_addresses()
        outside = [one for one in found if not one.startswith("127.")]
        return outside or found[:1] or [LOOPBACK]

    @staticmethod
    def _bind(domain_id: int) -> tuple[int, socket.socket, socket.socket]:
        """The first participant id whose two ports are free, and sockets on them."""
        for number in range(MAX_PARTICIPANT_ID + 1):
            meta = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
            user = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
            try:
                meta.bind(("", locator.metatraffic_unicast_port(domain_id, number)))
                user.bind(("", locator.user_unicast_port(domain_id, number)))
            except OSError:
                meta.close()
                user.close()
                continue
            for one in (meta, user):
                one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
            return number, meta, user
        raise Unreachable(f"no free ports for another participant of domain {domain_id} on this host")

    def _join(self) -> socket.socket | None:
        """The socket of the group, joined on every interface; None where none can."""
        group = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        group.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if hasattr(socket, "SO_REUSEPORT"):
            group.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        joined = False
        try:
            group.bind(("", locator.metatraffic_multicast_port(self.domain_id)))
            for address in self.addresses:
                try:
                    request = socket.inet_aton(GROUP) + socket.inet_aton(address)
                    group.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, request)
                    joined = True
                except OSError as error:
                    self._failed("join", error)
        except OSError as error:
            self._failed("bind", error)
        if joined:
            return group
        group.close()
        return None

    def _multicast_senders(self) -> list[socket.socket]:
        """One socket an interface, for what goes to groups."""
        found = []
        for address in self.addresses:
            sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(address))
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)
            found.append(sender)
        return found

    def _failed(self, what: str, error: OSError) -> None:
        name = f"{what}-{os.strerror(error.errno or 0).lower().replace(' ', '-')}"
        self.errors[name] = self.errors.get(name, 0) + 1

    # -- the loop

    def _reader_of(self, one: socket.socket) -> Callable[[int], None]:
        receive = one.recvfrom_into
        buffer, view = self._buffer, self._view
        # How many are read before the loop looks again: one by one while they come one by one, for a look in vain costs as
        # much as reading; more while they come faster.
        batch = 1

        def readable(_: int) -> None:
            nonlocal batch
            participant = self.participant
            take = participant.receive_datagram
            now = monotonic()
            count = 0
            while count < batch:
                try:
                    size, source = receive(buffer)
                except BlockingIOError:
                    break
                except OSError as error:
                    # An ICMP error for something sent earlier; the socket goes on.
                    self._failed("receive", error)
                    size = 0
                count += 1
                if size:
                    take(view[:size], source, now)
                    if participant.pending_events:
                        self._tell()
                    if self._closed:
                        return
                    if size >= LARGE:
                        keep_large_blocks()
            batch = min(2 * batch, BATCH) if count == batch else max(count, 1)
            self.flush()

        return readable

    def _tell(self) -> None:
        for event in self.participant.take_events():
            self._on_event(event)

    def flush(self) -> None:
        """Do what is due, send what is pending, and wake up in time for the rest. Call it with the reactor's lock held."""
        if self._closed:
            return
        now = monotonic()
        participant = self.participant
        participant.handle_deadline(now)
        for parts, addresses in participant.datagrams_to_send(now):
            self._send(parts, addresses)
        if participant.pending_events:
            self._tell()
        at = participant.deadline()
        if at is None:
            return
        if self._timer is not None and self._timer.function is not None:
            if self._armed <= at:
                return
            self._timer.cancel()
        self._armed = at
        self._timer = self.reactor.call_at(at, self._due)

    def send(self, now: float) -> None:
        """The short way after `Writer.write`: send what is pending, and leave what is not urgent to the timer if it goes off
        in time. `now` as given to `write`; with the reactor's lock held."""
        if self._timer is None or self._armed > now + HEARTBEAT_DELAY or self._closed:
            self.flush()
            return
        outbox = self.participant.outbox
        for parts, addresses in outbox.take(now):
            self._send(parts, addresses)
        if outbox.deadline() is not None:
            self.flush()

    def _due(self) -> None:
        self._timer = None
        self.flush()

    def _send(self, parts: Any, addresses: Sequence[Address]) -> None:
        for address in addresses:
            senders = self._ways.get(address) or self._way(address)
            for sender in senders:
                try:
                    if len(parts) == 1:
                        sender.sendto(parts[0], address)
                    else:
                        sender.sendmsg(parts, [], 0, address)
                except OSError as error:
                    # As good as lost on the way; reliable writers send it again.
                    self._failed("send", error)

    def _way(self, address: Address) -> Sequence[socket.socket]:
        """The sockets that reach an address: the user socket, or one for each interface where it is a group."""
        if len(self._ways) >= MAX_WAYS:
            self._ways.clear()
        first = int(address[0].partition(".")[0])
        self._ways[address] = found = self._senders if 224 <= first < 240 else (self._user,)
        return found

    def close(self) -> None:
        """Depart and close the sockets."""
        with self.reactor.lock:
            if self._closed:
                return
            now = self.reactor.now()
            self.participant.close(now)
            for parts, addresses in self.participant.datagrams_to_send(now):
                self._send(parts, addresses)
            self._closed = True
            if self._timer is not None:
                self._timer.cancel()
            for one in (self._meta, self._user, self._group):
                if one is not None:
                    self.reactor.unregister(one.fileno())
                    one.close()
            for one in self._senders:
                one.close()
