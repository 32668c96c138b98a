"""UDPROS blocks, against bytes written by hand from the protocol's description."""

import pytest

from roslet.errors import ProtocolError
from roslet.wire.udpros import DATA0, DATAN, ERR, MAX_BLOCKS, OPERATION, PING, SIZE, emit, parse

pytestmark = pytest.mark.micropython

# connection 0x04030201, DATAN, message 5, block 0x0706, "xyz"
LITERAL = b"\x01\x02\x03\x04\x01\x05\x06\x07xyz"


def test_a_block_is_what_the_protocol_writes() -> None:
    block = parse(memoryview(LITERAL))
    assert (block.connection_id, block.operation, block.message_id, block.block) == (
        0x04030201,
        DATAN,
        5,
        0x0706,
    )
    assert bytes(block.data) == b"xyz"


def test_a_frame_that_fits_is_one_datagram() -> None:
    assert emit(0x04030201, 5, memoryview(b"abc"), 1500) == [b"\x01\x02\x03\x04\x00\x05\x01\x00abc"]


def test_a_frame_is_cut_and_numbered() -> None:
    datagrams = emit(1, 300, memoryview(b"abcdefgh"), SIZE + 3)
    assert datagrams == [
        b"\x01\0\0\0\x00\x2c\x03\x00abc",  # DATA0 says three blocks; 300 is 44 modulo 256
        b"\x01\0\0\0\x01\x2c\x01\x00def",
        b"\x01\0\0\0\x01\x2c\x02\x00gh",
    ]


def test_a_frame_of_no_bytes_is_one_datagram() -> None:
    assert emit(1, 0, memoryview(b""), 100) == [b"\x01\0\0\0\x00\x00\x01\x00"]


def test_more_blocks_than_the_field_can_count_are_refused() -> None:
    assert len(emit(1, 0, memoryview(bytes(MAX_BLOCKS)), SIZE + 1)) == MAX_BLOCKS
    with pytest.raises(ProtocolError, match="udp-message-too-large"):
        emit(1, 0, memoryview(bytes(MAX_BLOCKS + 1)), SIZE + 1)


def test_a_datagram_cut_within_its_head_is_too_short() -> None:
    for length in range(SIZE):
        with pytest.raises(ProtocolError, match="udp-too-short"):
            parse(memoryview(LITERAL)[:length])
    assert bytes(parse(memoryview(LITERAL)[:SIZE]).data) == b""


def test_only_four_operations_exist() -> None:
    for operation in range(256):
        data = bytes([0, 0, 0, 0, operation, 0, 0, 0])
        if operation in (DATA0, DATAN, PING, ERR):
            assert parse(memoryview(data)).operation == operation
        else:
            with pytest.raises(ProtocolError, match="udp-unknown-operation"):
                parse(memoryview(data))
    assert OPERATION[DATAN] == "DATAN" and OPERATION[9] == "operation(9)"
