"""The primitives that generated code stands on. Runs on MicroPython too."""

import pytest

from roslet.wire import primitives
from roslet.wire.arrays import numbers, octets, place

pytestmark = pytest.mark.micropython


def test_padding_is_written_as_zeros() -> None:
    buffer = bytearray(b"\xee" * 16)
    primitives.packer("<B3xI")(buffer, 2, 1, 2)
    assert bytes(buffer) == b"\xee\xee\x01\0\0\0\x02\0\0\0" + b"\xee" * 6
    buffer = bytearray(b"\xee" * 16)
    primitives.packers("<H", 4)[3](buffer, 0, 0x0102)
    assert bytes(buffer) == b"\0\0\0\x02\x01" + b"\xee" * 11


def test_a_string_and_its_neighbours_are_one_call() -> None:
    buffer = bytearray(b"\xee" * 16)
    primitives.text_packers("I", "B", 1)[4](buffer, 1, 3, b"ab", 7)
    assert bytes(buffer) == b"\xee\x03\0\0\0ab\0\0\0\x07" + b"\xee" * 5
    assert primitives.text_unpackers("B", 1)[5](buffer, 5) == (b"ab\0\0", 7)
    assert primitives.text_unpackers("", 1)[0](buffer, 5) == (b"",)
    assert primitives.text_bytes_packers("I", "", 0)[2](2, b"ab") == b"\2\0\0\0ab"


def test_padding_is_part_of_the_key() -> None:
    buffer = bytearray(b"\xee" * 16)
    primitives.padded_text_packers("I", "", 1)[2 << 3 | 3](buffer, 0, 3, b"ab")
    assert bytes(buffer) == b"\0\0\0\x03\0\0\0ab\0" + b"\xee" * 6
    assert primitives.padded_text_unpackers("H", 1)[3 << 3 | 2](b"ab\0..\x01\x02", 0) == (b"ab", 0x0201)


def test_tables_stay_small() -> None:
    table = primitives.text_unpackers("", 0)
    data = bytes(3000)
    for size in range(3000):
        assert len(table[size](data, 0)[0]) == size
    if primitives.CPYTHON:
        assert len(table) == primitives.MAX_TABLE


def test_text_is_kept_byte_for_byte() -> None:
    for text in ("", "abc", "äß€", "\U0001f916"):
        assert primitives.decode(primitives.encode(text)) == text
        for big in (True, False):
            assert primitives.decode_wide(primitives.encode_wide(text, big), big) == text
    assert primitives.encode_wide("aä\U0001f916", True) == (b"\0\0\x00a\0\0\x00\xe4\0\0\xd8\x3e\0\0\xdd\x16")
    assert primitives.encode_wide("a", False) == b"a\0\0\0"
    with pytest.raises(ValueError):
        primitives.decode_wide(b"\xff\xff\xff\xff", False)


def test_bytes_that_are_no_utf8_are_still_text() -> None:
    assert len(primitives.decode(b"a\xffb")) == 3


def test_arrays_become_little_endian_bytes() -> None:
    assert bytes(numbers("uint16").raw([1, 0x203])) == b"\x01\0\x03\x02"
    assert bytes(numbers("int8").raw((-1,))) == b"\xff"
    assert bytes(numbers("bool").raw([True, False])) == b"\x01\0"
    assert bytes(numbers("float64").raw([])) == b""
    assert list(numbers("int32").zeros(2)) == [0, 0]
    assert [float(value) for value in numbers("float32").from_bytes(b"\x3f\x80\0\0", True)] == [1.0]


def test_what_does_not_fit_an_array_raises() -> None:
    for primitive, value in (("uint8", [256]), ("int16", [40000]), ("uint32", [-1]), ("bool", [2])):
        with pytest.raises(primitives.FAILURES):
            numbers(primitive).raw(value)
    for wrong in ("text", 5, [300], {1: 2}):
        with pytest.raises(primitives.FAILURES):
            octets(wrong)


def test_a_large_payload_is_placed_or_handed_out() -> None:
    buffer = bytearray(10)
    assert place(buffer, 2, b"abc", None) == 5
    assert bytes(buffer) == b"\0\0abc\0\0\0\0\0"
    parts: list[tuple[int, object]] = []
    assert place(buffer, 2, b"abc", parts) == 2
    assert parts == [(2, b"abc")]
    with pytest.raises(ValueError):
        place(buffer, 8, b"abc", None)
