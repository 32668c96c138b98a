"""What real peers sent, recorded by tools/record_rtps.py, parses completely and says what it should."""

from __future__ import annotations

from collections import Counter
from typing import Any

import pytest

import pcap
import peers
from roslet.errors import ProtocolError
from roslet.wire.rtps import (
    endpoint_data,
    guid,
    inline_qos,
    message,
    participant_data,
    participant_message,
    qos,
)
from roslet.wire.rtps.data import FLAG_D, Data
from roslet.wire.rtps.data_frag import DataFrag
from roslet.wire.rtps.endpoint_data import EndpointData
from roslet.wire.rtps.header import Header
from roslet.wire.rtps.participant_data import ParticipantData

FOLDER = peers.ROOT / "tests/captures/rtps"
FILES = sorted(path.name for path in FOLDER.glob("*.pcap"))


def messages(name: str) -> list[tuple[Header, list[Any]]]:
    return [message.parse(payload) for _, _, payload in pcap.read(FOLDER / name)]


def samples(name: str, writer_id: bytes) -> list[tuple[Header, Data]]:
    found = []
    for head, submessages in messages(name):
        found += [(head, one) for one in submessages if isinstance(one, Data) and one.writer_id == writer_id]
    return found


def participants(name: str) -> dict[bytes, ParticipantData]:
    found = {}
    for head, one in samples(name, guid.ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER):
        if one.flags & FLAG_D:
            found[head.guid_prefix] = participant_data.parse(one.payload)
    return found


def endpoints(name: str) -> list[tuple[bytes, EndpointData]]:
    found = {}
    for writer in (
        guid.ENTITYID_SEDP_BUILTIN_PUBLICATIONS_WRITER,
        guid.ENTITYID_SEDP_BUILTIN_SUBSCRIPTIONS_WRITER,
    ):
        for head, one in samples(name, writer):
            if one.flags & FLAG_D:
                value = endpoint_data.parse(one.payload)
                found[value.guid] = (head.vendor_id, value)
    return list(found.values())


@pytest.mark.parametrize("name", FILES)
def test_every_datagram_parses(name: str) -> None:
    found = messages(name)
    assert len(found) >= 25
    kinds = Counter(type(one).__name__ for _, submessages in found for one in submessages)
    assert {"Data", "Heartbeat", "AckNack", "InfoTimestamp", "InfoDestination"} <= set(kinds)


@pytest.mark.parametrize("name", FILES)
def test_every_datagram_cut_at_every_byte_gives_a_prefix_or_a_named_fault(name: str) -> None:
    for _, _, payload in pcap.read(FOLDER / name)[:60]:
        whole = [repr(type(one)) for one in message.parse(payload)[1]]
        for size in range(0, len(payload), 1 + len(payload) // 500):
            try:
                _, found = message.parse(payload[:size])
            except ProtocolError:
                continue
            assert [repr(type(one)) for one in found] == whole[: len(found)]


def test_participants_of_fast_dds() -> None:
    found = participants("fastdds_topic.pcap")
    assert len(found) == 2
    for prefix, value in found.items():
        assert value.guid == prefix + guid.ENTITYID_PARTICIPANT
        assert value.vendor_id == guid.VENDORID_EPROSIMA
        assert value.lease == 20 * 10**9
        assert value.domain_id == 0
        assert value.user_data == b"enclave=/;\0"  # counted with the NUL of a C string
        assert (
            value.builtin_endpoints & participant_data.BUILTIN_ENDPOINTS == participant_data.BUILTIN_ENDPOINTS
        )
        assert any(one.usable for one in value.metatraffic_unicast)
        assert any(one.usable for one in value.default_unicast)


def test_participants_of_cyclone() -> None:
    found = participants("cyclone_topic.pcap")
    assert len(found) == 2
    for prefix, value in found.items():
        assert value.guid == prefix + guid.ENTITYID_PARTICIPANT
        assert value.vendor_id == guid.VENDORID_CYCLONE
        assert (
            value.builtin_endpoints & participant_data.BUILTIN_ENDPOINTS == participant_data.BUILTIN_ENDPOINTS
        )
        assert any(one.usable for one in value.default_unicast)


@pytest.mark.parametrize(
    ("name", "vendor"),
    [("fastdds_topic.pcap", guid.VENDORID_EPROSIMA), ("cyclone_topic.pcap", guid.VENDORID_CYCLONE)],
)
def test_endpoints_of_the_topic(name: str, vendor: bytes) -> None:
    chatter = [value for whose, value in endpoints(name) if value.topic == "rt/chatter" and whose == vendor]
    assert sorted(value.writer for value in chatter) == [False, True]
    for value in chatter:
        assert value.type_name == "std_msgs::msg::dds_::String_"
        assert value.qos.reliable
        assert value.qos.durability == qos.VOLATILE
        assert not value.expects_inline_qos


def test_fast_dds_says_the_type_hash_in_user_data() -> None:
    chatter = [value for _, value in endpoints("fastdds_topic.pcap") if value.topic == "rt/chatter"]
    for value in chatter:
        assert value.qos.user_data.startswith(
            b"typehash=RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e94"
        )


def test_transient_local_is_said_by_both() -> None:
    found = endpoints("fastdds_cyclone_topic.pcap")
    chatter = {whose: value for whose, value in found if value.topic == "rt/chatter"}
    assert set(chatter) == {guid.VENDORID_EPROSIMA, guid.VENDORID_CYCLONE}
    assert all(value.qos.durability == qos.TRANSIENT_LOCAL for value in chatter.values())


def test_departures_carry_the_status_and_the_key() -> None:
    for name in FILES:
        gone = []
        for head, one in samples(name, guid.ENTITYID_SPDP_BUILTIN_PARTICIPANT_WRITER):
            if not one.flags & FLAG_D:
                status = inline_qos.parse(one.inline_qos, one.little)
                assert status.status & inline_qos.STATUS_DISPOSED
                key = status.key_hash or participant_data.parse(one.payload).guid
                assert key == head.guid_prefix + guid.ENTITYID_PARTICIPANT
                gone.append(key)
        assert set(gone) == {prefix + guid.ENTITYID_PARTICIPANT for prefix in participants(name)}


def put_together(name: str) -> list[bytes]:
    """The samples that came in fragments, without encapsulation header and string length."""
    parts: dict[int, bytearray] = {}
    for _, submessages in messages(name):
        for one in submessages:
            if isinstance(one, DataFrag):
                sample = parts.setdefault(one.sequence, bytearray(one.sample_size))
                start = (one.first - 1) * one.fragment_size
                sample[start : start + len(one.payload)] = one.payload
    return [bytes(sample[8:]) for sample in parts.values()]


def test_fast_dds_fragments_give_the_sample_back() -> None:
    (sample,) = put_together("fastdds_large.pcap")
    assert sample.rstrip(b"\0") == b"hello 0" + b"x" * 66000


def test_cyclone_fragments_give_the_sample_back() -> None:
    assert put_together("cyclone_topic.pcap") == [
        b"hello 0" + b"x" * 16000 + b"\0",
        b"hello 1" + b"x" * 16000 + b"\0",
    ]


def test_a_reply_names_the_request_that_it_answers() -> None:
    name = "fastdds_service.pcap"
    writers = {value.topic: value.guid for _, value in endpoints(name) if value.writer}
    readers = {value.topic: value.guid for _, value in endpoints(name) if not value.writer}
    requests, replies = [
        [one for head, one in samples(name, writers[topic][12:]) if head.guid_prefix == writers[topic][:12]]
        for topic in ("rq/askRequest", "rr/askReply")
    ]
    assert len(requests) == len(replies) == 2
    for request, reply in zip(requests, replies, strict=True):
        asked = inline_qos.parse(request.inline_qos, request.little)
        answered = inline_qos.parse(reply.inline_qos, reply.little)
        assert answered.related == (readers["rr/askReply"], request.sequence)
        assert asked.related is not None
        assert asked.related[0] == readers["rr/askReply"]


def test_cyclone_puts_who_asks_and_the_number_before_request_and_reply() -> None:
    name = "cyclone_service.pcap"
    writers = {value.topic: value.guid for _, value in endpoints(name) if value.writer}
    requests, replies = [
        [one.payload for head, one in samples(name, writers[topic][12:]) if one.flags & FLAG_D]
        for topic in ("rq/askRequest", "rr/askReply")
    ]
    numbers = [(0x1122334455667788).to_bytes(8, "little") + number.to_bytes(8, "little") for number in (1, 2)]
    assert [bytes(one[4:20]) for one in requests] == numbers
    assert [bytes(one[4:20]) for one in replies] == numbers
    assert [one[20] for one in requests] == [one[20] for one in replies] == [1, 0]


def test_jazzy_says_the_same_as_kilted_of_its_topic() -> None:
    found = []
    for name in ("fastdds_topic.pcap", "jazzy_topic.pcap"):
        chatter = [value for _, value in endpoints(name) if value.topic == "rt/chatter"]
        # Kilted no longer says DURABILITY_SERVICE of readers, which have none.
        said = [(one.writer, one.type_name, one.qos.replace(durability_service=None)) for one in chatter]
        found.append(sorted(said, key=lambda one: one[0]))
    assert len(found[0]) == 2
    assert found[0] == found[1]


def test_liveliness_messages_of_cyclone() -> None:
    found = samples("cyclone_topic.pcap", guid.ENTITYID_P2P_BUILTIN_PARTICIPANT_MESSAGE_WRITER)
    assert found
    for head, one in found:
        value = participant_message.parse(one.payload)
        assert value.guid_prefix == head.guid_prefix
        assert value.kind == participant_message.KIND_AUTOMATIC_LIVELINESS_UPDATE
