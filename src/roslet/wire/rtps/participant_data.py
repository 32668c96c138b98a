"""What SPDP says of a participant: SPDPdiscoveredParticipantData. RTPS 2.3, 8.5.3.2, 9.6.2.2, tables 9.12 and 9.13."""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.rtps import parameter_list as pl
from roslet.wire.rtps import typed, values
from roslet.wire.rtps.guid import (
    ENTITYID_PARTICIPANT,
    GUID_UNKNOWN,
    PROTOCOLVERSION,
    VENDORID_ROSLET,
    VENDORID_UNKNOWN,
)
from roslet.wire.rtps.typed import Parameter

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.wire.rtps.locator import Locator

# BuiltinEndpointSet_t, 9.3.2: one bit a builtin endpoint.
PARTICIPANT_ANNOUNCER = 0x0001
PARTICIPANT_DETECTOR = 0x0002
PUBLICATIONS_ANNOUNCER = 0x0004
PUBLICATIONS_DETECTOR = 0x0008
SUBSCRIPTIONS_ANNOUNCER = 0x0010
SUBSCRIPTIONS_DETECTOR = 0x0020
PARTICIPANT_MESSAGE_DATA_WRITER = 0x0400
PARTICIPANT_MESSAGE_DATA_READER = 0x0800
BUILTIN_ENDPOINTS = 0x0C3F
"""All of the above: what a participant without security and without topic announcements has."""

DEFAULT_LEASE = 100 * 1000000000
"""Nanoseconds, where PID_PARTICIPANT_LEASE_DURATION is absent (9.6.2.2.2)."""


class ParticipantData(Record):
    """`guid` of the participant (its entity id included); `lease` in nanoseconds; `domain_id` None where the peer is too old
    to say it."""

    _fields = (
        "guid",
        "version",
        "vendor_id",
        "domain_id",
        "domain_tag",
        "metatraffic_unicast",
        "metatraffic_multicast",
        "default_unicast",
        "default_multicast",
        "lease",
        "builtin_endpoints",
        "builtin_endpoint_qos",
        "expects_inline_qos",
        "manual_liveliness_count",
        "user_data",
        "entity_name",
        "properties",
    )
    __slots__ = _fields

    def __init__(
        self,
        guid: bytes = GUID_UNKNOWN,
        version: bytes = PROTOCOLVERSION,
        vendor_id: bytes = VENDORID_UNKNOWN,
        domain_id: "int | None" = None,
        domain_tag: str = "",
        metatraffic_unicast: "tuple[Locator, ...]" = (),
        metatraffic_multicast: "tuple[Locator, ...]" = (),
        default_unicast: "tuple[Locator, ...]" = (),
        default_multicast: "tuple[Locator, ...]" = (),
        lease: int = DEFAULT_LEASE,
        builtin_endpoints: int = 0,
        builtin_endpoint_qos: int = 0,
        expects_inline_qos: bool = False,
        manual_liveliness_count: int = 0,
        user_data: bytes = b"",
        entity_name: str = "",
        properties: "tuple[tuple[str, str], ...]" = (),
    ) -> None:
        self.guid = guid
        self.version = version
        self.vendor_id = vendor_id
        self.domain_id = domain_id
        self.domain_tag = domain_tag
        self.metatraffic_unicast = metatraffic_unicast
        self.metatraffic_multicast = metatraffic_multicast
        self.default_unicast = default_unicast
        self.default_multicast = default_multicast
        self.lease = lease
        self.builtin_endpoints = builtin_endpoints
        self.builtin_endpoint_qos = builtin_endpoint_qos
        self.expects_inline_qos = expects_inline_qos
        self.manual_liveliness_count = manual_liveliness_count
        self.user_data = user_data
        self.entity_name = entity_name
        self.properties = properties

    @property
    def guid_prefix(self) -> bytes:
        """12 octets."""
        return self.guid[:12]

    def emit(self, little: bool = True) -> bytes:
        """The serialised payload. Always says version, vendor, GUID, lease and builtin endpoints: peers require them."""
        return pl.encapsulate(typed.emit(self, PARAMETERS, _ABSENT, little), little)

    def emit_key(self, little: bool = True) -> bytes:
        """The serialised key: the GUID alone, as a departure carries it."""
        return pl.encapsulate([(pl.PID_PARTICIPANT_GUID, self.guid)], little)


PARAMETERS = (
    Parameter(pl.PID_PROTOCOL_VERSION, "version", values.PAIR),
    Parameter(pl.PID_VENDORID, "vendor_id", values.PAIR),
    Parameter(pl.PID_PARTICIPANT_GUID, "guid", values.GUID),
    Parameter(pl.PID_DOMAIN_ID, "domain_id", values.U32),
    Parameter(pl.PID_DOMAIN_TAG, "domain_tag", values.STRING),
    Parameter(pl.PID_METATRAFFIC_UNICAST_LOCATOR, "metatraffic_unicast", values.LOCATOR, True),
    Parameter(pl.PID_METATRAFFIC_MULTICAST_LOCATOR, "metatraffic_multicast", values.LOCATOR, True),
    Parameter(pl.PID_DEFAULT_UNICAST_LOCATOR, "default_unicast", values.LOCATOR, True),
    Parameter(pl.PID_DEFAULT_MULTICAST_LOCATOR, "default_multicast", values.LOCATOR, True),
    Parameter(pl.PID_PARTICIPANT_LEASE_DURATION, "lease", values.DURATION),
    Parameter(pl.PID_BUILTIN_ENDPOINT_SET, "builtin_endpoints", values.U32),
    Parameter(pl.PID_BUILTIN_ENDPOINT_QOS, "builtin_endpoint_qos", values.U32),
    Parameter(pl.PID_EXPECTS_INLINE_QOS, "expects_inline_qos", values.BOOL),
    Parameter(pl.PID_PARTICIPANT_MANUAL_LIVELINESS_COUNT, "manual_liveliness_count", values.U32),
    Parameter(pl.PID_USER_DATA, "user_data", values.OCTETS),
    Parameter(pl.PID_ENTITY_NAME, "entity_name", values.STRING),
    Parameter(pl.PID_PROPERTY_LIST, "properties", values.PROPERTIES),
)
_TABLE = typed.table(PARAMETERS)
# Equal to no real participant in the fields that are always emitted.
_ABSENT = ParticipantData(guid=b"", version=b"", vendor_id=b"", lease=-1, builtin_endpoints=-1)


def parse(payload: "bytes | bytearray | memoryview") -> ParticipantData:
    """The value of a serialised payload, or of a serialised key (then only `guid` is known).

    Raises ProtocolError: participant-without-guid, and what `typed.parse` raises.
    """
    flags = pl.encapsulation(payload)
    found = typed.parse(payload, 4, len(payload), flags, _TABLE)
    guid = found.get("guid")
    if guid is None or guid == GUID_UNKNOWN:
        raise ProtocolError("participant-without-guid")
    return ParticipantData(**found)


def own(guid_prefix: bytes, **fields: object) -> ParticipantData:
    """A participant of ours: version, vendor and builtin endpoints filled in."""
    named: dict[str, object] = {"vendor_id": VENDORID_ROSLET, "builtin_endpoints": BUILTIN_ENDPOINTS}
    named.update(fields)
    return ParticipantData(guid_prefix + ENTITYID_PARTICIPANT, **named)  # type: ignore[arg-type]
