"""What is known of the nodes, topics and services of a domain: discovery's facts in the terms of ROS 2.

What rmw_dds_common's graph cache answers, as it answers it. A topic's or service's name that is none of ROS is told as it
is, with `channel` "".
"""

from roslet.engine.ros2.user_data import value_of
from roslet.names import REPLY, REQUEST, TOPIC, dds_topic, ros_service_type, ros_topic, ros_type
from roslet.record import Record

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.wire.discovery_info import ParticipantEntities
    from roslet.wire.rtps.endpoint_data import EndpointData
    from roslet.wire.rtps.participant_data import ParticipantData
    from roslet.wire.rtps.qos import Qos

PUBLISHER, SUBSCRIPTION = 1, 2
"""What an endpoint is, by rmw's numbers."""

UNKNOWN_NAME, UNKNOWN_NAMESPACE = "_NODE_NAME_UNKNOWN_", "_NODE_NAMESPACE_UNKNOWN_"
"""The node of an endpoint whose participant is of ROS, but has not told whose the endpoint is."""
BARE_NAME = "_CREATED_BY_BARE_DDS_APP_"
"""Name and namespace of the node of an endpoint whose participant is not of ROS."""


class NodeInfo(Record):
    """A node; `participant` is the GUID prefix of its participant, which may have several, also of one name."""

    _fields = ("name", "namespace", "enclave", "participant")
    __slots__ = _fields

    def __init__(self, name: str, namespace: str, enclave: str, participant: bytes) -> None:
        self.name = name
        self.namespace = namespace
        self.enclave = enclave
        self.participant = participant

    @property
    def full_name(self) -> str:
        """Namespace and name."""
        return "/" + self.name if self.namespace == "/" else "%s/%s" % (self.namespace, self.name)


class EndpointInfo(Record):
    """`kind` is PUBLISHER or SUBSCRIPTION, of topic `name` or, where `channel` is REQUEST or REPLY, of service `name`;
    `type_name` is the ROS type (of a service: the service's), `type_hash` its text or "", `gid` 16 octets."""

    _fields = (
        "kind",
        "name",
        "type_name",
        "type_hash",
        "gid",
        "qos",
        "node_name",
        "node_namespace",
        "channel",
    )
    __slots__ = _fields

    def __init__(
        self,
        kind: int,
        name: str,
        type_name: str,
        type_hash: str,
        gid: bytes,
        qos: "Qos",
        node_name: str,
        node_namespace: str,
        channel: str = TOPIC,
    ) -> None:
        self.kind = kind
        self.name = name
        self.type_name = type_name
        self.type_hash = type_hash
        self.gid = gid
        self.qos = qos
        self.node_name = node_name
        self.node_namespace = node_namespace
        self.channel = channel


class _Endpoint:
    """An endpoint with its names in ROS, worked out once."""

    __slots__ = ("channel", "data", "hash", "name", "type", "writer")

    def __init__(self, data: "EndpointData") -> None:
        self.data = data
        self.writer = data.writer
        self.hash = value_of(data.qos.user_data, "typehash") or ""
        self.channel, self.name = ros_topic(data.topic) or ("", data.topic)
        if self.channel in (REQUEST, REPLY):
            self.type = ros_service_type(data.type_name) or data.type_name
        else:
            self.type = ros_type(data.type_name) or data.type_name


class _Participant:
    __slots__ = ("enclave", "nodes", "owners", "told")

    def __init__(self, enclave: "str | None") -> None:
        self.enclave = enclave  # None: not of ROS
        self.told = False  # whether its discovery info has come
        self.nodes: list[NodeInfo] = []
        self.owners: dict[bytes, NodeInfo] = {}  # GUID of an endpoint -> its node


class Graph:
    """Fed by a Context. It holds what the participant holds, so the participant's limits bound it, and of each
    participant the nodes and endpoints that a discovery info may have.

    revision   grows with each change
    """

    def __init__(self) -> None:
        self.revision = 0
        self._participants: dict[bytes, _Participant] = {}
        self._endpoints: dict[bytes, _Endpoint] = {}
        self._by_topic: dict[str, dict[bytes, _Endpoint]] = {}  # by the topic's name in DDS

    # -- what a Context tells it

    def participant_discovered(self, data: "ParticipantData") -> None:
        """A participant, ours included; told anew when its data changes."""
        enclave = value_of(data.user_data, "enclave")
        known = self._participants.get(data.guid_prefix)
        if known is None:
            self._participants[data.guid_prefix] = _Participant(enclave)
        else:
            known.enclave = enclave
        self.revision += 1

    def participant_lost(self, prefix: bytes) -> None:
        """A participant with all it had."""
        if self._participants.pop(prefix, None) is not None:
            self.revision += 1
        for guid in [guid for guid in self._endpoints if guid[:12] == prefix]:
            self.endpoint_lost(guid)

    def endpoint_discovered(self, data: "EndpointData") -> None:
        """An endpoint, ours included; told anew when its data changes."""
        self.endpoint_lost(data.guid)
        found = self._endpoints[data.guid] = _Endpoint(data)
        self._by_topic.setdefault(data.topic, {})[data.guid] = found
        self.revision += 1

    def endpoint_lost(self, guid: bytes) -> None:
        """An endpoint that is no more; one that is not known is no error."""
        found = self._endpoints.pop(guid, None)
        if found is None:
            return
        same = self._by_topic[found.data.topic]
        del same[guid]
        if not same:
            del self._by_topic[found.data.topic]
        self.revision += 1

    def nodes_told(self, prefix: bytes, info: "ParticipantEntities") -> bool:
        """What a participant says of its nodes. False where the participant is not known (any more)."""
        known = self._participants.get(prefix)
        if known is None:
            return False
        known.told = True
        known.nodes = []
        known.owners = {}
        for entities in info.nodes:
            node = NodeInfo(entities.name, entities.namespace, known.enclave or "", prefix)
            known.nodes.append(node)
            for guid in entities.readers + entities.writers:
                if guid[:12] == prefix:
                    known.owners[guid] = node
        self.revision += 1
        return True

    # -- what it answers

    def complete(self) -> bool:
        """Whether every participant of ROS has told of its nodes, and every endpoint that it told of is known: nothing is
        known to be missing."""
        for participant in self._participants.values():
            if participant.enclave is not None and not participant.told:
                return False
            for guid in participant.owners:
                if guid not in self._endpoints:
                    return False
        return True

    def nodes(self) -> "list[NodeInfo]":
        """Every node that its participant has told of, ours included."""
        found: list[NodeInfo] = []
        for participant in self._participants.values():
            found += participant.nodes
        return found

    def endpoint_data(self) -> "list[EndpointData]":
        """Every endpoint as discovery announced it, those that are not of ROS too."""
        return [one.data for one in self._endpoints.values()]

    def endpoints(
        self,
        topic: "str | None" = None,
        node: "tuple[str, str] | None" = None,
        writers: "bool | None" = None,
        channel: "str | None" = TOPIC,
    ) -> "list[EndpointInfo]":
        """Endpoints by the full name of their topic or service, their node (name, namespace), and direction.

        `channel` TOPIC, REQUEST or REPLY, "" for those that are not of ROS, None for all.
        """
        found = []
        among = self._endpoints
        if topic is not None and channel is not None:
            among = self._by_topic.get(dds_topic(channel, topic) if channel else topic, {})
        for one in among.values():
            if topic is not None and one.name != topic:
                continue
            if channel is not None and one.channel != channel:
                continue
            if writers is not None and one.writer != writers:
                continue
            owner = self.node_of(one.data.guid)
            if node is None or owner == node:
                found.append(
                    EndpointInfo(
                        PUBLISHER if one.writer else SUBSCRIPTION,
                        one.name,
                        one.type,
                        one.hash,
                        one.data.guid,
                        one.data.qos,
                        owner[0],
                        owner[1],
                        one.channel,
                    )
                )
        return found

    def node_of(self, guid: bytes) -> "tuple[str, str]":
        """(name, namespace) of an endpoint's node; UNKNOWN_NAME and UNKNOWN_NAMESPACE, or twice BARE_NAME."""
        participant = self._participants.get(guid[:12])
        if participant is None or (participant.enclave is None and not participant.told):
            return BARE_NAME, BARE_NAME
        owner = participant.owners.get(guid)
        return (owner.name, owner.namespace) if owner is not None else (UNKNOWN_NAME, UNKNOWN_NAMESPACE)

    def hash_of(self, guid: bytes) -> str:
        """The type hash that an endpoint announced, "" where it announced none or is not known."""
        found = self._endpoints.get(guid)
        return "" if found is None else found.hash

    def topics(
        self, node: "tuple[str, str] | None" = None, writers: "bool | None" = None, mangled: bool = False
    ) -> "dict[str, list[str]]":
        """Topics and their types, sorted: all of them, or those that node (name, namespace) publishes (`writers` True) or
        subscribes (False). `mangled`: every topic of DDS by its names there."""
        found: dict[str, list[str]] = {}
        for one in self._endpoints.values():
            if (mangled or one.channel == TOPIC) and self._wanted(one, node, writers):
                if mangled:
                    _note(found, one.data.topic, one.data.type_name)
                else:
                    _note(found, one.name, one.type)
        return _sorted(found)

    def services(self, node: "tuple[str, str] | None" = None) -> "dict[str, list[str]]":
        """Services that somebody, or node (name, namespace), serves, and their types."""
        return self._of_services(node, True)

    def clients(self, node: "tuple[str, str] | None" = None) -> "dict[str, list[str]]":
        """Services of which somebody, or node (name, namespace), is a client, and their types."""
        return self._of_services(node, False)

    def count(self, topic: str, writers: bool) -> int:
        """How many endpoints write, or read, a topic, by its name in DDS."""
        return len([one for one in self._by_topic.get(topic, {}).values() if one.writer == writers])

    def _of_services(self, node: "tuple[str, str] | None", serving: bool) -> "dict[str, list[str]]":
        found: dict[str, list[str]] = {}
        for one in self._endpoints.values():
            # The reader that tells a server from a client: of requests, or of replies.
            if one.channel == (REQUEST if serving else REPLY) and self._wanted(one, node, False):
                _note(found, one.name, one.type)
        return _sorted(found)

    def _wanted(self, one: _Endpoint, node: "tuple[str, str] | None", writers: "bool | None") -> bool:
        if writers is not None and one.writer != writers:
            return False
        return node is None or self.node_of(one.data.guid) == node


def _note(found: "dict[str, list[str]]", name: str, type_name: str) -> None:
    types = found.setdefault(name, [])
    if type_name not in types:
        types.append(type_name)


def _sorted(found: "dict[str, list[str]]") -> "dict[str, list[str]]":
    ordered = {}
    for name in sorted(found):
        ordered[name] = sorted(found[name])
    return ordered
