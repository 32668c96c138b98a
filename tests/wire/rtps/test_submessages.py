"""Every submessage against bytes written by hand from the specification, in both byte orders, cut at every byte."""

import pytest

from roslet.errors import ProtocolError
from roslet.wire.rtps import (
    data,
    data_frag,
    gap,
    header,
    heartbeat,
    info_dst,
    info_reply,
    info_src,
    info_ts,
    locator,
    message,
    number_set,
    pad,
    submessage,
)
from roslet.wire.rtps.ack_nack import AckNack
from roslet.wire.rtps.data import Data
from roslet.wire.rtps.data_frag import DataFrag
from roslet.wire.rtps.gap import Gap
from roslet.wire.rtps.heartbeat import Heartbeat
from roslet.wire.rtps.heartbeat_frag import HeartbeatFrag
from roslet.wire.rtps.info_dst import InfoDestination
from roslet.wire.rtps.info_reply import InfoReply
from roslet.wire.rtps.info_src import InfoSource
from roslet.wire.rtps.info_ts import InfoTimestamp
from roslet.wire.rtps.locator import Locator
from roslet.wire.rtps.nack_frag import NackFrag
from roslet.wire.rtps.number_set import NumberSet
from roslet.wire.rtps.pad import Pad

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


def octets(text: str) -> bytes:
    digits = "".join(text.split())
    return bytes([int(digits[at : at + 2], 16) for at in range(0, len(digits), 2)])


PREFIX = octets("010f 0a0b 0c0d 0e0f 1011 1213")
RTPS = octets("52545053 0203 0152") + PREFIX
READER = octets("000001 04")
WRITER = octets("000002 03")

# name, value, little endian, big endian
CASES: "list[Any]" = [
    (
        "data",
        Data(READER, WRITER, 0x100000002, octets("00010000 03000000 68690000")),
        "15 05 2000  0000 1000  00000104 00000203  01000000 02000000  00010000 03000000 68690000",
        "15 04 0020  0000 0010  00000104 00000203  00000001 00000002  00010000 03000000 68690000",
    ),
    (
        "data without payload",
        Data(READER, WRITER, 1, flags=0),
        "15 01 1400  0000 1000  00000104 00000203  00000000 01000000",
        "15 00 0014  0000 0010  00000104 00000203  00000000 00000001",
    ),
    (
        "data frag",
        DataFrag(READER, WRITER, 7, 3, 1, 4, 10, b"\x01\x02"),
        "16 01 2200  0000 1c00  00000104 00000203  00000000 07000000  03000000 0100 0400 0a000000  0102",
        "16 00 0022  0000 001c  00000104 00000203  00000000 00000007  00000003 0001 0004 0000000a  0102",
    ),
    (
        "heartbeat",
        Heartbeat(READER, WRITER, 3, 0x200000005, 9, True, False),
        "07 03 1c00  00000104 00000203  00000000 03000000  02000000 05000000  09000000",
        "07 02 001c  00000104 00000203  00000000 00000003  00000002 00000005  00000009",
    ),
    (
        "heartbeat of an empty writer, liveliness",
        Heartbeat(READER, WRITER, 1, 0, 1, False, True),
        "07 05 1c00  00000104 00000203  00000000 01000000  00000000 00000000  01000000",
        "07 04 001c  00000104 00000203  00000000 00000001  00000000 00000000  00000001",
    ),
    (
        "heartbeat frag",
        HeartbeatFrag(READER, WRITER, 7, 3, 2),
        "13 01 1800  00000104 00000203  00000000 07000000  03000000 02000000",
        "13 00 0018  00000104 00000203  00000000 00000007  00000003 00000002",
    ),
    (
        "acknack of 5 and 37",
        AckNack(READER, WRITER, NumberSet(5, 33, (0x80000000, 0x80000000)), 4),
        "06 01 2000  00000104 00000203  00000000 05000000 21000000  00000080 00000080  04000000",
        "06 00 0020  00000104 00000203  00000000 00000005 00000021  80000000 80000000  00000004",
    ),
    (
        "acknack of nothing",
        AckNack(READER, WRITER, NumberSet(6), 5, True),
        "06 03 1800  00000104 00000203  00000000 06000000 00000000  05000000",
        "06 02 0018  00000104 00000203  00000000 00000006 00000000  00000005",
    ),
    (
        "nack frag",
        NackFrag(READER, WRITER, 7, NumberSet(2, 3, (0xA0000000,)), 1),
        "12 01 2000  00000104 00000203  00000000 07000000  02000000 03000000 000000a0  01000000",
        "12 00 0020  00000104 00000203  00000000 00000007  00000002 00000003 a0000000  00000001",
    ),
    (
        "gap",
        Gap(READER, WRITER, 3, NumberSet(8, 2, (0x40000000,))),
        "08 01 2000  00000104 00000203  00000000 03000000  00000000 08000000 02000000 00000040",
        "08 00 0020  00000104 00000203  00000000 00000003  00000000 00000008 00000002 40000000",
    ),
    (
        "info ts",
        InfoTimestamp(1700000000500000000),
        "09 01 0800  00f15365 00000080",
        "09 00 0008  6553f100 80000000",
    ),
    ("info ts invalidate", InfoTimestamp(None), "09 03 0000", "09 02 0000"),
    (
        "info src",
        InfoSource(b"\x02\x01", b"\x01\x10", PREFIX),
        "0c 01 1400  00000000 0201 0110 010f0a0b0c0d0e0f10111213",
        "0c 00 0014  00000000 0201 0110 010f0a0b0c0d0e0f10111213",
    ),
    (
        "info dst",
        InfoDestination(PREFIX),
        "0e 01 0c00  010f0a0b0c0d0e0f10111213",
        "0e 00 000c  010f0a0b0c0d0e0f10111213",
    ),
    (
        "info reply",
        InfoReply((locator.udp4("10.0.0.7", 7411),), (locator.udp4("239.255.0.1", 7400),)),
        "0f 03 3800  01000000 01000000 f31c0000 000000000000000000000000 0a000007"
        "            01000000 01000000 e81c0000 000000000000000000000000 efff0001",
        "0f 02 0038  00000001 00000001 00001cf3 000000000000000000000000 0a000007"
        "            00000001 00000001 00001ce8 000000000000000000000000 efff0001",
    ),
    ("pad", Pad(4), "01 01 0400 00000000", "01 00 0004 00000000"),
    ("pad of nothing", Pad(0), "01 01 0000", "01 00 0000"),
]


def parsed(body: bytes) -> "Any":
    head, found = message.parse(RTPS + body)
    assert head.guid_prefix == PREFIX
    assert len(found) == 1
    return found[0]


def plain(value: "Any") -> "Any":
    """Views as bytes, so that values compare on every interpreter; the byte order is not part of the value."""
    if isinstance(value, (Data, DataFrag)):
        return value.replace(payload=bytes(value.payload), inline_qos=bytes(value.inline_qos), little=True)
    return value


@pytest.mark.parametrize(("name", "value", "little", "big"), CASES)
def test_bytes_by_hand_are_parsed_and_emitted(name: str, value: "Any", little: str, big: str) -> None:
    assert plain(parsed(octets(little))) == value
    assert plain(parsed(octets(big))) == value
    if isinstance(value, (Data, DataFrag)):
        assert bytes(value.emit()) == octets(little)
        other: Any = value.replace(little=False)
        assert bytes(other.emit()) == octets(big)
    else:
        assert bytes(value.emit()) == octets(little)
        assert bytes(value.emit(False)) == octets(big)


@pytest.mark.parametrize(("name", "value", "little", "big"), CASES)
def test_a_message_cut_at_any_byte_names_the_fault(name: str, value: "Any", little: str, big: str) -> None:
    whole = RTPS + octets(little)
    for size in range(len(whole)):
        try:
            _, found = message.parse(whole[:size])
            assert size == 20 and found == [], size
        except ProtocolError as error:
            assert error.reason in ("message-truncated", "submessage-truncated", "submessage-too-long"), error
    # The same with the length made to fit, so that the submessage's own checks are met.
    body = octets(little)
    for size in range(4, len(body)):
        cut = body[:2] + bytes((size - 4, 0)) + body[4:size]
        try:
            message.parse(RTPS + cut)
        except ProtocolError as error:
            assert error.reason.endswith("-truncated"), error


def test_the_header_is_ours_by_hand() -> None:
    assert header.own(PREFIX) == RTPS
    found = header.parse(RTPS)
    assert (found.version, found.vendor_id) == (b"\x02\x03", b"\x01\x52")


@pytest.mark.parametrize(
    ("start", "reason"),
    [
        ("52545053 0203", "message-truncated"),
        ("52545058 0203 0101 000000000000000000000000", "not-rtps"),
        ("52545053 0100 0101 000000000000000000000000", "version-unsupported"),
    ],
)
def test_a_wrong_header_is_refused_by_name(start: str, reason: str) -> None:
    with pytest.raises(ProtocolError) as raised:
        header.parse(octets(start))
    assert raised.value.reason == reason


def test_a_later_minor_version_is_accepted() -> None:
    assert header.parse(octets("52545053 0205 0110 000000000000000000000000")).version == b"\x02\x05"


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("15 05 1400 0000 1000 00000104 00000203 00000000 00000000", "data-invalid"),
        ("15 05 1400 0000 1000 00000104 00000203 ffffffff ffffffff", "data-invalid"),
        ("15 0d 1400 0000 1000 00000104 00000203 00000000 01000000", "data-invalid"),
        ("15 05 1400 0000 0c00 00000104 00000203 00000000 01000000", "data-invalid"),
        ("15 05 1400 0000 1400 00000104 00000203 00000000 01000000", "data-truncated"),
        ("15 03 1400 0000 1000 00000104 00000203 00000000 01000000", "parameter-list-unterminated"),
        ("15 03 1800 0000 1000 00000104 00000203 00000000 01000000 7000 1000", "parameter-truncated"),
        ("07 01 1c00 00000104 00000203 00000000 00000000 00000000 00000000 01000000", "heartbeat-invalid"),
        ("07 01 1c00 00000104 00000203 00000000 05000000 00000000 03000000 01000000", "heartbeat-invalid"),
        ("06 01 1800 00000104 00000203 00000000 01000000 01010000 01000000", "number-set-too-large"),
        (
            "06 01 1c00 00000104 00000203 00000000 00000000 01000000 00000080 01000000",
            "number-set-base-invalid",
        ),
        ("06 01 1800 00000104 00000203 00000000 01000000 40000000 01000000", "number-set-truncated"),
        ("08 01 1c00 00000104 00000203 00000000 05000000 00000000 04000000 00000000", "gap-invalid"),
        ("13 01 1800 00000104 00000203 00000000 07000000 00000000 01000000", "heartbeat-frag-invalid"),
        (
            "16 01 2000 0000 1c00 00000104 00000203 00000000 01000000 01000000 0100 0000 0a000000",
            "data-frag-invalid",
        ),
        (
            "16 01 2000 0000 1c00 00000104 00000203 00000000 01000000 04000000 0100 0400 0a000000",
            "data-frag-invalid",
        ),
        (
            "16 01 2000 0000 1c00 00000104 00000203 00000000 01000000 00000000 0100 0400 0a000000",
            "data-frag-invalid",
        ),
        ("09 01 0000", "info-ts-truncated"),
        ("0f 01 0400 41000000", "too-many-locators"),
        ("0f 01 0400 01000000", "locator-list-truncated"),
        ("0d 01 0400 01000000", "info-reply-ip4-truncated"),
        ("0c 01 1400 00000000 0301 0110 010f0a0b0c0d0e0f10111213", "version-unsupported"),
    ],
)
def test_a_submessage_that_breaks_its_rules_is_refused_by_name(body: str, reason: str) -> None:
    with pytest.raises(ProtocolError) as raised:
        message.parse(RTPS + octets(body))
    assert raised.value.reason == reason


def test_zero_length_means_to_the_end_but_not_for_pad_and_info_ts() -> None:
    heartbeat_bytes = octets(CASES[3][2])
    for empty in ("01 01 0000", "09 03 0000"):
        _, found = message.parse(RTPS + octets(empty) + heartbeat_bytes)
        assert found[1] == CASES[3][1]
    long = octets("15 05 0000 0000 1000 00000104 00000203 00000000 01000000 00010000") + bytes(40)
    assert len(parsed(long).payload) == 44


def test_unknown_submessages_are_skipped_by_their_length() -> None:
    for kind in ("80", "02", "ff"):
        _, found = message.parse(RTPS + octets(kind + "01 0800 0102030405060708") + octets(CASES[3][2]))
        assert found == [CASES[3][1]]


def test_what_came_before_a_fault_stays_valid() -> None:
    view = memoryview(RTPS + octets(CASES[3][2]) + octets("07 01 0400 00000000"))
    found = []
    with pytest.raises(ProtocolError):
        for value in message.submessages(view):
            found.append(value)
    assert found == [CASES[3][1]]


def test_a_message_of_too_many_submessages_is_cut_off() -> None:
    few = RTPS + octets("01 01 0000") * submessage.MAX_SUBMESSAGES
    assert len(message.parse(few)[1]) == submessage.MAX_SUBMESSAGES
    with pytest.raises(ProtocolError) as raised:
        message.parse(few + octets("01 01 0000"))
    assert raised.value.reason == "too-many-submessages"


def test_octets_to_inline_qos_may_skip_a_future_field() -> None:
    body = octets(
        "15 07 2c00 0000 1800 00000104 00000203 00000000 01000000 aaaaaaaa bbbbbbbb"
        "7100 0400 00000003 0100 0000 00010000"
    )
    found = parsed(body)
    assert bytes(found.inline_qos) == octets("7100 0400 00000003 0100 0000")
    assert bytes(found.payload) == octets("00010000")


def test_payload_and_inline_qos_are_views_of_the_datagram() -> None:
    datagram = bytearray(RTPS + octets(CASES[0][2]))
    view = memoryview(datagram)
    found = next(message.submessages(view))
    datagram[-4] = 0x48
    assert bytes(found.payload[8:10]) == b"Hi"


def test_a_preface_is_what_the_submessages_emit() -> None:
    time = 1700000000250000000
    preface = data.Preface(RTPS, WRITER, READER, bytes(InfoDestination(PREFIX).emit()))
    payload = octets("00010000 03000000 68690000")
    front = preface.emit(0x300000001, len(payload), 1700000000, 0x40000000)
    assert len(front) == preface.size
    expected = RTPS + bytes(InfoDestination(PREFIX).emit()) + bytes(InfoTimestamp(time).emit())
    expected += Data(READER, WRITER, 0x300000001, payload).emit()
    assert front + payload == expected


def test_an_ip4_reply_has_its_address_as_a_number() -> None:
    value = InfoReply((locator.udp4("10.0.0.7", 7411),), (locator.udp4("239.255.0.1", 7400),))
    little = octets("0d 03 1000 0700000a f31c0000 0100ffef e81c0000")
    big = octets("0d 02 0010 0a000007 00001cf3 efff0001 00001ce8")
    assert value.emit_ip4() == little
    assert value.emit_ip4(False) == big
    assert parsed(little) == value
    assert parsed(big) == value


def test_a_number_set_holds_what_it_was_made_of() -> None:
    made = number_set.of(10, [10, 12, 41, 42, 265, 266, 9])
    assert made.numbers() == [10, 12, 41, 42, 265]
    assert made.bits == 256
    assert number_set.of(10, []) == NumberSet(10)
    assert number_set.of(3, [3]).words == (0x80000000,)


def test_sequence_numbers_reach_their_limit() -> None:
    highest = 0x7FFFFFFFFFFFFFFF
    value = Heartbeat(READER, WRITER, highest, highest, 1)
    assert parsed(bytes(value.emit())) == value
    answer = AckNack(READER, WRITER, NumberSet(highest), 1)
    assert parsed(bytes(answer.emit(False))) == answer


def test_ports_follow_the_specification() -> None:
    assert locator.metatraffic_multicast_port(0) == 7400
    assert locator.user_multicast_port(1) == 7651
    assert locator.metatraffic_unicast_port(0, 3) == 7416
    assert locator.user_unicast_port(2, 1) == 7913
    assert locator.user_unicast_port(locator.MAX_DOMAIN_ID, 62) < 65536


def test_a_locator_says_whether_it_can_be_used() -> None:
    assert locator.udp4("127.0.0.1", 7410).usable
    assert not locator.udp4("127.0.0.1", 0).usable
    assert not locator.udp4("0.0.0.0", 7410).usable
    assert not Locator(16, 7410, bytes(16)).usable
    assert locator.udp4("239.255.0.1", 7400).multicast
    assert str(locator.udp4("10.1.2.3", 7400)) == "10.1.2.3:7400"


def test_the_field_tables_have_no_gaps_and_the_sizes_of_the_specification() -> None:
    assert header.FIELDS[-1].offset + header.FIELDS[-1].bits // 8 == 20
    sizes = [(data.FIELDS, 20), (data_frag.FIELDS, 32), (heartbeat.FIELDS, 28), (gap.FIELDS, 16)]
    sizes += [(info_dst.FIELDS, 12), (info_src.FIELDS, 20), (info_ts.FIELDS, 8)]
    for fields, size in sizes:
        at = 0
        for field in fields:
            assert field.offset == at, field
            at += field.bits // 8
        assert at == size
    assert pad.FIELDS == ()
    assert info_reply.FLAG_M == 2
