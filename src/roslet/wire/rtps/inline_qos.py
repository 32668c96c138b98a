"""What comes with a sample: key hash, status, related sample. RTPS 2.3, 8.7.8, 9.6.3."""

from roslet.record import Record
from roslet.wire.primitives import packer, unpacker
from roslet.wire.rtps import parameter_list as pl
from roslet.wire.rtps import typed, values
from roslet.wire.rtps.typed import Parameter

# StatusInfo_t, 9.6.3.4: the last of four octets, whatever the endianness.
STATUS_DISPOSED = 0x01
STATUS_UNREGISTERED = 0x02
STATUS_FILTERED = 0x04

_IDENTITY = (unpacker(">16siI"), unpacker("<16siI"))
_EMIT_IDENTITY = (packer(">16siI"), packer("<16siI"))


def _parse_status(data: "values.View", at: int, end: int, flags: int) -> int:
    if end - at < 4:
        raise values.truncated(end - at, 4)
    return data[at + 3]


def _emit_status(value: int, little: bool) -> bytes:
    return bytes((0, 0, 0, value))


def _parse_identity(data: "values.View", at: int, end: int, flags: int) -> "tuple[bytes, int]":
    if end - at < 24:
        raise values.truncated(end - at, 24)
    guid, high, low = _IDENTITY[flags & 1](data, at)
    return guid, (high << 32) | low


def _emit_identity(value: "tuple[bytes, int]", little: bool) -> bytes:
    data = bytearray(24)
    _EMIT_IDENTITY[1 if little else 0](data, 0, value[0], value[1] >> 32, value[1] & 0xFFFFFFFF)
    return bytes(data)


class InlineQos(Record):
    """`key_hash` 16 octets or empty; `status` of STATUS_ bits; `related` and `custom_related` (GUID, sequence number) of the
    sample that this one answers, or None, the second as eProsima's older number has it."""

    _fields = ("key_hash", "status", "related", "custom_related", "topic")
    __slots__ = _fields

    def __init__(
        self,
        key_hash: bytes = b"",
        status: int = 0,
        related: "tuple[bytes, int] | None" = None,
        custom_related: "tuple[bytes, int] | None" = None,
        topic: str = "",
    ) -> None:
        self.key_hash = key_hash
        self.status = status
        self.related = related
        self.custom_related = custom_related
        self.topic = topic

    def emit(self, little: bool = True) -> bytes:
        """The list with its sentinel."""
        return pl.emit(typed.emit(self, PARAMETERS, NONE, little), little)


PARAMETERS = (
    Parameter(pl.PID_TOPIC_NAME, "topic", values.STRING),
    Parameter(pl.PID_KEY_HASH, "key_hash", values.GUID),
    Parameter(pl.PID_STATUS_INFO, "status", (_parse_status, _emit_status)),
    Parameter(pl.PID_CUSTOM_RELATED_SAMPLE_IDENTITY, "custom_related", (_parse_identity, _emit_identity)),
    Parameter(pl.PID_RELATED_SAMPLE_IDENTITY, "related", (_parse_identity, _emit_identity)),
)
_TABLE = typed.table(PARAMETERS)
NONE = InlineQos()
"""What absent inline QoS means."""


def parse(data: "bytes | memoryview", little: bool) -> InlineQos:
    """The value of a DATA's `inline_qos`, in the byte order of its submessage. Raises what `typed.parse` raises."""
    if not data:
        return NONE
    return InlineQos(**typed.parse(data, 0, len(data), 1 if little else 0, _TABLE))
