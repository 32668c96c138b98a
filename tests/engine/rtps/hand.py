"""RTPS messages by hand, from the specification (RTPS 2.3, 9.4): for what no honest codec emits. Runs on MicroPython.

Functions take `e`, "<" or ">", the byte order; they check nothing.
"""

import struct

PREFIX = b"\x01\x0f" + bytes(range(10))
HOST = "10.0.0.9"
SOURCE = (HOST, 7410)

SPDP_WRITER, SPDP_READER = b"\0\1\0\xc2", b"\0\1\0\xc7"
PUBLICATIONS_WRITER, PUBLICATIONS_READER = b"\0\0\3\xc2", b"\0\0\3\xc7"
SUBSCRIPTIONS_WRITER, SUBSCRIPTIONS_READER = b"\0\0\4\xc2", b"\0\0\4\xc7"
WRITER, READER = b"\0\0\x11\x03", b"\0\0\x22\x04"
ANYONE = bytes(4)
PARTICIPANT = b"\0\0\1\xc1"

LAST = 0x7FFFFFFFFFFFFFFF
"""The last sequence number."""

FOREVER = (0x7FFFFFFF, 0xFFFFFFFF)


def message(*submessages: bytes, prefix: bytes = PREFIX) -> bytes:
    """A datagram of eProsima's, protocol 2.3."""
    return b"RTPS\x02\x03\x01\x0f" + prefix + b"".join(submessages)


def submessage(kind: int, flags: int, body: bytes, e: str = "<", length: "int | None" = None) -> bytes:
    """Any submessage; `length` where it shall not be the body's."""
    flags |= 1 if e == "<" else 0
    return struct.pack(e + "BBH", kind, flags, len(body) if length is None else length) + body


def number(value: int, e: str) -> bytes:
    """A SequenceNumber_t: the high half is signed."""
    return struct.pack(e + "iI", value >> 32, value & 0xFFFFFFFF)


def number_set(base: int, bits: int, words: "tuple[int, ...]", e: str = "<") -> bytes:
    """A SequenceNumberSet."""
    return number(base, e) + struct.pack(e + "I" + "I" * len(words), bits, *words)


def data(
    writer: bytes,
    sequence: int,
    payload: bytes,
    reader: bytes = ANYONE,
    e: str = "<",
    qos: bytes = b"",
    flags: int = 4,
    skipped: bytes = b"",
    to_qos: int = 16,
    length: "int | None" = None,
) -> bytes:
    """DATA. `skipped` lies between the fixed part and inline QoS."""
    body = struct.pack(e + "HH", 0, to_qos + len(skipped)) + reader + writer + number(sequence, e)
    return submessage(0x15, flags | (2 if qos else 0), body + skipped + qos + payload, e, length)


def data_frag(
    writer: bytes, sequence: int, first: int, count: int, size: int, total: int, payload: bytes, e: str = "<"
) -> bytes:
    """DATA_FRAG."""
    body = struct.pack(e + "HH", 0, 28) + ANYONE + writer + number(sequence, e)
    return submessage(0x16, 0, body + struct.pack(e + "IHHI", first, count, size, total) + payload, e)


def heartbeat(
    writer: bytes, first: int, last: int, count: int, reader: bytes = ANYONE, e: str = "<", flags: int = 0
) -> bytes:
    """HEARTBEAT."""
    body = reader + writer + number(first, e) + number(last, e) + struct.pack(e + "I", count)
    return submessage(7, flags, body, e)


def gap(writer: bytes, start: int, numbers: bytes, e: str = "<") -> bytes:
    """GAP; `numbers` as `number_set` makes them."""
    return submessage(8, 0, ANYONE + writer + number(start, e) + numbers, e)


def acknack(reader: bytes, writer: bytes, numbers: bytes, count: int, e: str = "<") -> bytes:
    """ACKNACK; `numbers` as `number_set` makes them."""
    return submessage(6, 2, reader + writer + numbers + struct.pack(e + "I", count), e)


def nack_frag(
    reader: bytes, writer: bytes, sequence: int, base: int, bits: int, words: "tuple[int, ...]", count: int
) -> bytes:
    """NACK_FRAG, little endian."""
    body = reader + writer + number(sequence, "<") + struct.pack("<II" + "I" * len(words), base, bits, *words)
    return submessage(0x12, 0, body + struct.pack("<I", count))


def info_dst(prefix: bytes) -> bytes:
    """INFO_DST."""
    return submessage(0x0E, 0, prefix)


def info_src(prefix: bytes) -> bytes:
    """INFO_SRC."""
    return submessage(0x0C, 0, bytes(4) + b"\x02\x03\x01\x0f" + prefix)


def info_ts(seconds: int, e: str = "<") -> bytes:
    """INFO_TS of whole seconds."""
    return submessage(9, 0, struct.pack(e + "II", seconds, 0), e)


INFO_TS_INVALID = b"\x09\x03\0\0"


def parameter(pid: int, value: bytes, e: str = "<") -> bytes:
    """One parameter, padded."""
    value += bytes(-len(value) % 4)
    return struct.pack(e + "HH", pid, len(value)) + value


def parameters(*found: bytes, e: str = "<") -> bytes:
    """A bare list: inline QoS."""
    return b"".join(found) + struct.pack(e + "HH", 1, 0)


def payload(*found: bytes, e: str = "<") -> bytes:
    """A list behind its encapsulation header: discovery data."""
    return (b"\0\3\0\0" if e == "<" else b"\0\2\0\0") + parameters(*found, e=e)


def text(value: str, e: str = "<") -> bytes:
    """A CDR string."""
    return struct.pack(e + "I", len(value) + 1) + value.encode() + b"\0"


def locator(host: str, port: int, e: str = "<") -> bytes:
    """Locator_t of UDPv4."""
    return struct.pack(e + "II", 1, port) + bytes(12) + bytes([int(part) for part in host.split(".")])


def participant(prefix: bytes = PREFIX, host: str = HOST, e: str = "<", *more: bytes) -> bytes:
    """What SPDP says of a participant that has every builtin endpoint, with a lease of 20 s."""
    return payload(
        parameter(0x15, b"\2\3", e),
        parameter(0x16, b"\1\x0f", e),
        parameter(0x50, prefix + PARTICIPANT, e),
        parameter(0x32, locator(host, 7410, e), e),
        parameter(0x31, locator(host, 7411, e), e),
        parameter(0x02, struct.pack(e + "iI", 20, 0), e),
        parameter(0x58, struct.pack(e + "I", 0x0C3F), e),
        *more,
        e=e,
    )


def spdp(prefix: bytes = PREFIX, host: str = HOST, e: str = "<", sequence: int = 1, *more: bytes) -> bytes:
    """The datagram of an announcement."""
    said = participant(prefix, host, e, *more)
    return message(data(SPDP_WRITER, sequence, said, e=e), prefix=prefix)


def departure(prefix: bytes = PREFIX) -> bytes:
    """The datagram that says that a participant is gone."""
    status = parameters(parameter(0x70, prefix + PARTICIPANT), parameter(0x71, b"\0\0\0\3"))
    key = payload(parameter(0x50, prefix + PARTICIPANT))
    return message(data(SPDP_WRITER, 99, key, qos=status, flags=8), prefix=prefix)


def endpoint(guid: bytes, topic: str = "t", type_name: str = "T", e: str = "<", *more: bytes) -> bytes:
    """What SEDP says of a reliable endpoint."""
    return payload(
        parameter(0x5A, guid, e),
        parameter(0x05, text(topic, e), e),
        parameter(0x07, text(type_name, e), e),
        parameter(0x1A, struct.pack(e + "IiI", 2, 0, 0x19999999), e),
        *more,
        e=e,
    )
