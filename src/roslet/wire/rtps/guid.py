"""GUIDs, entity ids, vendor ids and protocol versions, with the names of the specification. RTPS 2.3, 9.3.1, 9.3.2.

They are octets on the wire whatever the endianness, and `bytes` here, so that they key dictionaries as they come:
a prefix has 12, an entity id 4, a GUID 16 bytes.
"""

PROTOCOLVERSION_MAJOR = 2
PROTOCOLVERSION_2_3 = b"\x02\x03"
PROTOCOLVERSION = PROTOCOLVERSION_2_3
"""What we claim: 2.3, as Fast DDS does; nothing that we send needs a later one."""

VENDORID_UNKNOWN = b"\x00\x00"
VENDORID_RTI = b"\x01\x01"
VENDORID_EPROSIMA = b"\x01\x0f"
VENDORID_CYCLONE = b"\x01\x10"
VENDORID_ROSLET = b"\x01\x52"
"""Ours. OMG has assigned none to roslet; this one is free, and not 0.0, which peers take for unknown."""

VENDOR_NAMES = {
    VENDORID_UNKNOWN: "VENDORID_UNKNOWN",
    VENDORID_RTI: "RTI Connext",
    b"\x01\x02": "OpenSplice",
    b"\x01\x03": "OpenDDS",
    b"\x01\x06": "CoreDX",
    b"\x01\x0a": "RTI Connext Micro",
    VENDORID_EPROSIMA: "eProsima Fast DDS",
    VENDORID_CYCLONE: "Eclipse Cyclone DDS",
    b"\x01\x11": "GurumDDS",
    b"\x01\x12": "RustDDS",
    VENDORID_ROSLET: "roslet",
}

GUIDPREFIX_UNKNOWN = bytes(12)
GUID_UNKNOWN = bytes(16)

ENTITYID_UNKNOWN = b"\x00\x00\x00\x00"
ENTITYID_PARTICIPANT = b"\x00\x00\x01\xc1"
ENTITYID_SEDP_BUILTIN_TOPICS_WRITER = b"\x00\x00\x02\xc2"
ENTITYID_SEDP_BUILTIN_TOPICS_READER = b"\x00\x00\x02\xc7"
ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER = b"\x00\x00\x03\xc2"
ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER = b"\x00\x00\x03\xc7"
ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_WRITER = b"\x00\x00\x04\xc2"
ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_READER = b"\x00\x00\x04\xc7"
ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER = b"\x00\x01\x00\xc2"
ENTITYID_SPDP_BUILTIN_PARTICIPANT_READER = b"\x00\x01\x00\xc7"
ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_WRITER = b"\x00\x02\x00\xc2"
ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_READER = b"\x00\x02\x00\xc7"

ENTITY_NAMES = {
    ENTITYID_UNKNOWN: "ENTITYID_UNKNOWN",
    ENTITYID_PARTICIPANT: "ENTITYID_PARTICIPANT",
    ENTITYID_SEDP_BUILTIN_TOPICS_WRITER: "ENTITYID_SEDP_BUILTIN_TOPICS_WRITER",
    ENTITYID_SEDP_BUILTIN_TOPICS_READER: "ENTITYID_SEDP_BUILTIN_TOPICS_READER",
    ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER: "ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER",
    ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER: "ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER",
    ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_WRITER: "ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_WRITER",
    ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_READER: "ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_READER",
    ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER: "ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER",
    ENTITYID_SPDP_BUILTIN_PARTICIPANT_READER: "ENTITYID_SPDP_BUILTIN_PARTICIPANT_READER",
    ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_WRITER: "ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_WRITER",
    ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_READER: "ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_READER",
}

# The last octet of an entity id (9.3.1.2): its two high bits say whose it is, the rest what it is.
ENTITYKIND_USER_WRITER_WITH_KEY = 0x02
ENTITYKIND_USER_WRITER_NO_KEY = 0x03
ENTITYKIND_USER_READER_NO_KEY = 0x04
ENTITYKIND_USER_READER_WITH_KEY = 0x07
ENTITYKIND_BUILTIN = 0xC0
_WRITERS = (0x02, 0x03)
_READERS = (0x04, 0x07)


def is_writer(entity_id: bytes) -> bool:
    """Whether the kind octet says writer, of whatever owner."""
    return entity_id[-1] & 0x3F in _WRITERS


def is_reader(entity_id: bytes) -> bool:
    """Whether the kind octet says reader, of whatever owner."""
    return entity_id[-1] & 0x3F in _READERS


def is_keyed(entity_id: bytes) -> bool:
    """Whether the kind octet says that the topic has a key."""
    return entity_id[-1] & 0x3F in (0x02, 0x07)


def is_builtin(entity_id: bytes) -> bool:
    """Whether the kind octet says that the endpoint is one of the specification's own."""
    return entity_id[-1] & 0xC0 == ENTITYKIND_BUILTIN


def hexadecimal(data: "bytes | memoryview") -> str:
    """Two digits an octet."""
    return "".join(["%02x" % octet for octet in data])


def entity_name(entity_id: bytes) -> str:
    """The specification's name, or eight hexadecimal digits."""
    return ENTITY_NAMES.get(entity_id) or hexadecimal(entity_id)


def vendor_name(vendor_id: bytes) -> str:
    """The product, or `major.minor`."""
    return VENDOR_NAMES.get(vendor_id) or "%d.%d" % (vendor_id[0], vendor_id[1])


def guid_text(guid: bytes) -> str:
    """`prefix:entity`, as logs print it: the prefix in hexadecimal, the entity by its name where it has one."""
    return "%s:%s" % (hexadecimal(guid[:12]), entity_name(guid[12:]))
