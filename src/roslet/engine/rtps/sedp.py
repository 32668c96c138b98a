"""Endpoints find each other: SEDP. RTPS 2.3, 8.5.4, and the participant message writer and reader, 8.4.13.

The builtin endpoints are ordinary writers and readers, reliable and transient local, that match by the participants' sets
of builtin endpoints instead of by topic.
"""

from roslet.engine.rtps.reader import Reader
from roslet.engine.rtps.writer import Writer
from roslet.wire.rtps import guid, inline_qos, participant_data
from roslet.wire.rtps import parameter_list as pl
from roslet.wire.rtps.data import FLAG_K
from roslet.wire.rtps.endpoint_data import EndpointData
from roslet.wire.rtps.inline_qos import STATUS_DISPOSED, STATUS_UNREGISTERED
from roslet.wire.rtps.qos import DEFAULT_BLOCKING, KEEP_LAST, RELIABLE, TRANSIENT_LOCAL, Qos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.engine.rtps.common import Common
    from roslet.engine.rtps.reader import Sink, WriterProxy
    from roslet.engine.rtps.spdp import RemoteParticipant
    from roslet.wire.rtps.data import Data

BUILTIN_QOS = Qos(
    reliability=(RELIABLE, DEFAULT_BLOCKING), durability=TRANSIENT_LOCAL, history=(KEEP_LAST, 1)
)

# our endpoint, the peer's, and the bit by which the peer says that it has it
WRITERS = (
    (
        guid.ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER,
        guid.ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER,
        participant_data.PUBLICATIONS_DETECTOR,
    ),
    (
        guid.ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_WRITER,
        guid.ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_READER,
        participant_data.SUBSCRIPTIONS_DETECTOR,
    ),
    (
        guid.ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_WRITER,
        guid.ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_READER,
        participant_data.PARTICIPANT_MESSAGE_DATA_READER,
    ),
)
READERS = (
    (
        guid.ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER,
        guid.ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER,
        participant_data.PUBLICATIONS_ANNOUNCER,
    ),
    (
        guid.ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_READER,
        guid.ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_WRITER,
        participant_data.SUBSCRIPTIONS_ANNOUNCER,
    ),
    (
        guid.ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_READER,
        guid.ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_WRITER,
        participant_data.PARTICIPANT_MESSAGE_DATA_WRITER,
    ),
)


def _sink(local: bytes, deliver: "Callable[[bytes, WriterProxy, Data], None]") -> "Sink":
    return lambda proxy, value, time: deliver(local, proxy, value)


class Sedp:
    """The builtin endpoints of a participant. `deliver(local, proxy, value)` takes what its reader `local` receives."""

    def __init__(
        self,
        prefix: bytes,
        common: "Common",
        deliver: "Callable[[bytes, WriterProxy, Data], None]",
    ) -> None:
        self.writers = {
            ours: Writer(EndpointData(prefix + ours, qos=BUILTIN_QOS), common) for ours, _, _ in WRITERS
        }
        self.readers = {
            ours: Reader(EndpointData(prefix + ours, qos=BUILTIN_QOS), common, _sink(ours, deliver))
            for ours, _, _ in READERS
        }

    def match(self, remote: "RemoteParticipant", now: float) -> "list[tuple[Reader, bytes]]":
        """Match what the participant has; returns the pairs of our readers and its writers."""
        prefix = remote.data.guid_prefix
        has = remote.data.builtin_endpoints
        for ours, theirs, bit in WRITERS:
            if has & bit:
                self.writers[ours].match(
                    EndpointData(prefix + theirs, qos=BUILTIN_QOS),
                    remote.metatraffic,
                    now,
                    remote.data.vendor_id,
                )
        found = []
        for ours, theirs, bit in READERS:
            if has & bit:
                self.readers[ours].match(
                    EndpointData(prefix + theirs, qos=BUILTIN_QOS),
                    remote.metatraffic,
                    now,
                    remote.data.vendor_id,
                )
                found.append((self.readers[ours], prefix + theirs))
        return found

    def unmatch(self, prefix: bytes, now: float) -> "list[bytes]":
        """Forget a participant; returns the GUIDs of its writers."""
        for ours, theirs, _ in WRITERS:
            self.writers[ours].unmatch(prefix + theirs, now)
        for ours, theirs, _ in READERS:
            self.readers[ours].unmatch(prefix + theirs, now)
        return [prefix + theirs for _, theirs, _ in READERS]

    def answered(self, prefix: bytes) -> bool:
        """Whether a matched participant has acknowledged anything of ours, or has nothing to do it with."""
        found = [self.writers[ours].proxies.get(prefix + theirs) for ours, theirs, _ in WRITERS]
        counts = [one.count for one in found if one is not None]
        return not counts or max(counts) >= 0

    def _announcer(self, data: EndpointData) -> Writer:
        if data.writer:
            return self.writers[guid.ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER]
        return self.writers[guid.ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_WRITER]

    def announce(self, data: EndpointData, now: float) -> None:
        """Tell everybody of our endpoint, now and as they come."""
        self._announcer(data).write(data.emit(), now, key=data.guid)

    def withdraw(self, data: EndpointData, now: float) -> None:
        """Tell everybody that it is gone."""
        status = inline_qos.InlineQos(data.guid, STATUS_DISPOSED | STATUS_UNREGISTERED).emit()
        key = pl.encapsulate([(pl.PID_ENDPOINT_GUID, data.guid)])
        self._announcer(data).write(key, now, None, status, data.guid, FLAG_K)
