"""The field-table codec against bytes written by hand. Runs on MicroPython too."""

import pytest

from roslet.errors import InvalidMessage, MalformedMessage
from roslet.wire import cdr, ros1
from roslet.wire.cursor import BOUNDED, FIXED, SINGLE, UNBOUNDED
from roslet.wire.message import Message, rescue_read, rescue_write

pytestmark = pytest.mark.micropython


class Inner(Message):
    __slots__ = ("flag", "number")
    _type = "pkg/Inner"
    _spec = (("flag", "bool", SINGLE, 0, None), ("number", "float64", SINGLE, 0, None))


class Outer(Message):
    __slots__ = ("inner", "name", "numbers", "triple", "words")
    _type = "pkg/Outer"
    _spec = (
        ("inner", Inner, SINGLE, 0, None),
        ("name", "string", SINGLE, 0, 5),
        ("numbers", "uint16", BOUNDED, 3, None),
        ("triple", "uint8", FIXED, 3, None),
        ("words", "string", UNBOUNDED, 0, None),
    )


class OuterCdr(Outer):
    _encoding = "cdr"


def outer(kind: type = Outer) -> "Outer":
    inner = Inner()
    inner.flag = True  # type: ignore[attr-defined]
    inner.number = 1.0  # type: ignore[attr-defined]
    message = kind()
    message.inner = inner
    message.name = "ab"
    message.numbers = [1, 0x203]
    message.triple = b"xyz"
    message.words = ["q", ""]
    return message  # type: ignore[no-any-return]


ROS1_BYTES = (
    b"\x01\x00\x00\x00\x00\x00\x00\xf0\x3f"
    b"\x02\x00\x00\x00ab"
    b"\x02\x00\x00\x00\x01\x00\x03\x02"
    b"xyz"
    b"\x02\x00\x00\x00\x01\x00\x00\x00q\x00\x00\x00\x00"
)
LITTLE_BYTES = (
    b"\x00\x01\x00\x00"
    b"\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\xf0\x3f"
    b"\x03\x00\x00\x00ab\x00\x00"
    b"\x02\x00\x00\x00\x01\x00\x03\x02"
    b"xyz\x00"
    b"\x02\x00\x00\x00\x02\x00\x00\x00q\x00\x00\x00\x01\x00\x00\x00\x00"
)
BIG_BYTES = (
    b"\x00\x00\x00\x00"
    b"\x01\x00\x00\x00\x00\x00\x00\x00\x3f\xf0\x00\x00\x00\x00\x00\x00"
    b"\x00\x00\x00\x03ab\x00\x00"
    b"\x00\x00\x00\x02\x00\x01\x02\x03"
    b"xyz\x00"
    b"\x00\x00\x00\x02\x00\x00\x00\x02q\x00\x00\x00\x00\x00\x00\x01\x00"
)
# Version 2 aligns a float64 to 4.
LITTLE2_BYTES = b"\x00\x07\x00\x00\x01\x00\x00\x00" + LITTLE_BYTES[12:]


def test_ros1_bytes_are_those_of_the_description() -> None:
    assert bytes(ros1.write(outer())) == ROS1_BYTES
    assert ros1.size(outer()) == len(ROS1_BYTES)
    assert ros1.read(Outer, memoryview(ROS1_BYTES), 0, len(ROS1_BYTES)) == outer()


@pytest.mark.parametrize(
    "representation, data",
    [(cdr.CDR_LE, LITTLE_BYTES), (cdr.CDR_BE, BIG_BYTES), (cdr.CDR2_LE, LITTLE2_BYTES)],
)
def test_cdr_bytes_are_those_of_the_specification(representation: int, data: bytes) -> None:
    assert bytes(cdr.write(outer(), representation)) == data
    assert cdr.read(OuterCdr, memoryview(data), 0, len(data)) == outer(OuterCdr)


def test_a_message_is_read_from_the_middle_of_a_buffer() -> None:
    data = memoryview(b"#######" + LITTLE_BYTES + b"###")
    assert cdr.read(OuterCdr, data, 7, 7 + len(LITTLE_BYTES)) == outer(OuterCdr)


def test_every_truncation_is_malformed_and_says_where() -> None:
    for size in range(len(ROS1_BYTES)):
        with pytest.raises(MalformedMessage) as caught:
            ros1.read(Outer, memoryview(ROS1_BYTES), 0, size)
        assert caught.value.offset <= size
    for size in range(len(BIG_BYTES)):
        with pytest.raises(MalformedMessage):
            cdr.read(OuterCdr, memoryview(BIG_BYTES), 0, size)


def test_ros1_refuses_what_follows_a_message_and_cdr_ignores_it() -> None:
    data = ROS1_BYTES + b"\0"
    with pytest.raises(MalformedMessage) as caught:
        ros1.read(Outer, memoryview(data), 0, len(data))
    assert caught.value.offset == len(ROS1_BYTES)
    data = LITTLE_BYTES + b"123456789"
    assert cdr.read(OuterCdr, memoryview(data), 0, len(data)) == outer(OuterCdr)


def test_other_encapsulations_are_named() -> None:
    with pytest.raises(MalformedMessage) as caught:
        cdr.read(OuterCdr, memoryview(b"\x00\x03\x00\x00"), 0, 4)
    assert caught.value.message == "cannot read encapsulation PL_CDR_LE"


def _set(message: object, name: str, value: object) -> None:
    if "." in name:
        first, name = name.split(".")
        message = getattr(message, first)
    setattr(message, name, value)


@pytest.mark.parametrize(
    "field, value, path, text",
    [
        ("inner.flag", 2, "inner.flag", "expected a bool, got 2"),
        ("inner.number", "1", "inner.number", "expected a float64, got str '1'"),
        ("inner", 5, "inner", "a value of type int has no field flag"),
        ("name", 5, "name", "expected a string, got int 5"),
        ("name", "abcdef", "name", "at most 5 bytes, got 6"),
        ("numbers", [1, 65536], "numbers[1]", "uint16 cannot hold 65536"),
        ("numbers", [1, -1, 3], "numbers[1]", "uint16 cannot hold -1"),
        ("numbers", [1, 2, 3, 4], "numbers", "at most 3 elements, got 4"),
        ("triple", b"xy", "triple", "expected exactly 3 elements, got 2"),
        ("triple", [1, 2, 256], "triple[2]", "uint8 cannot hold 256"),
        ("words", "abc", "words", "expected a list, got str 'abc'"),
        ("words", ["a", 5], "words[1]", "expected a string, got int 5"),
    ],
)
def test_a_wrong_value_is_named_by_its_path(field: str, value: object, path: str, text: str) -> None:
    message = outer()
    _set(message, field, value)
    with pytest.raises(InvalidMessage) as caught:
        rescue_write(message, bytearray(200), 0, None, ValueError())
    assert (caught.value.path, caught.value.message) == (path, text)


def test_lying_counts_allocate_nothing() -> None:
    data = bytearray(ROS1_BYTES)
    data[26:30] = b"\xff\xff\xff\xff"
    with pytest.raises(MalformedMessage) as caught:
        rescue_read(Outer, memoryview(data), 0, len(data))
    assert (caught.value.path, caught.value.offset) == ("words", 30)
    data[9:13] = b"\xff\xff\xff\x7f"
    with pytest.raises(MalformedMessage) as caught:
        rescue_read(Outer, memoryview(data), 0, len(data))
    assert caught.value.message == "2147483647 bytes needed, 26 left"


def test_an_error_shows_both_its_place_and_its_path() -> None:
    with pytest.raises(MalformedMessage) as caught:
        ros1.read(Outer, memoryview(ROS1_BYTES), 0, 11)
    assert str(caught.value) == "at byte 9 (name): 4 bytes needed, 2 left"
