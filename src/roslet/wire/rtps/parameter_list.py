"""Parameter lists and parameter ids. RTPS 2.3, 9.4.2.11 (bytes), 9.6.2.2.2 and 9.6.3 (ids).

    pid (2), length (2), length octets; ...; PID_SENTINEL (2), ignored (2)

Discovery data is a list behind an encapsulation header (PL_CDR, big or little endian); inline QoS is a bare list in
the byte order of its submessage.
"""

from roslet.errors import ProtocolError
from roslet.record import Names
from roslet.wire.primitives import packer, unpacker

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

PID_PAD = 0x0000
PID_SENTINEL = 0x0001
PID_PARTICIPANT_LEASE_DURATION = 0x0002
PID_TIME_BASED_FILTER = 0x0004
PID_TOPIC_NAME = 0x0005
PID_OWNERSHIP_STRENGTH = 0x0006
PID_TYPE_NAME = 0x0007
PID_DOMAIN_ID = 0x000F
PID_PROTOCOL_VERSION = 0x0015
PID_VENDORID = 0x0016
PID_RELIABILITY = 0x001A
PID_LIVELINESS = 0x001B
PID_DURABILITY = 0x001D
PID_DURABILITY_SERVICE = 0x001E
PID_OWNERSHIP = 0x001F
PID_PRESENTATION = 0x0021
PID_DEADLINE = 0x0023
PID_DESTINATION_ORDER = 0x0025
PID_LATENCY_BUDGET = 0x0027
PID_PARTITION = 0x0029
PID_LIFESPAN = 0x002B
PID_USER_DATA = 0x002C
PID_GROUP_DATA = 0x002D
PID_TOPIC_DATA = 0x002E
PID_UNICAST_LOCATOR = 0x002F
PID_MULTICAST_LOCATOR = 0x0030
PID_DEFAULT_UNICAST_LOCATOR = 0x0031
PID_METATRAFFIC_UNICAST_LOCATOR = 0x0032
PID_METATRAFFIC_MULTICAST_LOCATOR = 0x0033
PID_PARTICIPANT_MANUAL_LIVELINESS_COUNT = 0x0034
PID_HISTORY = 0x0040
PID_RESOURCE_LIMITS = 0x0041
PID_EXPECTS_INLINE_QOS = 0x0043
PID_DEFAULT_MULTICAST_LOCATOR = 0x0048
PID_TRANSPORT_PRIORITY = 0x0049
PID_PARTICIPANT_GUID = 0x0050
PID_GROUP_GUID = 0x0052
PID_CONTENT_FILTER_INFO = 0x0055
PID_COHERENT_SET = 0x0056
PID_DIRECTED_WRITE = 0x0057
PID_BUILTIN_ENDPOINT_SET = 0x0058
PID_PROPERTY_LIST = 0x0059
PID_ENDPOINT_GUID = 0x005A
PID_TYPE_MAX_SIZE_SERIALIZED = 0x0060
PID_ORIGINAL_WRITER_INFO = 0x0061
PID_ENTITY_NAME = 0x0062
PID_KEY_HASH = 0x0070
PID_STATUS_INFO = 0x0071
PID_DATA_REPRESENTATION = 0x0073
PID_TYPE_CONSISTENCY_ENFORCEMENT = 0x0074
PID_TYPE_INFORMATION = 0x0075
PID_BUILTIN_ENDPOINT_QOS = 0x0077
PID_RELATED_SAMPLE_IDENTITY = 0x0083
PID_DOMAIN_TAG = 0x4014
# Of eProsima; only its own, and who imitates it, give them this meaning.
PID_NETWORK_CONFIGURATION_SET = 0x8007
PID_CUSTOM_RELATED_SAMPLE_IDENTITY = 0x800F
# Of Eclipse Cyclone DDS.
PID_CYCLONE_RECEIVE_BUFFER_SIZE = 0x8016
PID_CYCLONE_PARTICIPANT_VERSION_INFO = 0x8007

NAMES = Names(
    "pid",
    {
        value: name
        for name, value in list(globals().items())
        if name.startswith("PID_") and "CYCLONE" not in name
    },
)

FLAG_VENDOR = 0x8000
FLAG_MUST_UNDERSTAND = 0x4000

# Real lists hold under 40; a participant on many networks some 100. Fewer than fit a datagram.
MAX_PARAMETERS = 512

_PARSE = (unpacker(">HH"), unpacker("<HH"))
_EMIT = (packer(">HH"), packer("<HH"))

PL_CDR_BE = b"\x00\x02"
PL_CDR_LE = b"\x00\x03"


def parse(
    data: "bytes | bytearray | memoryview", at: int, end: int, flags: int
) -> "Iterator[tuple[int, int, int]]":
    """(pid, start, end) of every parameter but PID_PAD, in order, up to the sentinel.

    Raises ProtocolError: parameter-list-unterminated, parameter-truncated, too-many-parameters.
    """
    unpack = _PARSE[flags & 1]
    for _ in range(MAX_PARAMETERS):
        if end - at < 4:
            raise ProtocolError("parameter-list-unterminated", "at byte %d" % at)
        pid, length = unpack(data, at)
        at += 4
        if pid == PID_SENTINEL:
            return
        if length > end - at:
            raise ProtocolError(
                "parameter-truncated", "%s of %d bytes with %d left" % (NAMES[pid], length, end - at)
            )
        if pid != PID_PAD:
            yield pid, at, at + length
        at += length
    raise ProtocolError("too-many-parameters", "more than %d" % MAX_PARAMETERS)


def skip(data: "bytes | bytearray | memoryview", at: int, end: int, flags: int) -> int:
    """The offset behind the sentinel. Raises what `parse` raises."""
    unpack = _PARSE[flags & 1]
    for _ in range(MAX_PARAMETERS):
        if end - at < 4:
            raise ProtocolError("parameter-list-unterminated", "at byte %d" % at)
        pid, length = unpack(data, at)
        at += 4
        if pid == PID_SENTINEL:
            return at
        if length > end - at:
            raise ProtocolError(
                "parameter-truncated", "%s of %d bytes with %d left" % (NAMES[pid], length, end - at)
            )
        at += length
    raise ProtocolError("too-many-parameters", "more than %d" % MAX_PARAMETERS)


def emit(parameters: "list[tuple[int, bytes]]", little: bool = True) -> bytes:
    """The list with its sentinel; each value is padded with zeros to a multiple of 4.

    Raises ValueError for a value beyond 65,532 octets, which no list can carry.
    """
    pack = _EMIT[1 if little else 0]
    parts: list[bytes | bytearray] = []
    for pid, value in parameters:
        pad = -len(value) & 3
        if len(value) + pad > 0xFFFC:
            raise ValueError("%s of %d bytes" % (NAMES[pid], len(value)))
        front = bytearray(4)
        pack(front, 0, pid, len(value) + pad)
        parts.append(front)
        parts.append(value)
        parts.append(bytes(pad))
    last = bytearray(4)
    pack(last, 0, PID_SENTINEL, 0)
    parts.append(last)
    return b"".join(parts)


def encapsulate(parameters: "list[tuple[int, bytes]]", little: bool = True) -> bytes:
    """A serialised payload: PL_CDR header and list."""
    return (PL_CDR_LE if little else PL_CDR_BE) + b"\0\0" + emit(parameters, little)


def encapsulation(payload: "bytes | bytearray | memoryview") -> int:
    """The flags (bit 0: little endian) of a payload that is a parameter list; it starts at byte 4.

    Raises ProtocolError: payload-truncated, payload-not-a-parameter-list.
    """
    if len(payload) < 4:
        raise ProtocolError("payload-truncated", "%d bytes" % len(payload))
    kind = bytes(payload[:2])
    if kind == PL_CDR_LE:
        return 1
    if kind == PL_CDR_BE:
        return 0
    raise ProtocolError("payload-not-a-parameter-list", "encapsulation %d" % (kind[0] << 8 | kind[1]))
