"""Submessage kinds, flags, and the walk over a message. RTPS 2.3, 8.3.4.1 (rules), 9.4.5.1 (bytes)."""

from roslet.errors import ProtocolError
from roslet.record import Names
from roslet.wire.rtps.header import SIZE as HEADER_SIZE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

PAD = 0x01
ACKNACK = 0x06
HEARTBEAT = 0x07
GAP = 0x08
INFO_TS = 0x09
INFO_SRC = 0x0C
INFO_REPLY_IP4 = 0x0D
INFO_DST = 0x0E
INFO_REPLY = 0x0F
NACK_FRAG = 0x12
HEARTBEAT_FRAG = 0x13
DATA = 0x15
DATA_FRAG = 0x16

NAMES = Names(
    "submessage",
    {
        PAD: "PAD",
        ACKNACK: "ACKNACK",
        HEARTBEAT: "HEARTBEAT",
        GAP: "GAP",
        INFO_TS: "INFO_TS",
        INFO_SRC: "INFO_SRC",
        INFO_REPLY_IP4: "INFO_REPLY_IP4",
        INFO_DST: "INFO_DST",
        INFO_REPLY: "INFO_REPLY",
        NACK_FRAG: "NACK_FRAG",
        HEARTBEAT_FRAG: "HEARTBEAT_FRAG",
        DATA: "DATA",
        DATA_FRAG: "DATA_FRAG",
    },
)

FLAG_E = 0x01  # little endian; every submessage has it

# A 64 KiB datagram of the smallest DATA that exists holds some 2,700; what holds more is meant to cost us time.
MAX_SUBMESSAGES = 4096


def walk(
    data: "bytes | bytearray | memoryview", at: int = HEADER_SIZE
) -> "Iterator[tuple[int, int, int, int]]":
    """(kind, flags, start, end) of each submessage, without its header, in order; unknown kinds too.

    A length of zero means up to the end of the message, except for PAD and INFO_TS. What came before a fault stays
    valid (8.3.4.1), so the fault is raised where the walk reaches it. Raises ProtocolError: submessage-truncated,
    submessage-too-long, too-many-submessages.
    """
    size = len(data)
    count = 0
    while at < size:
        end = end_of(data, at, count)
        count += 1
        yield data[at], data[at + 1], at + 4, end
        at = end


def end_of(data: "bytes | bytearray | memoryview", at: int, count: int) -> int:
    """Where the submessage at `at` ends, which is the one after `count` others: a step of `walk`, whose tuples would be
    garbage on MicroPython."""
    size = len(data)
    if size - at < 4:
        raise ProtocolError("submessage-truncated", "%d bytes at byte %d" % (size - at, at))
    if count >= MAX_SUBMESSAGES:
        raise ProtocolError("too-many-submessages", "more than %d" % MAX_SUBMESSAGES)
    kind = data[at]
    length = data[at + 2] | data[at + 3] << 8 if data[at + 1] & FLAG_E else data[at + 2] << 8 | data[at + 3]
    if length == 0 and kind != PAD and kind != INFO_TS:
        return size
    end = at + 4 + length
    if end > size:
        raise ProtocolError(
            "submessage-too-long",
            "%s of %d bytes with %d left, at byte %d" % (NAMES[kind], length, size - at - 4, at),
        )
    return end


def truncated(kind: int, have: int, need: int) -> ProtocolError:
    """The fault of a submessage that is shorter than its fixed part or its counts say: `data-truncated`, ..."""
    name = NAMES[kind].lower().replace("_", "-")
    return ProtocolError(name + "-truncated", "%d bytes, needs %d" % (have, need))


def invalid(kind: int, what: str) -> ProtocolError:
    """The fault of a submessage that breaks its validity rules: `heartbeat-invalid`, ..."""
    return ProtocolError(NAMES[kind].lower().replace("_", "-") + "-invalid", what)
