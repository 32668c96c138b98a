"""`ros_discovery_info`: which nodes a participant has, and whose its endpoints are.

The message is rmw_dds_common/msg/ParticipantEntitiesInfo:

    gid of the participant; nodes: sequence of (namespace: string, name: string, readers: sequence of gid, writers: same)

A gid is 16 octets since Iron, and 24 up to Humble: the GUID and eight zeros. The bytes do not say which. `parse` therefore
tries both and takes the one that fits the whole payload, with at most three octets of padding left, legal node names, and
zeros where zeros belong. Read with the wrong size, the participant's own gid puts the count of nodes where the eight
zeros are (then octets are left over), or zeros where a count is (then they are no zeros); so no payload fits both.
"""

from roslet.errors import InvalidName, ProtocolError
from roslet.names import check_namespace, check_node_name
from roslet.record import Record
from roslet.wire.primitives import decode, encode, packer, unpacker

TYPE_CHECKING = False
if TYPE_CHECKING:
    View = bytes | bytearray | memoryview

TOPIC = "ros_discovery_info"
TYPE = "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"
TYPE_HASH = "RIHS01_91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"

GID, OLD_GID = 16, 24
"""Octets of a gid since Iron, and before."""

# Octets of a whole info: some 10,000 endpoints, where a node has about 20.
MAX_INFO = 256 << 10
# Nodes of one participant; a container of components has some dozens.
MAX_NODES = 512
# Readers and writers of one participant, over all of its nodes.
MAX_GIDS = 8192
# Octets of a node's name or namespace with its NUL, as rmw bounds them.
MAX_TEXT = 256

_U32 = (unpacker(">I"), unpacker("<I"))
_EMIT_U32 = (packer(">I"), packer("<I"))
_SPARE = bytes(OLD_GID - GID)


class NodeEntities(Record):
    """One node: `readers` and `writers` are GUIDs of 16 octets."""

    _fields = ("namespace", "name", "readers", "writers")
    __slots__ = _fields

    def __init__(
        self, namespace: str, name: str, readers: "tuple[bytes, ...]" = (), writers: "tuple[bytes, ...]" = ()
    ) -> None:
        self.namespace = namespace
        self.name = name
        self.readers = readers
        self.writers = writers


class ParticipantEntities(Record):
    """A participant's GUID, of 16 octets, and its nodes."""

    _fields = ("guid", "nodes")
    __slots__ = _fields

    def __init__(self, guid: bytes, nodes: "tuple[NodeEntities, ...]" = ()) -> None:
        self.guid = guid
        self.nodes = nodes

    def emit(self, gid_size: int = GID, little: bool = True) -> bytes:
        """The serialised payload, with gids of GID or OLD_GID octets."""
        spare = _SPARE if gid_size == OLD_GID else b""
        data = bytearray(self.guid + spare)
        _put_u32(data, len(self.nodes), little)
        for node in self.nodes:
            for text in (node.namespace, node.name):
                octets = encode(text)
                _put_u32(data, len(octets) + 1, little)
                data += octets
                data += b"\0"
            for guids in (node.readers, node.writers):
                _put_u32(data, len(guids), little)
                for guid in guids:
                    data += guid
                    data += spare
        return (b"\0\1\0\0" if little else b"\0\0\0\0") + bytes(data)


def _put_u32(data: bytearray, value: int, little: bool) -> None:
    at = len(data) + (-len(data) & 3)
    data += bytes(at + 4 - len(data))
    _EMIT_U32[1 if little else 0](data, at, value)


class _Cursor:
    """Where we are in a payload; alignment counts from behind the encapsulation header."""

    def __init__(self, data: "View", little: int, gid_size: int) -> None:
        self.data = data
        self.at = 4
        self.little = little
        self.gid_size = gid_size
        self.gids_left = MAX_GIDS

    def left(self) -> int:
        return len(self.data) - self.at

    def u32(self) -> int:
        self.at += -self.at & 3
        if self.left() < 4:
            raise ProtocolError("discovery-info-truncated", "at byte %d" % self.at)
        value: int = _U32[self.little](self.data, self.at)[0]
        self.at += 4
        return value

    def gid(self) -> bytes:
        end = self.at + self.gid_size
        if end > len(self.data):
            raise ProtocolError("discovery-info-truncated", "at byte %d" % self.at)
        found = bytes(self.data[self.at : self.at + GID])
        if self.gid_size == OLD_GID and bytes(self.data[self.at + GID : end]) != _SPARE:
            raise ProtocolError("discovery-info-gid", "octets behind the GUID, at byte %d" % self.at)
        self.at = end
        return found

    def gids(self) -> "tuple[bytes, ...]":
        count = self.u32()
        if count * self.gid_size > self.left():
            raise ProtocolError("discovery-info-truncated", "%d gids in %d bytes" % (count, self.left()))
        self.gids_left -= count
        if self.gids_left < 0:
            raise ProtocolError("discovery-info-too-large", "more than %d gids" % MAX_GIDS)
        return tuple([self.gid() for _ in range(count)])

    def text(self) -> str:
        size = self.u32()
        if size > self.left():
            raise ProtocolError("discovery-info-truncated", "%d octets of text in %d" % (size, self.left()))
        if not 0 < size <= MAX_TEXT or self.data[self.at + size - 1] != 0:
            raise ProtocolError("discovery-info-name", "a text of %d octets" % size)
        octets = bytes(self.data[self.at : self.at + size - 1])
        self.at += size
        try:
            return decode(octets)
        except ValueError:
            raise ProtocolError("discovery-info-name", "no UTF-8") from None


def _parse(data: "View", little: int, gid_size: int) -> ParticipantEntities:
    cursor = _Cursor(data, little, gid_size)
    guid = cursor.gid()
    count = cursor.u32()
    if count > MAX_NODES:
        raise ProtocolError("discovery-info-too-large", "%d nodes" % count)
    # A node is at least two texts of one NUL and two counts.
    if count * 20 > cursor.left() + 2:
        raise ProtocolError("discovery-info-truncated", "%d nodes in %d bytes" % (count, cursor.left()))
    nodes = []
    for _ in range(count):
        namespace, name = cursor.text(), cursor.text()
        try:
            check_namespace(namespace)
            check_node_name(name)
        except InvalidName as error:
            raise ProtocolError("discovery-info-name", str(error)) from None
        readers = cursor.gids()
        nodes.append(NodeEntities(namespace, name, readers, cursor.gids()))
    if cursor.left() > 3:
        raise ProtocolError("discovery-info-too-long", "%d bytes left over" % cursor.left())
    return ParticipantEntities(guid, tuple(nodes))


def parse(payload: "View", gid_size: int = 0) -> "tuple[ParticipantEntities, int]":
    """The value of a serialised payload and the octets of its gids; `gid_size` GID or OLD_GID where that is known.

    Raises ProtocolError: discovery-info-encapsulation, discovery-info-too-large, discovery-info-truncated,
    discovery-info-too-long, discovery-info-name, discovery-info-gid. What is said is of GID where neither size fits.
    """
    if len(payload) > MAX_INFO:
        raise ProtocolError("discovery-info-too-large", "%d bytes" % len(payload))
    if len(payload) < 4 or payload[0] or payload[1] > 1:
        raise ProtocolError("discovery-info-encapsulation", "%d bytes" % len(payload))
    little = payload[1]
    first = gid_size or GID
    try:
        return _parse(payload, little, first), first
    except ProtocolError as error:
        said = error
    if not gid_size:
        try:
            return _parse(payload, little, OLD_GID), OLD_GID
        except ProtocolError:
            pass
    raise said
