"""A DDS-RTPS participant: what a runtime drives. RTPS 2.3, 8.2, 8.3.4 (receiver), 8.4, 8.5.

Endpoints of one participant match each other as any two do, by datagrams to itself, unless `match_own` is False: then
the node hands such samples over by its own, shorter way.
"""

from roslet.engine.rtps import events
from roslet.engine.rtps.common import Common
from roslet.engine.rtps.limits import Limits
from roslet.engine.rtps.liveliness import Liveliness
from roslet.engine.rtps.matching import Matching
from roslet.engine.rtps.outbox import Outbox
from roslet.engine.rtps.reach import addresses_of
from roslet.engine.rtps.reader import Reader
from roslet.engine.rtps.receiver import Receiver
from roslet.engine.rtps.schedule import Alarm
from roslet.engine.rtps.sedp import Sedp
from roslet.engine.rtps.spdp import RemoteParticipant, Spdp
from roslet.engine.rtps.writer import FAR_FRAGMENT_SIZE, FRAGMENT_SIZE, Writer
from roslet.errors import ProtocolError
from roslet.wire.rtps import guid, header, participant_data, participant_message
from roslet.wire.rtps.endpoint_data import EndpointData
from roslet.wire.rtps.participant_message import (
    KIND_AUTOMATIC_LIVELINESS_UPDATE,
    KIND_MANUAL_LIVELINESS_UPDATE,
)
from roslet.wire.rtps.qos import AUTOMATIC, MANUAL_BY_PARTICIPANT
from roslet.wire.rtps.times import INFINITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

    from roslet.engine.rtps.outbox import Address, Datagram
    from roslet.engine.rtps.reach import Network
    from roslet.engine.rtps.reader import KeyOf, Sink, WriterProxy
    from roslet.wire.rtps.data import Data
    from roslet.wire.rtps.locator import Locator
    from roslet.wire.rtps.participant_data import ParticipantData
    from roslet.wire.rtps.qos import Qos

DEFAULT_LEASE = 20.0
DEFAULT_PERIOD = 3.0
"""Seconds: how long peers believe in us without hearing of us, and between announcements; as Fast DDS has them."""
FOREVER = 1e9
NEVER = -1e9


class Participant:
    """One participant of a domain.

    guid_prefix     12 octets that nobody else has: the runtime's entropy
    metatraffic, default   locators at which discovery and samples reach us
    announce_to     addresses of announcements: the multicast group, static peers
    epoch           nanoseconds of the Unix epoch when `now` is 0
    multicast       the group's locator where we listen to it
    networks        our interfaces' addresses and the length of their networks' prefixes; empty where they are not known
    fragment_size, far_fragment_size   octets of a part of a large sample; the latter where a reader is on another host
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
        far_fragment_size: int = FAR_FRAGMENT_SIZE,
    ) -> None:
        if len(guid_prefix) != 12:
            raise ValueError("a GUID prefix has 12 octets, not %d" % len(guid_prefix))
        self.guid_prefix = bytes(guid_prefix)
        self.limits = limits or Limits()
        self.counters: dict[str, int] = {}
        self.outbox = Outbox()
        self._fragment_size = fragment_size
        self._far_fragment_size = far_fragment_size
        self._events: list[Any] = []
        self._serial = 0
        self._closed = False
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
        self._common = Common(
            header.own(self.guid_prefix), self.outbox, self.counters, self.limits, epoch, self._deliver
        )
        self._networks = networks
        self._common.here = self._is_here
        self._count = self._common.count
        self._schedule = self._common.schedule
        self._asserting = Alarm(self._schedule, self._assert_automatic)
        self._asserted = NEVER
        self.spdp = Spdp(
            own,
            self._common,
            announce_to,
            period,
            self._participant_discovered,
            self._participant_lost,
            self._answered,
            networks,
        )
        self.sedp = Sedp(self.guid_prefix, self._common.quiet(), self._builtin_sample)
        self._liveliness = Liveliness(self._schedule, self._deliver, self._heard)
        self._matching = Matching(
            self.guid_prefix,
            self.spdp.remotes,
            self.limits,
            self._liveliness,
            addresses_of(default, "")[:1],
            match_own,
            self._deliver,
            self._count,
            networks,
        )
        self.writers = self._matching.writers
        self.readers = self._matching.readers
        self.endpoints = self._matching.endpoints
        self._by_writer = self._matching.routes
        self._all_writers: dict[bytes, Writer] = dict(self.sedp.writers)
        self._receiver = Receiver(
            self.guid_prefix,
            match_own,
            self.spdp,
            self._all_writers,
            self._by_writer,
            self._liveliness,
            self._count,
        )

    # -- what a runtime does

    def start(self, now: float) -> None:
        """From now on we are announced."""
        self.spdp.start(now)

    def receive_datagram(
        self, datagram: "bytes | bytearray | memoryview", source: "Address", now: float
    ) -> None:
        """Take one datagram; events that it makes may hold views of it. Never raises; faults are counted by reason."""
        try:
            self._receiver.receive_datagram(memoryview(datagram), source, now)
        except ProtocolError as error:
            self._count(error.reason)

    def receive_again(self, view: memoryview, size: int, now: float) -> None:
        """The same of view[:size], for shells that receive samples always into the same buffer, which `view` is all of,
        without asking where from: what is like an earlier datagram makes no garbage. Of user data only; discovery that comes
        so is not believed."""
        try:
            self._receiver.receive_again(view, size, now)
        except ProtocolError as error:
            self._count(error.reason)

    def datagrams_to_send(self, now: float) -> "Sequence[Datagram]":
        """What is to be sent now: (parts, addresses), one datagram of all parts to each address."""
        return self.outbox.take(now)

    def next_event(self) -> "Any":
        """The oldest event not yet taken, or None."""
        return self._events.pop(0) if self._events else None

    @property
    def pending_events(self) -> bool:
        """Whether there are events to take."""
        return bool(self._events)

    def take_events(self) -> "list[Any]":
        """All events not yet taken."""
        found = self._events
        if found:
            self._events = []
        return found

    def deadline(self) -> "float | None":
        """When `handle_deadline` or `datagrams_to_send` next has something to do, or None."""
        found = self.outbox.deadline()
        at = self._schedule.deadline()
        if found is None or (at is not None and at < found):
            return at
        return found

    def handle_deadline(self, now: float) -> None:
        """Do what is due: announcements, heartbeats, acknowledgements, leases, liveliness."""
        self._schedule.ring(now)

    def move(
        self, own: "ParticipantData", to: "tuple[Address, ...]", networks: "tuple[Network, ...]", now: float
    ) -> None:
        """Our interfaces have changed: from now on the locators of `own` hold, announcements go `to` these addresses, and
        peers are told. `own` is `spdp.own` with some of its locators replaced."""
        self._networks = networks
        for writer in self.writers.values():
            writer.moved()
        self._matching.move(addresses_of(own.default_unicast, "")[:1], networks, now)
        self.spdp.move(own, to, networks, now)

    def keep_only(self, interest: "Callable[[EndpointData], bool]") -> None:
        """From now on keep only such endpoints of others. One of ours whose topic is a new one must be followed by
        `spdp.relearn`."""
        self._matching.interest = interest

    def _is_here(self, host: str) -> bool:
        if not self._networks or host.startswith("127."):
            return True
        return host in [address for address, _ in self._networks]

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
        kind, lease = qos.liveliness
        wrote = self._wrote if kind == MANUAL_BY_PARTICIPANT and lease < INFINITE else None
        writer = Writer(endpoint, self._common, self._fragment_size, self._far_fragment_size, wrote)
        writer.accepts = accepts
        self._all_writers[writer.entity_id] = writer
        self.sedp.announce(endpoint, now)
        self._matching.add_writer(writer, now)
        writer.watch_liveliness(now)
        if kind == AUTOMATIC and lease < INFINITE:
            self._asserting.set(now)
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
        multicast: "tuple[Locator, ...]" = (),
        key_of: "KeyOf | None" = None,
    ) -> Reader:
        """A reader of a topic, by its names in DDS, announced from now on; `unicast`: where samples for it are to go,
        the participant's default locators where empty; `multicast`: where writers may reach it together with others, if
        the runtime receives there.

        `sink(proxy, value, time)` is called for each sample within `receive_datagram` or `handle_deadline`, in order,
        and no SampleReceived is made: the writer's proxy, the DATA (of a fragmented sample the DATA it amounts to; without
        FLAG_D it is the end of an instance), and the source's time in nanoseconds or None. Views in `value` are good
        until it returns. It may call the participant, but must not raise: an exception would take what follows in the
        datagram with it. `key_of(value)`: the key hash of a sample of a keyed topic whose writer sends none.
        """
        endpoint = self._endpoint(topic, type_name, qos, b"\x07" if keyed else b"\x04", unicast, multicast)
        reader = Reader(endpoint, self._common, sink, key_of)
        self.sedp.announce(endpoint, now)
        self._matching.add_reader(reader, now)
        return reader

    def delete_writer(self, writer: Writer, now: float) -> None:
        """Withdraw it. Its matches end without events."""
        if self._matching.remove_writer(writer, now):
            del self._all_writers[writer.entity_id]
            writer.close()
            self.sedp.withdraw(writer.data, now)

    def delete_reader(self, reader: Reader, now: float) -> None:
        """Withdraw it. Its matches end without events."""
        if self._matching.remove_reader(reader, now):
            reader.close()
            self.sedp.withdraw(reader.data, now)

    def _endpoint(
        self,
        topic: str,
        type_name: str,
        qos: "Qos",
        kind: bytes,
        unicast: "tuple[Locator, ...]",
        multicast: "tuple[Locator, ...]" = (),
    ) -> EndpointData:
        self._serial += 1
        number = self._serial
        entity_id = bytes((number >> 16 & 255, number >> 8 & 255, number & 255)) + kind
        own = self.guid_prefix
        return EndpointData(
            own + entity_id,
            topic,
            type_name,
            qos,
            unicast,
            multicast,
            participant_guid=own + guid.ENTITYID_PARTICIPANT,
        )

    # -- liveliness

    def assert_liveliness(self, now: float) -> None:
        """Say that our MANUAL_BY_PARTICIPANT writers are alive."""
        self._asserted = now
        for writer in self.writers.values():
            if writer.qos.liveliness[0] == MANUAL_BY_PARTICIPANT:
                writer.watch_liveliness(now)
        self._send_liveliness(KIND_MANUAL_LIVELINESS_UPDATE, now)

    def _wrote(self, now: float) -> None:
        """A MANUAL_BY_PARTICIPANT writer wrote: so all of them are alive. Readers of the others are told now and then."""
        if now - self._asserted >= self._least_lease(MANUAL_BY_PARTICIPANT) / 3:
            self.assert_liveliness(now)

    def _assert_automatic(self, now: float) -> None:
        lease = self._least_lease(AUTOMATIC)
        if lease < FOREVER:
            self._send_liveliness(KIND_AUTOMATIC_LIVELINESS_UPDATE, now)
            self._asserting.set(now + lease / 3)

    def _send_liveliness(self, kind: bytes, now: float) -> None:
        writer = self.sedp.writers[guid.ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_WRITER]
        message = participant_message.ParticipantMessage(self.guid_prefix, kind)
        writer.write(message.emit(), now, key=self.guid_prefix + kind)

    def _least_lease(self, kind: int) -> float:
        """Seconds; FOREVER where no writer of this kind has a lease."""
        found = FOREVER
        for writer in self.writers.values():
            if writer.qos.liveliness[0] == kind and writer.qos.liveliness[1] < INFINITE:
                found = min(found, writer.qos.liveliness[1] / 1e9)
        return found

    # -- discovery

    def _participant_discovered(self, remote: RemoteParticipant, now: float) -> None:
        for reader, writer in self.sedp.match(remote, now):
            self._matching.route(reader, writer)
        self._matching.participant_changed(remote.data.guid_prefix, now)

    def _answered(self, prefix: bytes) -> bool:
        return self.sedp.answered(prefix)

    def _participant_lost(self, remote: RemoteParticipant, now: float) -> None:
        prefix = remote.data.guid_prefix
        self._matching.participant_lost(prefix, self.sedp.unmatch(prefix, now), now)

    def _builtin_sample(self, local: bytes, proxy: "WriterProxy", value: "Data") -> None:
        """The sink of our builtin readers."""
        now = self._receiver.now
        try:
            if local == guid.ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_READER:
                # An automatic one has done its work by coming: it renewed the participant's lease.
                said = participant_message.parse(value.payload)
                if said.guid_prefix == proxy.guid[:12] and said.kind == KIND_MANUAL_LIVELINESS_UPDATE:
                    self._liveliness.participant_asserted(said.guid_prefix, now)
            else:
                self._matching.handle_sample(local, proxy.guid, value, now)
        except ProtocolError as error:
            self._count(error.reason)

    def _heard(self, prefix: bytes) -> float:
        if prefix == self.guid_prefix:
            return self._receiver.now
        remote = self.spdp.remotes.get(prefix)
        return remote.heard if remote is not None else 0.0

    # -- events

    def _deliver(self, event: "Any") -> None:
        if len(self._events) >= self.limits.events and isinstance(event, events.SampleReceived):
            self._count("events-full")
            return
        self._events.append(event)
