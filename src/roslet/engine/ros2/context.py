"""The ROS 2 side of one participant, which several nodes share: whose endpoints are whose, told to all and heard from all.

After `start`, the owner gives every event of the participant to `handle_event` first, and looks after `deadline` as after
the participant's own. Times are those of the participant.
"""

from roslet.engine.ros2 import user_data
from roslet.engine.ros2.graph import Graph
from roslet.engine.rtps import events
from roslet.errors import NodeClosed, ProtocolError
from roslet.names import check_namespace, check_node_name
from roslet.wire import discovery_info
from roslet.wire.discovery_info import NodeEntities, ParticipantEntities
from roslet.wire.rtps import qos as policies
from roslet.wire.rtps.data import FLAG_D
from roslet.wire.rtps.guid import ENTITYID_PARTICIPANT, VENDORID_ROSLET, VENDORID_UNKNOWN
from roslet.wire.rtps.participant_data import ParticipantData
from roslet.wire.rtps.qos import Qos

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.participant import Participant
    from roslet.engine.rtps.reader import Reader, Sink
    from roslet.engine.rtps.writer import Writer
    from roslet.wire.rtps.endpoint_data import EndpointData

# Seconds that a change waits for others, so that a node with twenty endpoints is told once.
BATCH = 0.01

_RELIABLE = (policies.RELIABLE, policies.DEFAULT_BLOCKING)
_USER_DATA = user_data.pair("typehash", discovery_info.TYPE_HASH)
# As rmw_fastrtps and rmw_cyclonedds have them; deadline, lifespan and liveliness are endless.
WRITER_QOS = Qos(_RELIABLE, policies.TRANSIENT_LOCAL, (policies.KEEP_LAST, 1), user_data=_USER_DATA)
READER_QOS = Qos(_RELIABLE, policies.TRANSIENT_LOCAL, (policies.KEEP_ALL, 1), user_data=_USER_DATA)


def is_old(data: "EndpointData") -> bool:
    """Whether an endpoint of ros_discovery_info has gids of 24 octets: type hashes came with Iron, as the short gid did."""
    return user_data.value_of(data.qos.user_data, "typehash") is None


def is_new(data: "EndpointData") -> bool:
    """The contrary."""
    return not is_old(data)


class _Node:
    def __init__(self, name: str, namespace: str) -> None:
        self.name = name
        self.namespace = namespace
        self.writers: dict[bytes, Writer] = {}  # by GUID
        self.readers: dict[bytes, Reader] = {}


class Context:
    """`enclave` as the participant's USER_DATA says it: make that with `user_data.pair("enclave", enclave)`.

    graph      what is known of the domain
    counters   the participant's: what was dropped, by reason
    listens    whether we hear what nodes others have; without, the graph knows their endpoints alone
    """

    def __init__(
        self,
        participant: "Participant",
        enclave: str = "/",
        max_nodes: int = discovery_info.MAX_NODES,
        max_endpoints: int = discovery_info.MAX_GIDS,
        batch: float = BATCH,
        listens: bool = True,
    ) -> None:
        self.participant = participant
        self.enclave = enclave
        self.graph = Graph()
        self.counters = participant.counters
        self.unique = 0  # for ids of servers and clients
        self._max_nodes = max_nodes
        self._max_endpoints = max_endpoints
        self._batch = batch
        self._listens = listens
        self._nodes: dict[int, _Node] = {}
        self._serial = 0
        self._endpoints = 0
        self._publish_at: float | None = None
        self._writer: Writer | None = None
        self._old_writer: Writer | None = None  # for those up to Humble, once one is seen
        self._reader: Reader | None = None
        self._watchers: dict[bytes, Callable[[Any, float], None]] = {}
        self.timed: list[
            Any
        ] = []  # machines of this package that wait: with deadline() and handle_deadline(now)

    # -- what a runtime does

    def start(self, now: float) -> None:
        """Join the graph. The participant may have been started before."""
        participant = self.participant
        own = ParticipantData(
            participant.guid_prefix + ENTITYID_PARTICIPANT,
            vendor_id=VENDORID_ROSLET,
            user_data=user_data.pair("enclave", self.enclave),
        )
        self.graph.participant_discovered(own)
        self._writer = participant.create_writer(
            discovery_info.TOPIC, discovery_info.TYPE, WRITER_QOS, now, accepts=is_new
        )
        self.graph.endpoint_discovered(self._writer.data)
        if self._listens:
            self._reader = participant.create_reader(
                discovery_info.TOPIC, discovery_info.TYPE, READER_QOS, now
            )
            self.graph.endpoint_discovered(self._reader.data)
        self._changed(now)

    def handle_event(self, event: "Any", now: float) -> bool:
        """Take an event of the participant; True where nobody else can want it. What changed of endpoints is noted, and
        left to the caller. Never raises; what is dropped is counted."""
        handler = self._HANDLERS.get(type(event))
        return handler is not None and handler(self, event, now)

    def deadline(self) -> "float | None":
        """When `handle_deadline` has something to do, or None."""
        found = self._publish_at
        for one in self.timed:
            at = one.deadline()
            if at is not None and (found is None or at < found):
                found = at
        return found

    def handle_deadline(self, now: float) -> None:
        """Tell what changed, once it has waited for others; give up replies that nobody can be given."""
        if self._publish_at is not None and now >= self._publish_at:
            self.flush(now)
        for one in list(self.timed):
            one.handle_deadline(now)

    def flush(self, now: float) -> None:
        """Tell at once what changed of our nodes and endpoints."""
        if self._publish_at is None or self._writer is None:
            return
        self._publish_at = None
        info = self._info()
        self._writer.write(info.emit(), now)
        if self._old_writer is not None:
            self._old_writer.write(info.emit(discovery_info.OLD_GID), now)

    def close(self, now: float) -> None:
        """Remove all nodes and say so; the participant departs on its own."""
        for handle in list(self._nodes):
            self.remove_node(handle, now)
        self.flush(now)

    # -- nodes

    def add_node(self, name: str, namespace: str, now: float) -> int:
        """A node, by a handle. Raises InvalidName, and ValueError where there are too many."""
        if len(self._nodes) >= self._max_nodes:
            raise ValueError("a participant has at most %d nodes" % self._max_nodes)
        node = _Node(check_node_name(name), check_namespace(namespace))
        self._serial += 1
        self._nodes[self._serial] = node
        self._changed(now)
        return self._serial

    def remove_node(self, handle: int, now: float) -> None:
        """A node with the endpoints that it still has; one that is not there is no error."""
        node = self._nodes.get(handle)
        if node is not None:
            for writer in list(node.writers.values()):
                self.delete_writer(handle, writer, now)
            for reader in list(node.readers.values()):
                self.delete_reader(handle, reader, now)
            del self._nodes[handle]
            self._changed(now)

    # -- endpoints

    def create_writer(
        self,
        node: int,
        dds_topic: str,
        dds_type: str,
        qos: Qos,
        type_hash: str,
        now: float,
        user_data: bytes = b"",
    ) -> "Writer":
        """A writer of a node, by the names of DDS; `type_hash` as text, "" for none.

        `user_data` stands before the hash. Raises NodeClosed, and ValueError where there are too many.
        """
        found = self._room(node)
        writer = self.participant.create_writer(
            dds_topic, dds_type, _with_hash(qos, type_hash, user_data), now
        )
        found.writers[writer.data.guid] = writer
        self._created(writer.data, now)
        return writer

    def create_reader(
        self,
        node: int,
        dds_topic: str,
        dds_type: str,
        qos: Qos,
        type_hash: str,
        now: float,
        user_data: bytes = b"",
        sink: "Sink | None" = None,
    ) -> "Reader":
        """A reader of a node; see `create_writer`, and `Participant.create_reader` for `sink`."""
        found = self._room(node)
        reader = self.participant.create_reader(
            dds_topic, dds_type, _with_hash(qos, type_hash, user_data), now, sink=sink
        )
        found.readers[reader.data.guid] = reader
        self._created(reader.data, now)
        return reader

    def delete_writer(self, node: int, writer: "Writer", now: float) -> None:
        """Withdraw it; one that is not there is no error."""
        found = self._nodes.get(node)
        if found is not None and found.writers.pop(writer.data.guid, None) is not None:
            self.participant.delete_writer(writer, now)
            self._deleted(writer.data, now)

    def delete_reader(self, node: int, reader: "Reader", now: float) -> None:
        """Withdraw it; one that is not there is no error."""
        found = self._nodes.get(node)
        if found is not None and found.readers.pop(reader.data.guid, None) is not None:
            self.participant.delete_reader(reader, now)
            self._deleted(reader.data, now)

    def vendor_of(self, guid: bytes) -> bytes:
        """The vendor id of an endpoint's participant, VENDORID_UNKNOWN where that is not known (any more)."""
        if guid[:12] == self.participant.guid_prefix:
            return VENDORID_ROSLET
        remote = self.participant.spdp.remotes.get(guid[:12])
        return remote.data.vendor_id if remote is not None else VENDORID_UNKNOWN

    def watch(self, entity_id: bytes, function: "Callable[[Any, float], None]") -> None:
        """Call `function(event, now)` for the matches of our endpoint, as long as that is there. For the machines of this
        package."""
        self._watchers[entity_id] = function

    def _room(self, node: int) -> _Node:
        found = self._nodes.get(node)
        if found is None:
            raise NodeClosed("the node is no more")
        if self._endpoints >= self._max_endpoints:
            raise ValueError("the nodes of a participant have at most %d endpoints" % self._max_endpoints)
        return found

    def _created(self, data: "EndpointData", now: float) -> None:
        self._endpoints += 1
        self.graph.endpoint_discovered(data)
        self._changed(now)

    def _deleted(self, data: "EndpointData", now: float) -> None:
        self._endpoints -= 1
        self._watchers.pop(data.guid[12:], None)
        self.graph.endpoint_lost(data.guid)
        self._changed(now)

    def _changed(self, now: float) -> None:
        if self._writer is None:
            return
        self.graph.nodes_told(self.participant.guid_prefix, self._info())
        if self._publish_at is None:
            self._publish_at = now + self._batch

    def _info(self) -> ParticipantEntities:
        nodes = []
        for handle in sorted(self._nodes):
            node = self._nodes[handle]
            nodes.append(NodeEntities(node.namespace, node.name, tuple(node.readers), tuple(node.writers)))
        return ParticipantEntities(self.participant.guid_prefix + ENTITYID_PARTICIPANT, tuple(nodes))

    # -- events

    def _participant_discovered(self, event: "events.ParticipantDiscovered", now: float) -> bool:
        self.graph.participant_discovered(event.data)
        return True

    def _participant_lost(self, event: "events.ParticipantLost", now: float) -> bool:
        self.graph.participant_lost(event.data.guid_prefix)
        return True

    def _endpoint_discovered(self, event: "events.EndpointDiscovered", now: float) -> bool:
        data = event.data
        self.graph.endpoint_discovered(data)
        if (
            self._old_writer is None
            and self._writer is not None
            and data.topic == discovery_info.TOPIC
            and not data.writer
            and is_old(data)
        ):
            # Announced to all, but it matches the old only, and they alone get the long gids.
            self._old_writer = self.participant.create_writer(
                discovery_info.TOPIC, discovery_info.TYPE, WRITER_QOS, now, accepts=is_old
            )
            self.graph.endpoint_discovered(self._old_writer.data)
            self._old_writer.write(self._info().emit(discovery_info.OLD_GID), now)
        return False

    def _endpoint_lost(self, event: "events.EndpointLost", now: float) -> bool:
        self.graph.endpoint_lost(event.data.guid)
        return False

    def _sample(self, event: "events.SampleReceived", now: float) -> bool:
        if self._reader is None or event.local != self._reader.entity_id:
            return False
        prefix = event.writer[:12]
        if prefix == self.participant.guid_prefix or not event.flags & FLAG_D:
            return True
        try:
            info, _ = discovery_info.parse(event.payload)
            if info.guid[:12] != prefix:
                raise ProtocolError("discovery-info-of-another-participant")
            if not self.graph.nodes_told(prefix, info):
                raise ProtocolError("discovery-info-of-unknown-participant")
        except ProtocolError as error:
            self._count(error.reason)
        return True

    def _of_ours(self, event: "Any", now: float) -> bool:
        """Matches and the like: those of our own topic are nobody else's business."""
        for own in (self._writer, self._old_writer, self._reader):
            if own is not None and event.local == own.entity_id:
                if isinstance(event, events.QosIncompatible):
                    self._count("discovery-info-incompatible")
                return True
        watcher = self._watchers.get(event.local)
        if watcher is not None:
            watcher(event, now)
        return False

    _HANDLERS: "dict[Any, Any]" = {  # noqa: RUF012 - a table, never changed
        events.ParticipantDiscovered: _participant_discovered,
        events.ParticipantLost: _participant_lost,
        events.EndpointDiscovered: _endpoint_discovered,
        events.EndpointLost: _endpoint_lost,
        events.SampleReceived: _sample,
        events.EndpointMatched: _of_ours,
        events.EndpointUnmatched: _of_ours,
        events.QosIncompatible: _of_ours,
        events.SamplesLost: _of_ours,
        events.LivelinessLost: _of_ours,
        events.LivelinessRegained: _of_ours,
    }

    def _count(self, reason: str) -> None:
        self.counters[reason] = self.counters.get(reason, 0) + 1


def _with_hash(qos: Qos, type_hash: str, before: bytes) -> Qos:
    if type_hash:
        before += user_data.pair("typehash", type_hash)
    return qos.replace(user_data=before) if before else qos
