"""What SEDP says of a writer or reader: DiscoveredWriterData, DiscoveredReaderData. RTPS 2.3, 8.5.4.4, 9.6.2.2."""

from roslet.errors import ProtocolError
from roslet.record import Record
from roslet.wire.rtps import parameter_list as pl
from roslet.wire.rtps import qos as policies
from roslet.wire.rtps import typed, values
from roslet.wire.rtps.guid import GUID_UNKNOWN, is_reader, is_writer
from roslet.wire.rtps.qos import READER_DEFAULTS, WRITER_DEFAULTS, Qos
from roslet.wire.rtps.typed import Parameter

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.wire.rtps.locator import Locator


class EndpointData(Record):
    """`guid` of the endpoint; without locators those of its participant count. `type_information` is opaque (DDS-XTypes)."""

    _fields = (
        "guid",
        "topic",
        "type_name",
        "qos",
        "unicast",
        "multicast",
        "participant_guid",
        "group_guid",
        "expects_inline_qos",
        "max_size",
        "entity_name",
        "type_information",
    )
    __slots__ = _fields

    def __init__(
        self,
        guid: bytes = GUID_UNKNOWN,
        topic: str = "",
        type_name: str = "",
        qos: Qos = READER_DEFAULTS,
        unicast: "tuple[Locator, ...]" = (),
        multicast: "tuple[Locator, ...]" = (),
        participant_guid: bytes = b"",
        group_guid: bytes = b"",
        expects_inline_qos: bool = False,
        max_size: int = 0,
        entity_name: str = "",
        type_information: bytes = b"",
    ) -> None:
        self.guid = guid
        self.topic = topic
        self.type_name = type_name
        self.qos = qos
        self.unicast = unicast
        self.multicast = multicast
        self.participant_guid = participant_guid
        self.group_guid = group_guid
        self.expects_inline_qos = expects_inline_qos
        self.max_size = max_size
        self.entity_name = entity_name
        self.type_information = type_information

    @property
    def writer(self) -> bool:
        """Whether this is a writer, by its entity id."""
        return is_writer(self.guid)

    def emit(self, little: bool = True) -> bytes:
        """The serialised payload. RELIABILITY is always said: its default differs between writers and readers."""
        parameters = typed.emit(self, PARAMETERS, _ABSENT, little)
        parameters += typed.emit(self.qos, policies.PARAMETERS, _ABSENT_QOS, little)
        return pl.encapsulate(parameters, little)


def _octets() -> "values.Codec":
    def parse(data: "values.View", at: int, end: int, flags: int) -> bytes:
        return bytes(data[at:end])

    def emit(value: bytes, little: bool) -> bytes:
        return value

    return parse, emit


PARAMETERS = (
    Parameter(pl.PID_ENDPOINT_GUID, "guid", values.GUID),
    Parameter(pl.PID_PARTICIPANT_GUID, "participant_guid", values.GUID),
    Parameter(pl.PID_GROUP_GUID, "group_guid", values.GUID),
    Parameter(pl.PID_TOPIC_NAME, "topic", values.STRING),
    Parameter(pl.PID_TYPE_NAME, "type_name", values.STRING),
    Parameter(pl.PID_UNICAST_LOCATOR, "unicast", values.LOCATOR, True),
    Parameter(pl.PID_MULTICAST_LOCATOR, "multicast", values.LOCATOR, True),
    Parameter(pl.PID_EXPECTS_INLINE_QOS, "expects_inline_qos", values.BOOL),
    Parameter(pl.PID_TYPE_MAX_SIZE_SERIALIZED, "max_size", values.U32),
    Parameter(pl.PID_ENTITY_NAME, "entity_name", values.STRING),
    Parameter(pl.PID_TYPE_INFORMATION, "type_information", _octets()),
)
_TABLE = typed.table(PARAMETERS + policies.PARAMETERS)
_QOS_NAMES = [parameter.name for parameter in policies.PARAMETERS]
_ABSENT = EndpointData(b"")
_ABSENT_QOS = Qos(reliability=(0, 0), durability=-1)


def parse(payload: "bytes | bytearray | memoryview") -> EndpointData:
    """The value of a serialised payload.

    Raises ProtocolError: endpoint-without-guid, endpoint-without-topic, endpoint-without-type, endpoint-kind-unknown,
    and what `typed.parse` raises.
    """
    found = typed.parse(payload, 4, len(payload), pl.encapsulation(payload), _TABLE)
    guid = found.get("guid")
    if guid is None or guid == GUID_UNKNOWN:
        raise ProtocolError("endpoint-without-guid")
    if not is_writer(guid) and not is_reader(guid):
        raise ProtocolError("endpoint-kind-unknown", "%d" % guid[15])
    if not found.get("topic"):
        raise ProtocolError("endpoint-without-topic")
    if not found.get("type_name"):
        raise ProtocolError("endpoint-without-type")
    said = {}
    for name in _QOS_NAMES:
        if name in found:
            said[name] = found.pop(name)
    defaults = WRITER_DEFAULTS if is_writer(guid) else READER_DEFAULTS
    if "reliability" not in said:
        said["reliability"] = defaults.reliability
    found["qos"] = Qos(**said)
    return EndpointData(**found)


def parse_key(payload: "bytes | bytearray | memoryview") -> bytes:
    """The GUID in a serialised key. Raises ProtocolError endpoint-without-guid, and what `typed.parse` raises."""
    found = typed.parse(payload, 4, len(payload), pl.encapsulation(payload), _TABLE)
    guid: bytes = found.get("guid", GUID_UNKNOWN)
    if guid == GUID_UNKNOWN:
        raise ProtocolError("endpoint-without-guid")
    return guid
