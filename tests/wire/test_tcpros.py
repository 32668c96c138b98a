"""TCPROS connection headers, against bytes written by hand from the protocol's description."""

import pytest

from roslet.errors import ProtocolError
from roslet.wire.tcpros import MAX_FIELDS, emit_header, parse_header, require

pytestmark = pytest.mark.micropython

# 4 + 5 bytes "a=bcd" and 4 + 6 bytes "topic=", 19 in all.
LITERAL = b"\x13\x00\x00\x00\x05\x00\x00\x00a=bcd\x06\x00\x00\x00topic="


def reason_of(data: bytes) -> str:
    with pytest.raises(ProtocolError) as raised:
        parse_header(data)
    reason: str = raised.value.reason
    return reason


def test_a_header_is_what_the_protocol_writes() -> None:
    assert emit_header({"a": "bcd"}) == b"\x09\x00\x00\x00\x05\x00\x00\x00a=bcd"
    assert emit_header({}) == b"\x00\x00\x00\x00"
    assert parse_header(LITERAL[4:]) == {"a": "bcd", "topic": ""}
    assert parse_header(b"") == {}


def test_a_value_may_hold_equals_signs_lines_and_other_languages() -> None:
    fields = {"message_definition": "int32 A=1\n\nint32 b\n", "callerid": "/\u00fc", "x": "="}
    assert parse_header(emit_header(fields)[4:]) == fields


def test_a_header_is_read_from_any_buffer() -> None:
    expected = {"a": "bcd", "topic": ""}
    assert parse_header(bytearray(LITERAL[4:])) == expected
    assert parse_header(memoryview(LITERAL)[4:]) == expected


def test_a_header_cut_anywhere_is_named_truncated_or_is_shorter() -> None:
    body = LITERAL[4:]
    for length in range(len(body)):
        if length in (0, 9):
            assert len(parse_header(body[:length])) < 2  # a cut between two fields cannot be seen
        else:
            assert reason_of(body[:length]) == "header-truncated"


def test_the_offset_of_what_is_wrong_is_said() -> None:
    with pytest.raises(ProtocolError, match="byte 9"):
        parse_header(LITERAL[4:15])
    with pytest.raises(ProtocolError, match="4294967295 bytes with 1 left, at byte 4"):
        parse_header(b"\xff\xff\xff\xffx")


def test_a_field_needs_a_name_and_an_equals_sign() -> None:
    assert reason_of(b"\x03\x00\x00\x00abc") == "header-field-without-equals"
    assert reason_of(b"\x03\x00\x00\x00=bc") == "header-field-without-equals"
    assert reason_of(b"\x00\x00\x00\x00") == "header-field-without-equals"


def test_a_field_must_be_utf_8() -> None:
    assert reason_of(b"\x03\x00\x00\x00a=\xff") == "header-not-utf-8"


def test_fields_have_a_bound() -> None:
    fields = {}
    for index in range(MAX_FIELDS):
        fields["f%d" % index] = ""
    assert len(parse_header(emit_header(fields)[4:])) == MAX_FIELDS
    fields["one more"] = ""
    assert reason_of(emit_header(fields)[4:]) == "header-too-many-fields"


def test_of_a_name_that_comes_twice_the_last_counts() -> None:
    assert parse_header(b"\x03\x00\x00\x00a=1\x03\x00\x00\x00a=2") == {"a": "2"}


def test_what_is_missing_is_named() -> None:
    require({"a": "", "b": ""}, ("a", "b"))
    with pytest.raises(ProtocolError, match="header-field-missing: b, c"):
        require({"a": ""}, ("a", "b", "c"))
