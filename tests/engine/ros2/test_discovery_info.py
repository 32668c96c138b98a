"""ros_discovery_info against bytes of rclpy (Kilted's rmw_dds_common), and bytes written by hand after the definition."""

import pytest

from roslet.errors import ProtocolError
from roslet.wire import discovery_info
from roslet.wire.discovery_info import GID, OLD_GID, NodeEntities, ParticipantEntities, parse

pytestmark = pytest.mark.micropython

# rclpy.serialization.serialize_message of the value below; padding of undefined content set to zero, surplus cut off.
KILTED = bytes.fromhex(
    "0001000001010101010101010101010101010101020000000200000"
    "02f0000000700000074616c6b6572000001000000020202020202020202020202020202020200000003030303030303030303030303030303"
    "04040404040404040404040404040404030000002f6100000200000062000000"
    "0000000000000000"
)
VALUE = ParticipantEntities(
    b"\1" * 16,
    (
        NodeEntities("/", "talker", (b"\2" * 16,), (b"\3" * 16, b"\4" * 16)),
        NodeEntities("/a", "b"),
    ),
)

# By hand, big endian, as up to Humble: a participant without nodes, and one with a node that has one reader.
OLD_EMPTY = b"\0\0\0\0" + b"\1" * 16 + bytes(8) + bytes(4)
OLD_NODE = (
    b"\0\0\0\0" + b"\1" * 16 + bytes(8) + b"\0\0\0\1"
    b"\0\0\0\2/\0\0\0" + b"\0\0\0\2n\0\0\0" + b"\0\0\0\1" + b"\2" * 16 + bytes(8) + b"\0\0\0\0"
)


def test_bytes_of_rclpy_are_read_and_written() -> None:
    assert parse(KILTED) == (VALUE, GID)
    assert VALUE.emit() == KILTED


def test_bytes_of_old_peers_are_told_apart_and_written() -> None:
    assert parse(OLD_EMPTY) == (ParticipantEntities(b"\1" * 16), OLD_GID)
    node = ParticipantEntities(b"\1" * 16, (NodeEntities("/", "n", (b"\2" * 16,)),))
    assert parse(OLD_NODE) == (node, OLD_GID)
    assert node.emit(OLD_GID, False) == OLD_NODE


@pytest.mark.parametrize("nodes", [0, 1, 2, 30])
@pytest.mark.parametrize("endpoints", [0, 1, 25])
@pytest.mark.parametrize("size", [GID, OLD_GID])
@pytest.mark.parametrize("little", [True, False])
def test_what_is_written_is_read_without_knowing_the_size(
    nodes: int, endpoints: int, size: int, little: bool
) -> None:
    # GUIDs with zeros, as rmw_fastrtps has them, are the hard case.
    guids = tuple([b"\x01\x0f\x7f\x01\x83\x1c\0\0\0\0\0\0\0\0" + bytes((n, 4)) for n in range(endpoints)])
    told = tuple([NodeEntities("/", "n%d" % number, guids, guids[:3]) for number in range(nodes)])
    value = ParticipantEntities(b"\x01\x0f\x7f\x01\x83\x1c\0\0\0\0\0\0\0\0\1\xc1", told)
    payload = value.emit(size, little)
    assert parse(payload) == (value, size)
    assert parse(memoryview(payload + b"\0\0\0")[:-3], size) == (value, size)
    with pytest.raises(ProtocolError):
        parse(payload, GID if size == OLD_GID else OLD_GID)


def test_up_to_three_octets_of_padding_are_allowed() -> None:
    assert parse(KILTED + b"abc") == (VALUE, GID)
    with pytest.raises(ProtocolError, match="discovery-info-too-long"):
        parse(KILTED + b"abcd", GID)


def test_every_truncation_is_refused() -> None:
    for payload, size in ((KILTED, GID), (OLD_NODE, OLD_GID)):
        for end in range(len(payload)):
            with pytest.raises(ProtocolError, match="discovery-info-"):
                parse(payload[:end], size)


def _with_count(value: int) -> bytes:
    return b"\0\1\0\0" + b"\1" * 16 + value.to_bytes(4, "little") + b"\2\0\0\0/\0\0\0\2\0\0\0n\0\0\0"


@pytest.mark.parametrize(
    ("payload", "reason"),
    [
        (b"", "encapsulation"),
        (b"\0\3\0\0" + bytes(40), "encapsulation"),
        (bytes(discovery_info.MAX_INFO + 1), "too-large"),
        (_with_count(discovery_info.MAX_NODES + 1), "too-large"),
        (_with_count(discovery_info.MAX_NODES), "truncated"),
        (_with_count(1) + b"\xff\xff\xff\xff", "truncated"),
        (_with_count(1) + b"\0\0\0\0\0\0\0\1" + bytes(16), "truncated"),
        (_with_count(1).replace(b"/", b"x") + bytes(8), "name"),
        (_with_count(1).replace(b"n", b"-") + bytes(8), "name"),
        (_with_count(1).replace(b"n\0", b"\xff\xff") + bytes(8), "name"),
        (b"\0\1\0\0" + b"\1" * 16 + b"\1\0\0\0\xff\xff\xff\x7f" + bytes(16), "truncated"),
    ],
)
def test_what_is_wrong_has_a_reason(payload: bytes, reason: str) -> None:
    with pytest.raises(ProtocolError, match="discovery-info-" + reason):
        parse(payload)


def test_gids_are_bounded_over_all_nodes() -> None:
    guids = tuple([bytes(16)] * 4096)
    nodes = (NodeEntities("/", "a", guids), NodeEntities("/", "b", guids))
    payload = ParticipantEntities(bytes(16), nodes).emit()
    assert len(parse(payload)[0].nodes) == 2
    payload = ParticipantEntities(bytes(16), nodes + (NodeEntities("/", "c", guids[:1]),)).emit()  # noqa: RUF005
    with pytest.raises(ProtocolError, match="discovery-info-too-large"):
        parse(payload, GID)


def test_octets_where_a_long_gid_has_zeros_are_refused() -> None:
    payload = bytearray(OLD_NODE)
    payload[4 + GID] = 1
    with pytest.raises(ProtocolError) as caught:
        parse(bytes(payload), OLD_GID)
    assert caught.value.reason == "discovery-info-gid"
