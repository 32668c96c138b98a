"""One participant of a ROS 2 domain on MicroPython: its sockets, its context, and when they want to be looked after."""

import gc
import os

from roslet.engine.ros2 import user_data
from roslet.engine.ros2.context import Context
from roslet.engine.rtps.participant import Participant
from roslet.errors import Unreachable
from roslet.io.micropython import sockets
from roslet.wire.discovery_info import TOPIC
from roslet.wire.rtps import locator
from roslet.wire.rtps.guid import VENDORID_ROSLET

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.limits import Limits
    from roslet.io.micropython.loop import Loop
    from roslet.names.networks import Ros2Network

GROUP = "239.255.0.1"
# Participants of one host that are sought where the group is not used, or a peer is given without a port.
UNICAST_IDS = 8
MAX_PARTICIPANT_ID = 119
_WRITES, _READS = 1, 2
# Octets around a sample in a datagram, and behind it, at most as nearly all peers send them.
AROUND = 256
# Seconds after which a sample is read with its source again, which renews its participant's lease.
WITH_SOURCE = 1.0


class Domain:
    """`datagram`: the longest datagram that is taken, bytes; longer ones are cut and then dropped as malformed. `fragment`:
    the most of a sample that goes into one. Call `flush()` after every call of participant or context."""

    def __init__(
        self, loop: "Loop", network: "Ros2Network", datagram: int, fragment: int, limits: "Limits"
    ) -> None:
        self.loop = loop
        self.network = network
        self._datagram = datagram
        self._handlers: dict[bytes, Callable[[Any], None]] = {}
        self._closed = False
        self._relearn = False
        # What leaves in parts is put together here: MicroPython gathers nothing.
        self._out = memoryview(bytearray(fragment + 512))
        self._whole = self._out
        # Samples come in here, where the largest that may come is known.
        self._room = memoryview(bytearray(sockets.FIRST))
        self._bounded = True
        self._reading = False  # whether somebody may be looking at what lies there
        self._with_source = 0.0  # when the next is read with its source
        self._meta, self._user, self.participant_id = self._bind()
        # Of `interface=` only addresses are known here.
        found = list(network.interfaces) or sockets.own_addresses()
        self.addresses = found or [sockets.LOOPBACK]
        self._group: Any = None
        self._senders: list[Any] = []
        if network.range != "LOCALHOST" and network.range != "OFF":
            self._join()
        domain = network.domain_id
        meta_port = locator.metatraffic_unicast_port(domain, self.participant_id)
        user_port = locator.user_unicast_port(domain, self.participant_id)
        group_port = locator.metatraffic_multicast_port(domain)
        self.participant = Participant(
            VENDORID_ROSLET + os.urandom(10),
            domain,
            tuple([locator.udp4(one, meta_port) for one in self.addresses]),
            tuple([locator.udp4(one, user_port) for one in self.addresses]),
            self._announce_to(group_port),
            epoch=loop.epoch,
            user_data=user_data.pair("enclave", "/"),
            name="/",
            fragment_size=fragment,
            far_fragment_size=fragment,
            match_own=False,
            limits=limits,
            multicast=(locator.udp4(GROUP, group_port),) if self._group is not None else (),
        )
        self.context = Context(self.participant, listens=False)
        self._topics: dict[
            str, int
        ] = {}  # ours, and what of them; others' endpoints are kept if they may match
        self._dropped = False  # whether there was any of those
        self.participant.keep_only(self._is_ours)
        self.participant.outbox.at_once = self._send_at_once
        loop.register(self._user, self._read_samples)
        for sock in (self._meta, self._group):
            if sock is not None:
                loop.register(sock, self._reader_of(sock))
        now = loop.now()
        self.participant.start(now)
        self.expect(TOPIC, True)
        self.context.start(now)
        loop.timed.append(self)
        self.flush()

    def _bind(self) -> "tuple[Any, Any, int]":
        domain = self.network.domain_id
        for number in range(MAX_PARTICIPANT_ID + 1):
            try:
                meta = sockets.datagrams(locator.metatraffic_unicast_port(domain, number))
            except OSError:
                continue
            try:
                return meta, sockets.datagrams(locator.user_unicast_port(domain, number)), number
            except OSError:
                meta.close()
        raise Unreachable("domain %d has no free port on this host" % domain)

    def _join(self) -> None:
        try:
            group = sockets.datagrams(locator.metatraffic_multicast_port(self.network.domain_id), True)
        except OSError:
            return
        for one in self.addresses:
            if sockets.join(group, GROUP, one):
                self._senders.append(sockets.group_sender(one))
        if self._senders:
            self._group = group
        else:
            group.close()

    def _announce_to(self, group_port: int) -> "tuple[tuple[str, int], ...]":
        found = []
        network = self.network
        if network.range == "OFF":
            return ()
        if self._group is not None:
            found.append((GROUP, group_port))
        if self._group is None or self.addresses == [sockets.LOOPBACK]:
            # On a host with nothing but loopback others may not use the group, although we can.
            found += self._ports_of(sockets.LOOPBACK)
        for host, port in network.peers:
            host = sockets.host(sockets.address(host, port or 1))
            found += self._ports_of(host) if port is None else [(host, port)]
        return tuple(found)

    def _ports_of(self, host: str) -> "list[tuple[str, int]]":
        own = self.participant_id if host == sockets.LOOPBACK or host in self.addresses else -1
        domain = self.network.domain_id
        return [
            (host, locator.metatraffic_unicast_port(domain, one)) for one in range(UNICAST_IDS) if one != own
        ]

    # -- in

    def _reader_of(self, sock: "Any") -> "Callable[[int], None]":
        def readable(events: int) -> None:
            self._read(sock)

        return readable

    def _read(self, sock: "Any") -> None:
        # One, as the poller tells of the next: a look in vain leaves an exception, and the room for what is not there.
        if self._closed:
            return
        try:
            data, raw = sockets.receive(sock, self._datagram)
        except OSError:
            return
        except MemoryError:
            self._no_memory(sock)
            return
        source = (sockets.host(raw), 0)  # nobody asks for its port
        self.participant.receive_datagram(data, source, self.loop.now())
        self._tell()
        self.flush()

    def _no_memory(self, sock: "Any") -> None:
        """The heap is full, or in pieces. The datagram goes, or what is behind it would never be read; what it said comes
        again, or is reported lost."""
        gc.collect()
        sock.recv(1)
        self._count("no-memory-for-datagram")

    def take_in(self, kind: "Any") -> None:
        """Messages of this class are about to come: from then on the room is that of the largest, if there is a largest."""
        size = kind._maximum_size
        if size is None or size + AROUND > self._datagram:
            self._bounded = False
        elif size + AROUND > len(self._room):
            self._room = memoryview(bytearray(size + AROUND))

    def _read_samples(self, events: int) -> None:
        """Mostly without asking where from, which is garbage; what is like an earlier one is told by windows on the room.
        (`readinto` takes no datagram but all that wait, as one; so one is copied.)"""
        now = self.loop.now()
        if self._reading or not self._bounded or now >= self._with_source:
            self._with_source = now + WITH_SOURCE
            self._read(self._user)
            return
        room = self._room
        try:
            data = self._user.recv(len(room))
        except OSError:
            return
        except MemoryError:
            self._no_memory(self._user)
            return
        count = len(data)
        room[:count] = data
        self._reading = True
        try:
            self.participant.receive_again(room, count, now)
        finally:
            self._reading = False
        if count == len(room) < self._datagram:
            # It may have been cut: the whole submessages of it were taken, and the rest will be asked for again.
            self._room = memoryview(bytearray(min(2 * count, self._datagram)))
        self._tell()
        self.flush()

    def _is_ours(self, found: "Any") -> bool:
        if not self._topics.get(found.topic, 0) & (_READS if found.writer else _WRITES):
            self._dropped = True
            return False
        # Peers are often alike: what they say alike is kept once.
        for known in self.participant.endpoints.values():
            if known.topic == found.topic and known.qos == found.qos:
                found.topic, found.type_name, found.qos = known.topic, known.type_name, known.qos
                break
        return True

    def expect(self, topic: str, writes: bool) -> None:
        """An endpoint of this topic is about to be made, a writer or a reader. To be made before the node is first
        served, or peers have to say again what they have."""
        known = self._topics.get(topic, 0)
        bit = _WRITES if writes else _READS
        if not known & bit:
            self._topics[topic] = known | bit
            self._relearn = self._relearn or self._dropped

    def handle(self, entity_id: bytes, handler: "Callable[[Any], None] | None") -> None:
        """Who gets the events of an endpoint of ours; None: nobody any more."""
        if handler is None:
            self._handlers.pop(entity_id, None)
        else:
            self._handlers[entity_id] = handler

    def _tell(self) -> None:
        while self.participant.pending_events:
            event = self.participant.next_event()
            if not self.context.handle_event(event, self.loop.now()):
                handler = self._handlers.get(getattr(event, "local", b""))
                if handler is not None:
                    handler(event)

    # -- out

    def _send_at_once(self, front: "Any", rest: "Any", addresses: "Any") -> None:
        """One datagram of these two parts, to each of the addresses."""
        if self._closed:
            return
        begin = len(front)
        end = begin + len(rest)
        whole = self._place(end)
        whole[:begin] = front
        whole[begin:] = rest
        self._send_to(whole, addresses)

    def _place(self, size: int) -> memoryview:
        """Room for a datagram; for one after another of the same size the same object."""
        if len(self._whole) != size:
            if size > len(self._out):
                self._out = memoryview(bytearray(size))
            self._whole = self._out[:size]
        return self._whole

    def flush(self) -> None:
        """Send what is pending."""
        if self._closed:
            return
        now = self.loop.now()
        if self._relearn:
            self._relearn = self._dropped = False
            self.participant.spdp.relearn(now)
        for parts, addresses in self.participant.datagrams_to_send(now):
            self._send(parts, addresses)
        if self.participant.pending_events:
            self._tell()

    def _send(self, parts: "Any", addresses: "Any") -> None:
        if len(parts) == 1:
            whole = parts[0]
        else:
            size = 0
            for part in parts:
                size += len(part)
            whole = self._place(size)
            at = 0
            for part in parts:
                whole[at : at + len(part)] = part
                at += len(part)
        self._send_to(whole, addresses)

    def _send_to(self, whole: "Any", addresses: "Any") -> None:
        for one in addresses:
            where = sockets.address_of(one)
            if one[0] == GROUP:
                for sock in self._senders:
                    self._send_by(sock, whole, where)
            else:
                self._send_by(self._user, whole, where)

    def _send_by(self, sock: "Any", whole: "Any", where: "Any") -> None:
        try:
            sock.sendto(whole, where)
        except OSError:
            # As good as lost on the way; reliable writers send it again.
            self._count("datagram-not-sent")

    def _count(self, reason: str) -> None:
        counters = self.participant.counters
        counters[reason] = counters.get(reason, 0) + 1

    # -- time

    def deadline(self) -> "float | None":
        """When `handle_deadline` has something to do."""
        at = self.participant.deadline()
        other = self.context.deadline()
        return other if at is None or (other is not None and other < at) else at

    def handle_deadline(self, now: float) -> None:
        """Do what is due."""
        self.participant.handle_deadline(now)
        at = self.context.deadline()
        if at is not None and at <= now:
            self.context.handle_deadline(now)
        self._tell()
        self.flush()

    def close(self) -> None:
        """Say that the nodes are gone, depart, and close the sockets."""
        now = self.loop.now()
        self.context.close(now)
        self.flush()
        self.participant.close(now)
        self.flush()
        self._closed = True
        self.loop.timed.remove(self)
        for sock in (self._meta, self._user, self._group):
            if sock is not None:
                self.loop.unregister(sock)
                sock.close()
        for sock in self._senders:
            sock.close()
