"""A DDS-RTPS participant: what a runtime drives. RTPS 2.3, 8.2, 8.3.4 (receiver), 8.4, 8.5.

Endpoints of one participant match each other as any two do, by datagrams to itself, unless `match_own` is False: then
the node hands such samples over by its own, shorter way.
"""

from roslet.engine.rtps import events
from roslet.engine.rtps.fragments import Budget
from roslet.engine.rtps.limits import Limits
from roslet.engine.rtps.liveliness import Liveliness
from roslet.engine.rtps.outbox import Outbox
from roslet.engine.rtps.qos import incompatible
from roslet.engine.rtps.reach import addresses_of
from roslet.engine.rtps.reader import Reader
from roslet.engine.rtps.sedp import Sedp
from roslet.engine.rtps.spdp import RemoteParticipant, Spdp
from roslet.engine.rtps.writer import FRAGMENT_SIZE, Writer
from roslet.errors import ProtocolError
from roslet.wire.rtps import (
    ack_nack,
    data,
    data_frag,
    endpoint_data,
    gap,
    guid,
    header,
    heartbeat,
    heartbeat_frag,
    info_dst,
    info_src,
    info_ts,
    inline_qos,
    nack_frag,
    participant_data,
    participant_message,
    submessage,
)
from roslet.wire.rtps.data import FLAG_D, FLAG_K
from roslet.wire.rtps.endpoint_data import EndpointData
from roslet.wire.rtps.guid import ENTITYID_UNKNOWN, ENTITYKIND_BUILTIN, GUIDPREFIX_UNKNOWN
from roslet.wire.rtps.participant_message import (
    KIND_AUTOMATIC_LIVELINESS_UPDATE,
    KIND_MANUAL_LIVELINESS_UPDATE,
)
from roslet.wire.rtps.qos import AUTOMATIC
from roslet.wire.rtps.times import INFINITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.events import SampleReceived
    from roslet.engine.rtps.outbox import Address, Datagram
    from roslet.engine.rtps.reach import Network
    from roslet.engine.rtps.reader import Sink, WriterProxy
    from roslet.wire.rtps.locator import Locator
    from roslet.wire.rtps.participant_data import ParticipantData
    from roslet.wire.rtps.qos import Qos

DEFAULT_LEASE = 20.0
DEFAULT_PERIOD = 3.0
"""Seconds: how long peers believe in us without hearing of us, and between announcements; as Fast DDS has them."""


class Participant:
    """One participant of a domain.

    guid_prefix     12 octets that nobody else has: the runtime's entropy
    metatraffic, default   locators at which discovery and samples reach us
    announce_to     addresses of announcements: the multicast group, static peers
    epoch           nanoseconds of the Unix epoch when `now` is 0
    multicast       the group's locator where we listen to it
    networks        our interfaces' addresses and the length of their networks' prefixes; empty where they are not known
    """

    def __init__(
        self,
        guid_prefix: bytes,
        domain_id: int,
        metatraffic: "tuple[Locator, ...]",
        default: "tuple[Locator, ...]",
        announce_to: "tuple[Address, ...]",
        epoch: int = 0,
        user_data: bytes = b"enclave=/;",
        name: str = "",
        lease: float = DEFAULT_LEASE,
        period: float = DEFAULT_PERIOD,
        fragment_size: int = FRAGMENT_SIZE,
        match_own: bool = True,
        limits: "Limits | None" = None,
        multicast: "tuple[Locator, ...]" = (),
        networks: "tuple[Network, ...]" = (),
    ) -> None:
        if len(guid_prefix) != 12:
            raise ValueError("a GUID prefix has 12 octets, not %d" % len(guid_prefix))
        self.guid_prefix = bytes(guid_prefix)
        self.limits = limits or Limits()
        self.counters: dict[str, int] = {}
        self.writers: dict[bytes, Writer] = {}
        self.readers: dict[bytes, Reader] = {}
        self.endpoints: dict[bytes, EndpointData] = {}
        self.outbox = Outbox()
        self._epoch = epoch
        self._fragment_size = fragment_size
        self._events: list[Any] = []
        self._budget = Budget(self.limits.assembly_bytes)
        self._header = header.own(self.guid_prefix)
        self._serial = 0
        self._by_writer: dict[bytes, list[tuple[Reader, WriterProxy]]] = {}
        self._assert_at: float | None = None
        self._closed = False
        self._match_own = match_own
        self._networks = networks
        self._own_addresses = addresses_of(default, "")[:1]
        own = participant_data.own(
            self.guid_prefix,
            domain_id=domain_id,
            metatraffic_unicast=metatraffic,
            metatraffic_multicast=multicast,
            default_unicast=default,
            lease=int(lease * 1000000000),
            user_data=user_data,
            entity_name=name,
        )
        self.spdp = Spdp(
            own,
            self.outbox,
            announce_to,
            period,
            self.limits,
            epoch,
            self._deliver,
            self._participant_discovered,
            self._participant_lost,
            self._answered,
            self._count,
            networks,
        )
        self.sedp = Sedp(
            self.guid_prefix,
            self._header,
            self.outbox,
            self.counters,
            self.limits,
            self._budget,
            epoch,
            self._builtin_sample,
        )
        self._liveliness = Liveliness(self._deliver, self._heard)
        self._all_writers: dict[bytes, Writer] = dict(self.sedp.writers)
        self._now = 0.0
        self._source = GUIDPREFIX_UNKNOWN
        self._host = ""
        self._for_us = True
        self._time: int | None = None
        self._handlers = {
            submessage.DATA: self._data,
            submessage.DATA_FRAG: self._data_frag,
            submessage.HEARTBEAT: self._heartbeat,
            submessage.HEARTBEAT_FRAG: self._heartbeat_frag,
            submessage.GAP: self._gap,
            submessage.ACKNACK: self._acknack,
            submessage.NACK_FRAG: self._nack_frag,
            submessage.INFO_TS: self._info_ts,
            submessage.INFO_DST: self._info_dst,
            submessage.INFO_SRC: self._info_src,
        }

    # -- what a runtime does

    def start(self, now: float) -> None:
        """From now on we are announced."""
        self.spdp.start(now)

    def receive_datagram(
        self, datagram: "bytes | bytearray | memoryview", source: "Address", now: float
    ) -> None:
        """Take one datagram; events that it makes may hold views of it. Never raises; faults are counted by reason."""
        view = memoryview(datagram)
        try:
            head = header.parse(view)
            if head.guid_prefix == self.guid_prefix and not self._match_own:
                return
            self._source = head.guid_prefix
            self._host = source[0]
            self._for_us = True
            self._time = None
            self._now = now
            remote = self.spdp.remotes.get(head.guid_prefix)
            if remote is not None and source[0] in remote.hosts:
                remote.heard = now
            handlers = self._handlers
            for kind, flags, at, end in submessage.walk(view):
                handler = handlers.get(kind)
                if handler is not None and (self._for_us or kind == submessage.INFO_DST):
                    handler(view, at, end, flags)
        except ProtocolError as error:
            self._count(error.reason)

    def datagrams_to_send(self, now: float) -> "list[Datagram]":
        """What is to be sent now: (parts, addresses), one datagram of all parts to each address."""
        return self.outbox.take(now)

    def next_event(self) -> "Any":
        """The oldest event not yet taken, or None."""
        return self._events.pop(0) if self._events else None

    def take_events(self) -> "list[Any]":
        """All events not yet taken."""
        found = self._events
        self._events = []
        return found

    def deadline(self) -> "float | None":
        """When `handle_deadline` or `datagrams_to_send` next has something to do, or None."""
        found = self.outbox.deadline()
        times = [self.spdp.deadline(), self._assert_at, self._liveliness.deadline()]
        times += [one.deadline() for one in self._all_writers.values()]
        times += [one.deadline() for one in self.sedp.readers.values()]
        times += [one.deadline() for one in self.readers.values()]
        for at in times:
            if at is not None and (found is None or at < found):
                found = at
        return found

    def handle_deadline(self, now: float) -> None:
        """Do what is due: announcements, heartbeats, acknowledgements, leases, liveliness."""
        self._now = now
        self.spdp.handle_deadline(now)
        for writer in self._all_writers.values():
            writer.handle_deadline(now)
        for reader in self.sedp.readers.values():
            reader.handle_deadline(now)
        for reader in self.readers.values():
            reader.handle_deadline(now)
        self._liveliness.handle_deadline(now)
        if self._assert_at is not None and now >= self._assert_at:
            self._send_liveliness(KIND_AUTOMATIC_LIVELINESS_UPDATE, now)
            self._assert_at = now + self._liveliness_period()

    def move(
        self, own: "ParticipantData", to: "tuple[Address, ...]", networks: "tuple[Network, ...]", now: float
    ) -> None:
        """Our interfaces have changed: from now on the locators of `own` hold, announcements go `to` these addresses, and
        peers are told. `own` is `spdp.own` with some of its locators replaced."""
        self._networks = networks
        self._own_addresses = addresses_of(own.default_unicast, "")[:1]
        self.spdp.move(own, to, networks, now)
        if self._match_own:
            for one in list(self.writers.values()) + list(self.readers.values()):
                self._endpoint_discovered(one.data, now)

    def close(self, now: float) -> None:
        """Depart: the datagrams that say so are the last ones to send."""
        if not self._closed:
            self._closed = True
            self.spdp.depart(now)

    # -- endpoints

    def create_writer(
        self,
        topic: str,
        type_name: str,
        qos: "Qos",
        now: float,
        keyed: bool = False,
        unicast: "tuple[Locator, ...]" = (),
        accepts: "Callable[[EndpointData], bool] | None" = None,
    ) -> Writer:
        """A writer of a topic, by its names in DDS, announced from now on; `unicast`: where answers to it are to go,
        the participant's default locators where empty; `accepts` may turn down readers that would match."""
        endpoint = self._endpoint(topic, type_name, qos, b"\x02" if keyed else b"\x03", unicast)
        writer = Writer(
            endpoint,
            self._header,
            self.outbox,
            self.counters,
            self._deliver,
            self._epoch,
            self._fragment_size,
        )
        writer.accepts = accepts
        self.writers[writer.entity_id] = self._all_writers[writer.entity_id] = writer
        self.sedp.announce(endpoint, now)
        for remote in list(self.endpoints.values()):
            if not remote.writer:
                self._consider_reader(writer, remote, now)
        if self._match_own:
            for reader in self.readers.values():
                self._consider_reader(writer, reader.data, now)
                self._consider_writer(reader, endpoint, now)
        if qos.liveliness[0] == AUTOMATIC and qos.liveliness[1] < INFINITE:
            self._assert_at = now
        return writer

    def create_reader(
        self,
        topic: str,
        type_name: str,
        qos: "Qos",
        now: float,
        keyed: bool = False,
        unicast: "tuple[Locator, ...]" = (),
        sink: "Sink | None" = None,
    ) -> Reader:
        """A reader of a topic, by its names in DDS, announced from now on; `unicast`: where samples for it are to go,
        the participant's default locators where empty.

        `sink(proxy, value, time)` is called for each sample within `receive_datagram` or `handle_deadline`, in order,
        and no SampleReceived is made: the writer's proxy, the DATA (of a fragmented sample the DATA it amounts to), and
        the source's time in nanoseconds or None. Views in `value` are good until it returns. It may call the
        participant, but must not raise: an exception would take what follows in the datagram with it.
        """
        endpoint = self._endpoint(topic, type_name, qos, b"\x07" if keyed else b"\x04", unicast)
        reader = Reader(
            endpoint, self._header, self.outbox, self.counters, self.limits, self._budget, self._deliver, sink
        )
        self.readers[reader.entity_id] = reader
        self.sedp.announce(endpoint, now)
        for remote in list(self.endpoints.values()):
            if remote.writer:
                self._consider_writer(reader, remote, now)
        if self._match_own:
            for writer in self.writers.values():
                self._consider_writer(reader, writer.data, now)
                self._consider_reader(writer, endpoint, now)
        return reader

    def delete_writer(self, writer: Writer, now: float) -> None:
        """Withdraw it. Its matches end without events."""
        if self.writers.pop(writer.entity_id, None) is not None:
            del self._all_writers[writer.entity_id]
            for reader in self.readers.values():
                self._drop_writer(reader, writer.data)
            self.sedp.withdraw(writer.data, now)

    def delete_reader(self, reader: Reader, now: float) -> None:
        """Withdraw it. Its matches end without events."""
        if self.readers.pop(reader.entity_id, None) is not None:
            for remote in list(reader.proxies):
                self._unroute(reader, remote)
                self._liveliness.forget(reader.entity_id, remote)
                reader.unmatch(remote)
            for writer in self.writers.values():
                if writer.unmatch(reader.data.guid) is not None:
                    self._deliver(events.EndpointUnmatched(writer.entity_id, reader.data))
            self.sedp.withdraw(reader.data, now)

    def assert_liveliness(self, now: float) -> None:
        """Say that our MANUAL_BY_PARTICIPANT writers are alive."""
        self._send_liveliness(KIND_MANUAL_LIVELINESS_UPDATE, now)

    def _endpoint(
        self, topic: str, type_name: str, qos: "Qos", kind: bytes, unicast: "tuple[Locator, ...]"
    ) -> EndpointData:
        self._serial += 1
        number = self._serial
        entity_id = bytes((number >> 16 & 255, number >> 8 & 255, number & 255)) + kind
        own = self.guid_prefix
        return EndpointData(
            own + entity_id, topic, type_name, qos, unicast, participant_guid=own + guid.ENTITYID_PARTICIPANT
        )

    def _send_liveliness(self, kind: bytes, now: float) -> None:
        writer = self.sedp.writers[guid.ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_WRITER]
        message = participant_message.ParticipantMessage(self.guid_prefix, kind)
        writer.write(message.emit(), now, key=self.guid_prefix + kind)

    def _liveliness_period(self) -> float:
        leases = [
            one.qos.liveliness[1] for one in self.writers.values() if one.qos.liveliness[0] == AUTOMATIC
        ]
        leases.append(3600 * 1000000000)
        return min(leases) / 3e9

    # -- discovery

    def _participant_discovered(self, remote: RemoteParticipant, now: float) -> None:
        for reader, writer in self.sedp.match(remote, now):
            self._route(reader, writer)
        for endpoint in list(self.endpoints.values()):
            if endpoint.guid[:12] == remote.data.guid_prefix:
                self._endpoint_discovered(endpoint, now)

    def _answered(self, prefix: bytes) -> bool:
        return self.sedp.answered(prefix)

    def _participant_lost(self, remote: RemoteParticipant) -> None:
        prefix = remote.data.guid_prefix
        for found in [one for one in self.endpoints if one[:12] == prefix]:
            self._endpoint_lost(found)
        for found in [one for one in self._by_writer if one[:12] == prefix]:
            del self._by_writer[found]
        self.sedp.unmatch(prefix)

    def _builtin_sample(self, event: "Any") -> None:
        """What our builtin readers deliver. Raises ProtocolError, which receive_datagram counts."""
        if not isinstance(event, events.SampleReceived):
            return
        if event.local == guid.ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_READER:
            self._liveliness_message(event)
            return
        prefix = event.writer[:12]
        try:
            if event.flags & FLAG_D:
                found = endpoint_data.parse(event.payload)
                wants_writer = event.local == guid.ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER
                if found.guid[:12] != prefix or found.writer != wants_writer:
                    raise ProtocolError("endpoint-of-another-participant")
                self._endpoint_announced(found)
            else:
                self._endpoint_lost(self._key_of(event, prefix))
        except ProtocolError as error:
            self._count(error.reason)

    def _liveliness_message(self, event: "SampleReceived") -> None:
        """An automatic one has done its work by coming: it renewed the participant's lease."""
        try:
            said = participant_message.parse(event.payload)
        except ProtocolError as error:
            self._count(error.reason)
            return
        if said.guid_prefix == event.writer[:12] and said.kind == KIND_MANUAL_LIVELINESS_UPDATE:
            self._liveliness.participant_asserted(said.guid_prefix, self._now)

    def _heard(self, prefix: bytes) -> float:
        if prefix == self.guid_prefix:
            return self._now
        remote = self.spdp.remotes.get(prefix)
        return remote.heard if remote is not None else 0.0

    def _key_of(self, event: "SampleReceived", prefix: bytes) -> bytes:
        key = inline_qos.parse(event.inline_qos, event.little).key_hash
        if not key and event.flags & FLAG_K:
            key = endpoint_data.parse_key(event.payload)
        if key[:12] != prefix:
            raise ProtocolError("endpoint-of-another-participant")
        return key

    def _endpoint_announced(self, found: EndpointData) -> None:
        known = self.endpoints.get(found.guid)
        if known == found:
            return
        if known is None:
            prefix = found.guid[:12]
            if len([one for one in self.endpoints if one[:12] == prefix]) >= self.limits.endpoints:
                self._count("endpoints-full")
                return
        self.endpoints[found.guid] = found
        self._deliver(events.EndpointDiscovered(found))
        self._endpoint_discovered(found, self._now)

    def _endpoint_discovered(self, found: EndpointData, now: float) -> None:
        if found.writer:
            for reader in list(self.readers.values()):
                self._consider_writer(reader, found, now)
        else:
            for writer in list(self.writers.values()):
                self._consider_reader(writer, found, now)

    def _endpoint_lost(self, lost: bytes) -> None:
        found = self.endpoints.pop(lost, None)
        if found is None:
            return
        if found.writer:
            for reader in self.readers.values():
                self._drop_writer(reader, found)
        else:
            for writer in self.writers.values():
                if writer.unmatch(lost) is not None:
                    self._deliver(events.EndpointUnmatched(writer.entity_id, found))
        self._deliver(events.EndpointLost(found))

    def _addresses(self, found: EndpointData) -> "tuple[Address, ...]":
        if found.guid[:12] == self.guid_prefix:
            return addresses_of(found.unicast, "")[:1] or self._own_addresses
        remote = self.spdp.remotes.get(found.guid[:12])
        if remote is None:
            return ()
        own = addresses_of(found.unicast or found.multicast, remote.host, self._networks)
        return own or remote.default

    def _consider_reader(self, writer: Writer, found: EndpointData, now: float) -> None:
        if found.topic != writer.data.topic or found.type_name != writer.data.type_name:
            return
        if writer.accepts is not None and not writer.accepts(found):
            return
        policies = incompatible(writer.qos, found.qos)
        if policies:
            if writer.unmatch(found.guid) is not None:
                self._deliver(events.EndpointUnmatched(writer.entity_id, found))
            self._deliver(events.QosIncompatible(writer.entity_id, found, policies))
        elif writer.match(found, self._addresses(found), now):
            self._deliver(events.EndpointMatched(writer.entity_id, found))

    def _consider_writer(self, reader: Reader, found: EndpointData, now: float) -> None:
        if found.topic != reader.data.topic or found.type_name != reader.data.type_name:
            return
        policies = incompatible(found.qos, reader.qos)
        if policies:
            self._drop_writer(reader, found)
            self._deliver(events.QosIncompatible(reader.entity_id, found, policies))
        elif reader.match(found, self._addresses(found), now):
            self._route(reader, found.guid)
            self._liveliness.watch(reader.entity_id, found, now)
            self._deliver(events.EndpointMatched(reader.entity_id, found))

    def _drop_writer(self, reader: Reader, found: EndpointData) -> None:
        self._unroute(reader, found.guid)
        self._liveliness.forget(reader.entity_id, found.guid)
        if reader.unmatch(found.guid) is not None:
            self._deliver(events.EndpointUnmatched(reader.entity_id, found))

    def _route(self, reader: Reader, writer: bytes) -> None:
        routes = self._by_writer.setdefault(writer, [])
        if reader not in [one for one, _ in routes]:
            routes.append((reader, reader.proxies[writer]))

    def _unroute(self, reader: Reader, writer: bytes) -> None:
        left = [pair for pair in self._by_writer.get(writer, []) if pair[0] is not reader]
        if left:
            self._by_writer[writer] = left
        else:
            self._by_writer.pop(writer, None)

    # -- submessages

    def _data(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = data.parse(view, at, end, flags)
        if value.writer_id[3] >= ENTITYKIND_BUILTIN and not self._believed():
            return
        routes = self._by_writer.get(self._source + value.writer_id)
        if routes is not None:
            if self._liveliness.manual:
                self._liveliness.writer_asserted(self._source + value.writer_id, self._now)
            reader_id = value.reader_id
            for reader, proxy in routes:
                if reader_id == ENTITYID_UNKNOWN or reader_id == reader.entity_id:
                    reader.handle_data(proxy, value, self._time, self._now)
        elif self._source == self.guid_prefix:
            return  # our own announcement, come back from the group
        elif value.writer_id == guid.ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER:
            self.spdp.handle_data(value, self._source, self._host, self._now)
        else:
            self._count("data-of-unmatched-writer")

    def _believed(self) -> bool:
        """Whether discovery from this source may come from where it came: else anybody could redirect or end a peer."""
        remote = self.spdp.remotes.get(self._source)
        if remote is None or remote.believes(self._host, self._now):
            return True
        self._count("discovery-from-another-address")
        return False

    def _targets(self, value: "Any") -> "list[tuple[Reader, WriterProxy]]":
        if value.writer_id[3] >= ENTITYKIND_BUILTIN and not self._believed():
            return []
        routes = self._by_writer.get(self._source + value.writer_id)
        if routes is None:
            self._count("submessage-of-unmatched-writer")
            return []
        return [one for one in routes if value.reader_id in (ENTITYID_UNKNOWN, one[0].entity_id)]

    def _data_frag(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = data_frag.parse(view, at, end, flags)
        for reader, proxy in self._targets(value):
            reader.handle_data_frag(proxy, value, self._time, self._now)

    def _heartbeat(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = heartbeat.parse(view, at, end, flags)
        if value.liveliness:
            self._liveliness.writer_asserted(self._source + value.writer_id, self._now)
        for reader, proxy in self._targets(value):
            reader.handle_heartbeat(proxy, value, self._now)

    def _heartbeat_frag(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = heartbeat_frag.parse(view, at, end, flags)
        for reader, proxy in self._targets(value):
            reader.handle_heartbeat_frag(proxy, value, self._now)

    def _gap(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = gap.parse(view, at, end, flags)
        for reader, proxy in self._targets(value):
            reader.handle_gap(proxy, value, self._now)

    def _acknack(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = ack_nack.parse(view, at, end, flags)
        writer = self._all_writers.get(value.writer_id)
        if value.writer_id[3] >= ENTITYKIND_BUILTIN and not self._believed():
            return
        if writer is None:
            self._count("acknack-of-unknown-writer")
        else:
            writer.handle_acknack(value, self._source + value.reader_id, self._now)

    def _nack_frag(self, view: memoryview, at: int, end: int, flags: int) -> None:
        value = nack_frag.parse(view, at, end, flags)
        writer = self._all_writers.get(value.writer_id)
        if writer is None:
            self._count("nack-frag-of-unknown-writer")
        else:
            writer.handle_nack_frag(value, self._source + value.reader_id, self._now)

    def _info_ts(self, view: memoryview, at: int, end: int, flags: int) -> None:
        self._time = info_ts.parse(view, at, end, flags).time

    def _info_dst(self, view: memoryview, at: int, end: int, flags: int) -> None:
        prefix = info_dst.parse(view, at, end, flags).guid_prefix
        self._for_us = prefix == self.guid_prefix or prefix == GUIDPREFIX_UNKNOWN

    def _info_src(self, view: memoryview, at: int, end: int, flags: int) -> None:
        self._source = info_src.parse(view, at, end, flags).guid_prefix
        self._time = None

    # -- events

    def _deliver(self, event: "Any") -> None:
        if len(self._events) >= self.limits.events and isinstance(event, events.SampleReceived):
            self._count("events-full")
            return
        self._events.append(event)

    def _count(self, reason: str) -> None:
        self.counters[reason] = self.counters.get(reason, 0) + 1
