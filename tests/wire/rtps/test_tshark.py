"""tshark, which knows RTPS by itself, finds nothing wrong in what we emit."""

from __future__ import annotations

import pathlib
import subprocess

import pcap
import peers
from roslet.wire.rtps import data, header, inline_qos, locator, participant_data, participant_message, qos
from roslet.wire.rtps.ack_nack import AckNack
from roslet.wire.rtps.data import Data
from roslet.wire.rtps.data_frag import DataFrag
from roslet.wire.rtps.endpoint_data import EndpointData
from roslet.wire.rtps.gap import Gap
from roslet.wire.rtps.guid import (
    ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_READER,
    ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_WRITER,
    ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER,
    ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER,
    ENTITYID_SPDP_BUILTIN_PARTICIPANT_READER,
    ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER,
)
from roslet.wire.rtps.heartbeat import Heartbeat
from roslet.wire.rtps.heartbeat_frag import HeartbeatFrag
from roslet.wire.rtps.info_dst import InfoDestination
from roslet.wire.rtps.info_reply import InfoReply
from roslet.wire.rtps.info_src import InfoSource
from roslet.wire.rtps.info_ts import InfoTimestamp
from roslet.wire.rtps.nack_frag import NackFrag
from roslet.wire.rtps.number_set import NumberSet, of
from roslet.wire.rtps.pad import Pad

PREFIX = bytes((1, 0x52)) + bytes(range(10))
READER, WRITER = b"\0\0\1\4", b"\0\0\2\3"


def everything(little: bool) -> list[bytes]:
    """Messages that hold every submessage and every parameter that we emit."""
    here = (locator.udp4("127.0.0.1", 7410), locator.udp4("10.0.0.1", 7410))
    participant = participant_data.own(
        PREFIX,
        domain_id=0,
        metatraffic_unicast=here,
        metatraffic_multicast=(locator.udp4("239.255.0.1", 7400),),
        default_unicast=here,
        default_multicast=(locator.udp4("239.255.0.1", 7401),),
        lease=20 * 10**9,
        manual_liveliness_count=1,
        user_data=b"enclave=/;",
        entity_name="roslet",
        properties=(("name", "value"), ("a", "b")),
    )
    policies = qos.Qos(
        (qos.RELIABLE, 10**8),
        qos.TRANSIENT_LOCAL,
        (qos.KEEP_ALL, 5),
        10**9,
        5,
        (qos.MANUAL_BY_TOPIC, 2 * 10**9),
        10**10,
        qos.EXCLUSIVE,
        3,
        qos.BY_SOURCE_TIMESTAMP,
        (qos.TOPIC, True, False),
        ("one", "two"),
        (qos.XCDR1, qos.XCDR2),
        (10, 20, 30),
        4,
        5,
        (0, 1, 2, 3, 4, 5),
        b"user",
        b"topic",
        b"group",
    )
    writer = EndpointData(PREFIX + WRITER, "rt/chatter", "std_msgs::msg::dds_::String_", policies, here)
    alive = participant_message.ParticipantMessage(PREFIX, b"\0\0\0\1", b"\0")
    gone = inline_qos.InlineQos(PREFIX + b"\0\0\1\xc1", 3, (bytes(16), 7), (bytes(16), 7)).emit(little)
    text = b"\0\1\0\0\6\0\0\0hello\0"
    stamp = bytes(InfoTimestamp(1700000000 * 10**9).emit(little))
    bodies: list[list[bytes | bytearray]] = [
        [
            stamp,
            Data(
                ENTITYID_SPDP_BUILTIN_PARTICIPANT_READER,
                ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER,
                1,
                participant.emit(little),
                little=little,
            ).emit(),
        ],
        [
            InfoDestination(PREFIX).emit(little),
            stamp,
            Data(
                ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER,
                ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER,
                1,
                writer.emit(little),
                little=little,
            ).emit(),
            Heartbeat(
                ENTITYID_SEDP_BUILTIN_PUBLICATIONS_READER, ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER, 1, 1, 1
            ).emit(little),
        ],
        [
            Data(
                ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_READER,
                ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_WRITER,
                1,
                alive.emit(little),
                little=little,
            ).emit()
        ],
        [stamp, Data(READER, WRITER, 1, text, little=little).emit(), Pad().emit(little)],
        [Data(READER, WRITER, 2, b"", gone, 0, little).emit()],
        [stamp, DataFrag(READER, WRITER, 3, 1, 1, 8, 14, text[:8], little=little).emit()],
        [stamp, DataFrag(READER, WRITER, 3, 2, 1, 8, 14, text[8:], little=little).emit()],
        [
            HeartbeatFrag(READER, WRITER, 3, 2, 1).emit(little),
            Heartbeat(READER, WRITER, 1, 3, 1, True, True).emit(little),
            Gap(READER, WRITER, 1, of(3, [4, 40])).emit(little),
        ],
        [
            InfoDestination(PREFIX).emit(little),
            AckNack(READER, WRITER, of(3, range(3, 259)), 1).emit(little),
            AckNack(READER, WRITER, NumberSet(1), 2, True).emit(little),
            NackFrag(READER, WRITER, 3, of(1, [1, 2, 35]), 1).emit(little),
        ],
        [InfoSource(b"\2\3", b"\1\x52", PREFIX).emit(little), InfoTimestamp(None).emit(little)],
        [InfoReply(here, here[:1]).emit(little), InfoReply(here, here).emit_ip4(little)],
    ]
    return [header.own(PREFIX) + b"".join(body) for body in bodies]


def tshark(file: pathlib.Path, *arguments: str) -> str:
    program = peers.require("tshark")
    done = subprocess.run(
        [str(program), "-r", str(file), *arguments], capture_output=True, text=True, timeout=60, check=True
    )
    return done.stdout


def test_tshark_finds_nothing_malformed(tmp_path: pathlib.Path) -> None:
    messages = everything(True) + everything(False)
    messages.append(
        data.Preface(header.own(PREFIX), WRITER).emit(9, 12, 1700000000, 0) + b"\0\1\0\0\4\0\0\0abc\0"
    )
    file = tmp_path / "emitted.pcap"
    pcap.write(file, messages)
    verdict = tshark(
        file, "-T", "fields", "-e", "frame.protocols", "-e", "_ws.malformed", "-e", "_ws.expert.message"
    )
    lines = verdict.rstrip("\n").split("\n")
    assert len(lines) == len(messages)
    for line in lines:
        protocols, malformed, expert = line.split("\t")
        assert "rtps" in protocols
        assert malformed == ""
        assert expert == "", line


def test_tshark_names_every_submessage(tmp_path: pathlib.Path) -> None:
    file = tmp_path / "emitted.pcap"
    pcap.write(file, everything(True))
    ids = tshark(file, "-T", "fields", "-e", "rtps.sm.id").split()
    seen = {int(one, 16) for line in ids for one in line.split(",")}
    assert seen == {0x01, 0x06, 0x07, 0x08, 0x09, 0x0C, 0x0D, 0x0E, 0x0F, 0x12, 0x13, 0x15, 0x16}
    details = tshark(file, "-V")
    for expected in ("PID_DOMAIN_ID", "PID_PARTITION", "PID_DATA_REPRESENTATION", "rt/chatter"):
        assert expected in details
