"""Which endpoints are there, and which of them match ours. RTPS 2.3, 8.5.4; DDS 1.4, 2.2.3 (topic, type, RxO).

Indexed by participant and by writer, so that what one peer does costs in proportion to its own endpoints.
"""

from roslet.engine.rtps import events
from roslet.engine.rtps.fragments import Budget
from roslet.engine.rtps.qos import incompatible
from roslet.engine.rtps.reach import addresses_of
from roslet.errors import ProtocolError
from roslet.wire.rtps import endpoint_data, guid, inline_qos
from roslet.wire.rtps.data import FLAG_D, FLAG_K
from roslet.wire.rtps.guid import VENDORID_ROSLET, VENDORID_UNKNOWN

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.limits import Limits
    from roslet.engine.rtps.liveliness import Liveliness
    from roslet.engine.rtps.outbox import Address
    from roslet.engine.rtps.reach import Network
    from roslet.engine.rtps.reader import Reader, WriterProxy
    from roslet.engine.rtps.spdp import RemoteParticipant
    from roslet.engine.rtps.writer import Writer
    from roslet.wire.rtps.data import Data
    from roslet.wire.rtps.endpoint_data import EndpointData


class Matching:
    """`endpoints`: all remote ones by GUID; `interest`: which of them are kept, all where None; what was not kept is
    missing for endpoints of ours that come later (see `Spdp.relearn`). `routes`: which of our readers take what a
    remote writer sends."""

    def __init__(
        self,
        guid_prefix: bytes,
        remotes: "dict[bytes, RemoteParticipant]",
        limits: "Limits",
        liveliness: "Liveliness",
        own_addresses: "tuple[Address, ...]",
        match_own: bool,
        deliver: "Callable[[Any], None]",
        count: "Callable[[str], None]",
        networks: "tuple[Network, ...]" = (),
    ) -> None:
        self.writers: dict[bytes, Writer] = {}
        self.readers: dict[bytes, Reader] = {}
        self.endpoints: dict[bytes, EndpointData] = {}
        self.routes: dict[bytes, list[tuple[Reader, WriterProxy]]] = {}
        self.interest: Callable[[EndpointData], bool] | None = None
        self._sizes: dict[bytes, int] = {}  # octets of the announcements, by GUID
        self._budget = Budget(limits.discovery_bytes, limits.discovery_share)
        self._of: dict[bytes, dict[bytes, EndpointData]] = {}  # by participant
        self._guid_prefix = guid_prefix
        self._remotes = remotes
        self._limits = limits
        self._liveliness = liveliness
        self._own_addresses = own_addresses
        self._match_own = match_own
        self._deliver = deliver
        self._count = count
        self._networks = networks

    def move(self, own_addresses: "tuple[Address, ...]", networks: "tuple[Network, ...]", now: float) -> None:
        """Our interfaces have changed."""
        self._own_addresses = own_addresses
        self._networks = networks
        if self._match_own:
            for one in list(self.writers.values()) + list(self.readers.values()):
                self._discovered(one.data, one.data, now)

    # -- ours

    def add_writer(self, writer: "Writer", now: float) -> None:
        """Find the readers of a new writer."""
        self.writers[writer.entity_id] = writer
        for remote in list(self.endpoints.values()):
            if not remote.writer:
                self._consider_reader(writer, remote, now)
        if self._match_own:
            for reader in list(self.readers.values()):
                self._consider_reader(writer, reader.data, now)
                self._consider_writer(reader, writer.data, now)

    def add_reader(self, reader: "Reader", now: float) -> None:
        """Find the writers of a new reader."""
        self.readers[reader.entity_id] = reader
        for remote in list(self.endpoints.values()):
            if remote.writer:
                self._consider_writer(reader, remote, now)
        if self._match_own:
            for writer in list(self.writers.values()):
                self._consider_writer(reader, writer.data, now)
                self._consider_reader(writer, reader.data, now)

    def remove_writer(self, writer: "Writer", now: float) -> bool:
        """Forget it; false where it was not there."""
        if self.writers.pop(writer.entity_id, None) is None:
            return False
        for reader in list(self.readers.values()):
            self._drop_writer(reader, writer.data, now)
        return True

    def remove_reader(self, reader: "Reader", now: float) -> bool:
        """Forget it; false where it was not there."""
        if self.readers.pop(reader.entity_id, None) is None:
            return False
        for remote in list(reader.proxies):
            self._unroute(reader, remote)
            self._liveliness.forget(reader.entity_id, remote)
            reader.unmatch(remote, now)
        for writer in list(self.writers.values()):
            if writer.unmatch(reader.data.guid, now) is not None:
                self._deliver(events.EndpointUnmatched(writer.entity_id, reader.data))
        return True

    # -- theirs

    def participant_changed(self, prefix: bytes, now: float) -> None:
        """Its locators may be others."""
        for endpoint in list(self._of.get(prefix, {}).values()):
            self._discovered(endpoint, endpoint, now)

    def participant_lost(self, prefix: bytes, builtin_writers: "list[bytes]", now: float) -> None:
        """It is gone with all its endpoints."""
        for found in list(self._of.get(prefix, {})):
            self._lost(found, now)
        for found in builtin_writers:
            self.routes.pop(found, None)

    def handle_sample(self, local: bytes, writer: bytes, value: "Data", now: float) -> None:
        """What our SEDP reader `local` received: an endpoint, or its end. Raises ProtocolError."""
        prefix = writer[:12]
        if not value.flags & FLAG_D:
            self._lost(_key_of(value, prefix), now)
            return
        found = endpoint_data.parse(value.payload)
        wants_writer = local == guid.ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER
        if found.guid[:12] != prefix or found.writer != wants_writer:
            raise ProtocolError("endpoint-of-another-participant")
        before = self.endpoints.get(found.guid)
        if before == found:
            return
        if before is None and self.interest is not None and not self.interest(found):
            self._count("endpoint-not-kept")
            return
        known = self._of.setdefault(prefix, {})
        if found.guid not in known and len(known) >= self._limits.endpoints:
            raise ProtocolError("endpoints-full")
        self._account(found.guid, len(value.payload))
        known[found.guid] = self.endpoints[found.guid] = found
        self._deliver(events.EndpointDiscovered(found))
        self._discovered(found, before, now)

    def _account(self, endpoint: bytes, size: int) -> None:
        """This announcement takes the place of the one before. Raises ProtocolError where it is too much."""
        prefix, before = endpoint[:12], self._sizes.get(endpoint)
        if before is not None:
            self._budget.give(prefix, before)
        if self._budget.take(prefix, size):
            self._sizes[endpoint] = size
            return
        if before is not None:
            self._budget.take(prefix, before)
        raise ProtocolError("discovery-bytes-full")

    def _discovered(self, found: "EndpointData", before: "EndpointData | None", now: float) -> None:
        """Consider an endpoint for all of ours; `before` is what was known of it."""
        if found.writer:
            for reader in list(self.readers.values()):
                self._consider_writer(reader, found, now, before)
        else:
            for writer in list(self.writers.values()):
                self._consider_reader(writer, found, now, before)

    def _lost(self, lost: bytes, now: float) -> None:
        found = self.endpoints.pop(lost, None)
        if found is None:
            return
        self._budget.give(lost[:12], self._sizes.pop(lost))
        known = self._of[lost[:12]]
        del known[lost]
        if not known:
            del self._of[lost[:12]]
        if found.writer:
            for reader in list(self.readers.values()):
                self._drop_writer(reader, found, now)
        else:
            for writer in list(self.writers.values()):
                if writer.unmatch(lost, now) is not None:
                    self._deliver(events.EndpointUnmatched(writer.entity_id, found))
        self._deliver(events.EndpointLost(found))

    # -- do they go together?

    def _addresses(self, found: "EndpointData") -> "tuple[Address, ...]":
        prefix = found.guid[:12]
        if prefix == self._guid_prefix:
            return addresses_of(found.unicast, "")[:1] or self._own_addresses
        remote = self._remotes.get(prefix)
        if remote is None:
            return ()
        return (
            addresses_of(found.unicast, remote.host, self._networks)
            or remote.default
            or addresses_of(found.multicast, remote.host, self._networks)
        )

    def _vendor(self, found: "EndpointData") -> bytes:
        if found.guid[:12] == self._guid_prefix:
            return VENDORID_ROSLET
        remote = self._remotes.get(found.guid[:12])
        return remote.data.vendor_id if remote is not None else VENDORID_UNKNOWN

    def _consider_reader(
        self, writer: "Writer", found: "EndpointData", now: float, before: "EndpointData | None" = None
    ) -> None:
        if found.topic != writer.data.topic or found.type_name != writer.data.type_name:
            return
        if writer.accepts is not None and not writer.accepts(found):
            return
        policies = incompatible(writer.qos, found.qos)
        if policies:
            if writer.unmatch(found.guid, now) is not None:
                self._deliver(events.EndpointUnmatched(writer.entity_id, found))
            if before is None or incompatible(writer.qos, before.qos) != policies:
                self._deliver(events.QosIncompatible(writer.entity_id, found, policies))
        elif writer.match(found, self._addresses(found), now, self._vendor(found)):
            self._deliver(events.EndpointMatched(writer.entity_id, found))

    def _consider_writer(
        self, reader: "Reader", found: "EndpointData", now: float, before: "EndpointData | None" = None
    ) -> None:
        if found.topic != reader.data.topic or found.type_name != reader.data.type_name:
            return
        policies = incompatible(found.qos, reader.qos)
        if policies:
            self._drop_writer(reader, found, now)
            if before is None or incompatible(before.qos, reader.qos) != policies:
                self._deliver(events.QosIncompatible(reader.entity_id, found, policies))
        elif reader.match(found, self._addresses(found), now, self._vendor(found)):
            self.route(reader, found.guid)
            self._liveliness.watch(reader.entity_id, found, now)
            self._deliver(events.EndpointMatched(reader.entity_id, found))

    def _drop_writer(self, reader: "Reader", found: "EndpointData", now: float) -> None:
        self._unroute(reader, found.guid)
        self._liveliness.forget(reader.entity_id, found.guid)
        if reader.unmatch(found.guid, now) is not None:
            self._deliver(events.EndpointUnmatched(reader.entity_id, found))

    def route(self, reader: "Reader", writer: bytes) -> None:
        """What this writer sends goes to this reader too."""
        routes = self.routes.get(writer, [])
        if reader not in [one for one, _ in routes]:
            # A new list: somebody may be walking over the old one.
            self.routes[writer] = routes + [(reader, reader.proxies[writer])]  # noqa: RUF005 - as MicroPython compiles it

    def _unroute(self, reader: "Reader", writer: bytes) -> None:
        left = [pair for pair in self.routes.get(writer, []) if pair[0] is not reader]
        if left:
            self.routes[writer] = left
        else:
            self.routes.pop(writer, None)


def _key_of(value: "Data", prefix: bytes) -> bytes:
    key = inline_qos.parse(value.inline_qos, value.little).key_hash
    if not key and value.flags & FLAG_K:
        key = endpoint_data.parse_key(value.payload)
    if key[:12] != prefix:
        raise ProtocolError("endpoint-of-another-participant")
    return key
