"""Parameter lists and what they carry, against bytes by hand, in both byte orders."""

import pytest

from roslet.errors import ProtocolError
from roslet.wire.rtps import (
    endpoint_data,
    guid,
    inline_qos,
    locator,
    parameter_list,
    participant_data,
    participant_message,
    qos,
    times,
)
from roslet.wire.rtps.endpoint_data import EndpointData
from roslet.wire.rtps.inline_qos import InlineQos
from roslet.wire.rtps.participant_message import ParticipantMessage
from roslet.wire.rtps.qos import Qos

pytestmark = pytest.mark.micropython


def octets(text: str) -> bytes:
    digits = "".join(text.split())
    return bytes([int(digits[at : at + 2], 16) for at in range(0, len(digits), 2)])


PREFIX = octets("0152 0a0b 0c0d 0e0f 1011 1213")
PARTICIPANT = participant_data.own(
    PREFIX,
    domain_id=7,
    metatraffic_unicast=(locator.udp4("127.0.0.1", 7410),),
    lease=20 * 1000000000,
    user_data=b"enclave=/;",
)
PARTICIPANT_LITTLE = """
00030000
1500 0400 02030000
1600 0400 01520000
5000 1000 01520a0b0c0d0e0f10111213 000001c1
0f00 0400 07000000
3200 1800 01000000 f21c0000 000000000000000000000000 7f000001
0200 0800 14000000 00000000
5800 0400 3f0c0000
2c00 1000 0a000000 656e636c6176653d2f3b 0000
0100 0000"""
PARTICIPANT_BIG = """
00020000
0015 0004 02030000
0016 0004 01520000
0050 0010 01520a0b0c0d0e0f10111213 000001c1
000f 0004 00000007
0032 0018 00000001 00001cf2 000000000000000000000000 7f000001
0002 0008 00000014 00000000
0058 0004 00000c3f
002c 0010 0000000a 656e636c6176653d2f3b 0000
0001 0000"""
WRITER = EndpointData(
    PREFIX + octets("00000103"),
    "rt/chatter",
    "std_msgs::msg::dds_::String_",
    Qos(
        reliability=(qos.RELIABLE, 100000000),
        durability=qos.TRANSIENT_LOCAL,
        history=(qos.KEEP_LAST, 10),
        deadline=1500000000,
        partition=("a", "bcd"),
        representation=(0, 2),
    ),
)
WRITER_LITTLE = """
00030000
5a00 1000 01520a0b0c0d0e0f10111213 00000103
0500 1000 0b000000 72742f6368617474657200 00
0700 2400 1d000000 7374645f6d7367733a3a6d73673a3a6464735f3a3a537472696e675f00 000000
1a00 0c00 02000000 00000000 9a999919
1d00 0400 01000000
4000 0800 00000000 0a000000
2300 0800 01000000 00000080
2900 1400 02000000 02000000 6100 0000 04000000 62636400
7300 0800 02000000 0000 0200
0100 0000"""


def test_a_participant_is_its_bytes() -> None:
    assert PARTICIPANT.emit() == octets(PARTICIPANT_LITTLE)
    assert PARTICIPANT.emit(False) == octets(PARTICIPANT_BIG)
    assert participant_data.parse(octets(PARTICIPANT_LITTLE)) == PARTICIPANT
    assert participant_data.parse(memoryview(octets(PARTICIPANT_BIG))) == PARTICIPANT


def test_a_writer_is_its_bytes() -> None:
    assert WRITER.emit() == octets(WRITER_LITTLE)
    assert endpoint_data.parse(octets(WRITER_LITTLE)) == WRITER
    assert endpoint_data.parse(WRITER.emit(False)) == WRITER
    assert WRITER.writer


def test_absent_qos_means_the_default_of_the_kind() -> None:
    front = "00030000 5a00 1000 01520a0b0c0d0e0f10111213 000001%s 0500 0800 02000000 61000000"
    front += "0700 0800 02000000 62000000 0100 0000"
    writer = endpoint_data.parse(octets(front % "03"))
    assert writer.qos == qos.WRITER_DEFAULTS
    assert writer.qos.reliable
    reader = endpoint_data.parse(octets(front % "04"))
    assert reader.qos == qos.READER_DEFAULTS
    assert not reader.qos.reliable
    assert reader.qos.liveliness == (qos.AUTOMATIC, times.INFINITE)


@pytest.mark.parametrize(
    ("payload", "reason"),
    [
        ("", "payload-truncated"),
        ("00010000 0100 0000", "payload-not-a-parameter-list"),
        ("00030000", "parameter-list-unterminated"),
        ("00030000 0100 0000", "participant-without-guid"),
        ("00030000 5000 0800 0102030405060708 0100 0000", "parameter-truncated"),
        ("00030000 5000 1000 01020304", "parameter-truncated"),
        ("00030000 3e40 0400 00000000 0100 0000", "parameter-not-understood"),
        ("00030000 2c00 0400 ff000000 0100 0000", "parameter-truncated"),
        ("00030000 5900 0400 ffffffff 0100 0000", "parameter-too-many-elements"),
        ("00030000 5900 0400 02000000 0100 0000", "parameter-truncated"),
    ],
)
def test_a_wrong_participant_is_refused_by_name(payload: str, reason: str) -> None:
    with pytest.raises(ProtocolError) as raised:
        participant_data.parse(octets(payload))
    assert raised.value.reason == reason


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("0500 0800 02000000 61000000", "endpoint-without-guid"),
        ("5a00 1000 01520a0b0c0d0e0f10111213 000001c1", "endpoint-kind-unknown"),
        ("5a00 1000 01520a0b0c0d0e0f10111213 00000103", "endpoint-without-topic"),
        ("5a00 1000 01520a0b0c0d0e0f10111213 00000103 0500 0800 02000000 61000000", "endpoint-without-type"),
    ],
)
def test_a_wrong_endpoint_is_refused_by_name(body: str, reason: str) -> None:
    with pytest.raises(ProtocolError) as raised:
        endpoint_data.parse(octets("00030000" + body + "0100 0000"))
    assert raised.value.reason == reason


def test_unknown_and_vendor_parameters_are_skipped() -> None:
    extra = "3d00 0400 00000000  0780 0400 01000000  07c0 0400 01000000  0000 0400 ffffffff  1a00 0000"
    text = PARTICIPANT_LITTLE.replace("0100 0000", "", 0)
    payload = octets("00030000" + extra) + octets(text)[4:]
    assert participant_data.parse(payload) == PARTICIPANT


def test_a_list_of_too_many_parameters_is_cut_off() -> None:
    payload = octets("00030000") + octets("3d00 0000") * parameter_list.MAX_PARAMETERS + octets("0100 0000")
    with pytest.raises(ProtocolError) as raised:
        participant_data.parse(payload)
    assert raised.value.reason == "too-many-parameters"


def test_locators_beyond_the_bound_are_left_out() -> None:
    one = octets("3200 1800 01000000 f21c0000 000000000000000000000000 7f000001")
    payload = octets(PARTICIPANT_LITTLE)[:-4] + one * 100 + octets("0100 0000")
    assert len(participant_data.parse(payload).metatraffic_unicast) == locator.MAX_LOCATORS


def test_a_key_names_its_endpoint() -> None:
    assert (
        endpoint_data.parse_key(octets("00030000 5a00 1000") + WRITER.guid + octets("0100 0000"))
        == WRITER.guid
    )
    with pytest.raises(ProtocolError):
        endpoint_data.parse_key(octets("00030000 0100 0000"))


def test_inline_qos_is_its_bytes() -> None:
    value = InlineQos(
        key_hash=bytes(range(16)), status=inline_qos.STATUS_DISPOSED, related=(bytes(range(16)), 0x100000002)
    )
    little = "7000 1000 000102030405060708090a0b0c0d0e0f 7100 0400 00000001"
    little += "8300 1800 000102030405060708090a0b0c0d0e0f 01000000 02000000 0100 0000"
    assert value.emit() == octets(little)
    assert inline_qos.parse(octets(little), True) == value
    assert inline_qos.parse(value.emit(False), False) == value
    assert inline_qos.parse(b"", True) is inline_qos.NONE


def test_a_liveliness_message_is_its_bytes() -> None:
    value = ParticipantMessage(PREFIX, participant_message.KIND_AUTOMATIC_LIVELINESS_UPDATE, b"\0")
    little = octets("00010000 01520a0b0c0d0e0f10111213 00000001 01000000 00")
    assert value.emit() == little
    assert participant_message.parse(little) == value
    assert participant_message.parse(value.emit(False)) == value
    for wrong in (
        little[:20],
        little[:-1],
        octets("00030000") + little[4:],
        little[:20] + octets("ffffffff"),
    ):
        with pytest.raises(ProtocolError):
            participant_message.parse(wrong)


def test_durations_survive_the_wire() -> None:
    for value in (0, 1, 999999999, 1000000000, 1500000000, 123456789012345678, times.INFINITE):
        for little in (True, False):
            assert times.parse_duration(times.emit_duration(value, little), 0, 1 if little else 0) == value
    assert times.emit_duration(times.INFINITE) == octets("ffffff7f ffffffff")


def test_names_are_those_of_the_specification() -> None:
    assert parameter_list.NAMES[0x0050] == "PID_PARTICIPANT_GUID"
    assert parameter_list.NAMES[0x3D] == "pid(61)"
    assert guid.entity_name(octets("000003c2")) == "ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER"
    assert guid.guid_text(WRITER.guid) == "01520a0b0c0d0e0f10111213:00000103"
    assert guid.vendor_name(b"\x01\x10") == "Eclipse Cyclone DDS"
    assert guid.vendor_name(b"\x09\x09") == "9.9"
    assert guid.is_builtin(octets("000003c2")) and guid.is_keyed(octets("000003c2"))
