"""UDP sockets around an RTPS participant: discovery by multicast, everything else unicast. IPv4 only.

Sends what the participant has pending and re-arms one timer; its events go to one function, in the loop's thread, with the
reactor's lock held.
"""

from __future__ import annotations

import errno
import socket
import struct
import sys
from time import monotonic

from roslet.errors import Unreachable
from roslet.io.domain import GROUP, ParticipantShell
from roslet.io.interfaces import LOOPBACK, Interface, Watch, choose, interfaces, require
from roslet.io.memory import keep_large_blocks
from roslet.io.resolver import AGAIN, Resolver, literal
from roslet.names import OFF, SUBNET, SYSTEM_DEFAULT, Ros2Network
from roslet.wire.rtps import locator

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

    from roslet.engine.rtps.outbox import Address
    from roslet.io.select import Reactor, Timer
    from roslet.wire.rtps.locator import Locator

# Participants of one host and domain: the ports of more would run into those of the next domain.
MAX_PARTICIPANT_ID = 119
# Participant ids of a host that are announced to where a peer is given without a port, as Fast DDS and Cyclone do it, and on
# this host where multicast is not used.
UNICAST_IDS = 32
# Seconds between an interface's change and our look at it: one change comes in several messages.
SETTLE = 0.2
# Seconds between looks where nothing tells of changes.
RESCAN = 5.0
# Octets of the kernel's receive buffer; it grants less where net.core.rmem_max says so.
RECEIVE_BUFFER = 4 << 20
# Addresses of which it is remembered how they are reached.
MAX_WAYS = 4096
# Datagrams read in one go before others get their turn.
BATCH = 64
# Octets of a datagram that is likely a part of a large message: their memory is worth keeping.
LARGE = 32 << 10
_IP_MULTICAST_ALL = 49  # linux/in.h


class Domain(ParticipantShell):
    """One participant of a domain and its sockets, on a reactor.

    `network`: which domain, over which interfaces, and how far; a domain id alone means all interfaces and SUBNET. With the
    range LOCALHOST the group is neither joined nor sent to: participants of this host are sought by unicast, and whoever
    seeks us by unicast is taken, so that static peers work if either side has them. With OFF nobody is taken. Interfaces
    may come and go, after the start: `addresses` are those in use, and peers are told.

    `warn(text)` hears of what goes wrong behind the caller's back; standard error if None. `fields` go to the Participant.
    Call `flush()` after every call of the participant. Raises Unreachable where no port is free, or an interface that the
    network names is not there.
    """

    def __init__(
        self,
        reactor: Reactor,
        on_event: Callable[[Any], None],
        network: Ros2Network | int = 0,
        warn: Callable[[str], None] | None = None,
        **fields: Any,
    ) -> None:
        if isinstance(network, int):
            network = Ros2Network(network)
        if not 0 <= network.domain_id <= locator.MAX_DOMAIN_ID:
            raise ValueError(f"a domain id is 0 to {locator.MAX_DOMAIN_ID}, not {network.domain_id}")
        found = interfaces()
        require(found, network.interfaces)
        super().__init__(reactor, on_event, network, warn)
        self._buffer = bytearray(65536)
        self._view = memoryview(self._buffer)
        self.participant_id, self._meta, self._user = self._bind(self.domain_id)
        self._group = self._group_socket() if network.range in (SUBNET, SYSTEM_DEFAULT) else None
        # By number and address of an interface: the socket for what goes to groups there. `_senders` are the same.
        self._joined: dict[tuple[int, str], socket.socket] = {}
        self._senders: list[socket.socket] = []
        self._ways: dict[Address, Sequence[socket.socket]] = {}
        self._resolved: dict[str, tuple[str, ...]] = {
            host: (host,) for host, _ in network.peers if literal(host)
        }
        self._interfaces: list[Interface] = []
        self._use(choose(found, network.interfaces))
        own = self._locators()
        self.participant = self._make(
            own["metatraffic_unicast"],
            own["default_unicast"],
            own["metatraffic_multicast"],
            self._announce_to(),
            self._networks(),
            fields,
        )
        for one in (self._meta, self._user, self._group):
            if one is not None:
                reactor.register(one.fileno(), self._reader_of(one))
        self._look: Timer | None = None
        self._watch = self._watching()
        names = {host for host, _ in network.peers if host not in self._resolved}
        self._resolver = Resolver(reactor, sorted(names), self._peer_found, self._peer_missing)
        with reactor.lock:
            self.participant.start(reactor.now())
            self.flush()

    # -- interfaces

    @property
    def addresses(self) -> list[str]:
        """Of our interfaces in use, now."""
        return [one.address for one in self._interfaces]

    def _use(self, chosen: list[Interface]) -> None:
        """Join the group on these interfaces and no others."""
        self._interfaces = chosen
        wanted: dict[int, str] = {}
        for one in chosen:
            if one.multicast and self._group is not None:
                wanted.setdefault(one.number, one.address)
        for number, address in list(self._joined):
            if wanted.get(number) != address:
                self._joined.pop((number, address)).close()
                self._membership(socket.IP_DROP_MEMBERSHIP, number, address)
        for number, address in wanted.items():
            if (number, address) not in self._joined and self._membership(
                socket.IP_ADD_MEMBERSHIP, number, address
            ):
                try:
                    self._joined[number, address] = self._multicast_sender(number, address)
                except OSError as error:
                    self._failed("join", error)  # it has just gone; the watch will say so
        self._senders = list(self._joined.values())
        self._ways = {}

    def _membership(self, option: int, number: int, address: str) -> bool:
        """Join or leave the group on one interface; whether that worked."""
        assert self._group is not None
        try:
            self._group.setsockopt(
                socket.IPPROTO_IP, option, socket.inet_aton(GROUP) + self._interface(number, address)
            )
        except OSError as error:
            self._failed("join" if option == socket.IP_ADD_MEMBERSHIP else "leave", error)
            return False
        return True

    @staticmethod
    def _interface(number: int, address: str) -> bytes:
        """How an ip_mreq or an ip_mreqn names an interface; the number counts where it is known."""
        return socket.inet_aton(address) + (struct.pack("=i", number) if number else b"")

    def _locators(self) -> dict[str, tuple[Locator, ...]]:
        meta_port, user_port = self._meta.getsockname()[1], self._user.getsockname()[1]
        group = locator.udp4(GROUP, locator.metatraffic_multicast_port(self.domain_id))
        return {
            "metatraffic_unicast": tuple(locator.udp4(one, meta_port) for one in self.addresses),
            "default_unicast": tuple(locator.udp4(one, user_port) for one in self.addresses),
            "metatraffic_multicast": (group,) if self._joined else (),
        }

    def _networks(self) -> tuple[tuple[str, int], ...]:
        return tuple((one.address, one.bits) for one in self._interfaces)

    def _announce_to(self) -> tuple[Address, ...]:
        network = self.network
        if network.range == OFF:
            return ()
        found: list[Address] = []
        if self._joined:
            found.append((GROUP, locator.metatraffic_multicast_port(self.domain_id)))
        if not self._joined or all(one.loopback for one in self._interfaces):
            # On a host with nothing but loopback others may not use multicast, although we can.
            found += self._ports_of(LOOPBACK)
        for host, port in network.peers:
            for address in self._resolved.get(host, ()):
                found += self._ports_of(address) if port is None else [(address, port)]
        return tuple(dict.fromkeys(found))

    def _ports_of(self, address: str) -> list[Address]:
        """Where participants of a host may listen; not our own port on this one."""
        skip = self.participant_id if address == LOOPBACK or address in self.addresses else -1
        return self._ports_from(address, [one for one in range(UNICAST_IDS) if one != skip])

    def _watching(self) -> Watch | None:
        try:
            watch = Watch()
        except (OSError, AttributeError):
            self._look = self.reactor.call_at(self.reactor.now() + RESCAN, self._rescan)
            return None
        self.reactor.register(watch.fileno(), self._changed)
        return watch

    def _changed(self, _: int) -> None:
        assert self._watch is not None
        self._watch.drain()
        if self._look is None:
            self._look = self.reactor.call_at(self.reactor.now() + SETTLE, self._rescan)

    def _rescan(self) -> None:
        self._look = None
        if self._closed:
            return
        if self._watch is None:
            self._look = self.reactor.call_at(self.reactor.now() + RESCAN, self._rescan)
        chosen = choose(interfaces(), self.network.interfaces)
        # Where nothing is left, what was stays announced: it may come back, and a locator list must not be empty.
        if chosen and chosen != self._interfaces:
            self._use(chosen)
            self._move()

    def _move(self) -> None:
        own = self.participant.spdp.own.replace(**self._locators())
        self.participant.move(own, self._announce_to(), self._networks(), self.reactor.now())
        self.flush()

    def _peer_found(self, host: str, addresses: tuple[str, ...]) -> None:
        self._resolved[host] = addresses
        self._move()

    def _peer_missing(self, host: str, reason: str) -> None:
        self._warn(f"the static peer {host} has no address ({reason}); asking again every {AGAIN:.0f} s")

    # -- sockets

    @staticmethod
    def _bind(domain_id: int) -> tuple[int, socket.socket, socket.socket]:
        """The first participant id whose two ports are free, and sockets on them."""
        number = 0
        while number <= MAX_PARTICIPANT_ID and locator.user_unicast_port(domain_id, number) < 65536:
            meta = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
            user = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
            try:
                meta.bind(("", locator.metatraffic_unicast_port(domain_id, number)))
                user.bind(("", locator.user_unicast_port(domain_id, number)))
            except OSError as error:
                meta.close()
                user.close()
                if error.errno != errno.EADDRINUSE:
                    raise Unreachable(f"no socket for domain {domain_id}: {error}") from error
                number += 1
                continue
            for one in (meta, user):
                one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, RECEIVE_BUFFER)
            return number, meta, user
        raise Unreachable(
            f"domain {domain_id} has no room for another participant on this host: the ports of all {number} are taken"
        )

    def _group_socket(self) -> socket.socket | None:
        """A socket on the group's port, which all participants of a host share; None where somebody does not share it."""
        group = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        group.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if hasattr(socket, "SO_REUSEPORT"):
            group.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        try:
            if sys.platform == "linux":
                # Otherwise Linux hands over what other sockets have joined, on interfaces that we are not to use.
                group.setsockopt(socket.IPPROTO_IP, _IP_MULTICAST_ALL, 0)
            group.bind(("", locator.metatraffic_multicast_port(self.domain_id)))
        except OSError as error:
            self._failed("bind", error)
            group.close()
            return None
        return group

    def _multicast_sender(self, number: int, address: str) -> socket.socket:
        """A socket for what goes to groups by one interface. It works without a route: the interface is given."""
        interface = self._interface(number, address)
        sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        try:
            sender.setsockopt(
                socket.IPPROTO_IP, socket.IP_MULTICAST_IF, bytes(4) + interface if number else interface
            )
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
            sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)
        except OSError:
            sender.close()
            raise
        return sender

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
                    self._count("datagram-not-sent")

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
            self._resolver.close()
            for timer in (self._timer, self._look):
                if timer is not None:
                    timer.cancel()
            if self._watch is not None:
                self.reactor.unregister(self._watch.fileno())
                self._watch.close()
            for one in (self._meta, self._user, self._group):
                if one is not None:
                    self.reactor.unregister(one.fileno())
                    one.close()
            for one in self._senders:
                one.close()

    def abandon(self) -> None:
        """In a forked child: close the parent's sockets, and touch nothing else."""
        self._closed = True
        self._resolver.abandon()
        for one in (self._meta, self._user, self._group, self._watch, *self._senders):
            if one is not None:
                one.close()
