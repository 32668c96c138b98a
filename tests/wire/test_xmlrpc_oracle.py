"""The XML-RPC codec against Python's own, in both directions, over random values."""

from __future__ import annotations

import datetime
import gzip
import itertools
import math
import threading
import xmlrpc.client
import xmlrpc.server
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from roslet.errors import Fault, ProtocolError
from roslet.wire import http
from roslet.wire import xmlrpc as ours

# What XML 1.0 carries unchanged: no control characters, no surrogates, and no carriage return, which every
# parser turns into a line feed.
CHARACTERS = st.characters(
    exclude_categories=("Cs", "Cc"), exclude_characters="\ufffe\uffff"
) | st.sampled_from("\t\n")
TEXT = st.text(CHARACTERS, max_size=20)
SCALARS = (
    st.none()
    | st.booleans()
    | st.integers(-(2**31), 2**31 - 1)
    | st.floats(allow_nan=False)
    | TEXT
    | st.binary(max_size=100)
)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXT, inner, max_size=4),
    max_leaves=20,
)
NAMES = st.from_regex(r"[a-zA-Z][a-zA-Z0-9_.:/]{0,20}", fullmatch=True)


def plain(value: Any) -> Any:
    """The oracle's wrapper types as plain values."""
    if isinstance(value, xmlrpc.client.Binary):
        return value.data
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    return value


@given(method=NAMES, params=st.lists(VALUES, max_size=4))
def test_our_calls_are_read_by_the_standard_library(method: str, params: list[Any]) -> None:
    got, name = xmlrpc.client.loads(ours.emit_call(method, params))
    assert (name, plain(got)) == (method, params)


@given(method=NAMES, params=st.lists(VALUES, max_size=4))
def test_calls_of_the_standard_library_are_read_by_us(method: str, params: list[Any]) -> None:
    text = xmlrpc.client.dumps(tuple(params), method, allow_none=True)
    assert ours.parse_call(text.encode()) == (method, params)


@given(value=VALUES)
def test_our_responses_are_read_by_the_standard_library(value: Any) -> None:
    got, _ = xmlrpc.client.loads(ours.emit_response(value))
    assert plain(got[0]) == value


@given(value=VALUES)
def test_responses_of_the_standard_library_are_read_by_us(value: Any) -> None:
    text = xmlrpc.client.dumps((value,), methodresponse=True, allow_none=True)
    assert ours.parse_response(text.encode()) == value


@given(value=VALUES)
def test_types_survive_and_not_only_equality(value: Any) -> None:
    assert repr(ours.parse_response(ours.emit_response(value))) == repr(value)


@given(code=st.integers(-(2**31), 2**31 - 1), text=TEXT)
def test_faults_agree_both_ways(code: int, text: str) -> None:
    with pytest.raises(xmlrpc.client.Fault) as theirs:
        xmlrpc.client.loads(ours.emit_fault(code, text))
    assert (theirs.value.faultCode, theirs.value.faultString) == (code, text)
    document = xmlrpc.client.dumps(xmlrpc.client.Fault(code, text)).encode()
    with pytest.raises(Fault) as mine:
        ours.parse_response(document)
    assert (mine.value.code, mine.value.message) == (code, text)


def test_not_a_number_and_times_agree() -> None:
    got, _ = xmlrpc.client.loads(ours.emit_response(float("nan")))
    assert isinstance(got[0], float)
    assert math.isnan(got[0])
    stamp = datetime.datetime(1998, 7, 17, 14, 8, 55)
    document = xmlrpc.client.dumps((stamp,), methodresponse=True).encode()
    assert ours.parse_response(document) == ours.DateTime("19980717T14:08:55")
    back, _ = xmlrpc.client.loads(
        ours.emit_response(ours.DateTime("19980717T14:08:55")), use_builtin_types=True
    )
    assert tuple(back) == (stamp,)


def test_a_declared_encoding_of_the_standard_library_is_read() -> None:
    text = xmlrpc.client.dumps(("\xe9",), "m", encoding="iso-8859-1")
    assert ours.parse_call(text.encode("iso-8859-1")) == ("m", ["\xe9"])


FRAGMENTS = st.sampled_from(
    b"<methodCall> <methodName> m </methodName> </methodCall> <methodResponse> </methodResponse> <fault>"
    b" </fault> <params> <param> </param> </params> <value> </value> <int> </int> <array> <data> </data>"
    b" </array> <struct> <member> <name> </name> </member> </struct> <value/> <nil/> 1 & &lt; \xff".split()
)


@settings(max_examples=300)
@given(document=st.binary(max_size=200) | st.lists(FRAGMENTS, max_size=40).map(b"".join))
def test_any_bytes_give_a_value_or_a_named_reason(document: bytes) -> None:
    for parse in (ours.parse_call, ours.parse_response):
        try:
            parse(document)
        except ProtocolError as error:
            assert error.reason
        except Fault as fault:
            assert isinstance(fault.code, int)


@settings(max_examples=200)
@given(value=VALUES, data=st.data())
def test_a_damaged_document_gives_a_value_or_a_named_reason(value: Any, data: st.DataObject) -> None:
    document = bytearray(ours.emit_call("m", [value]))
    for _ in range(data.draw(st.integers(1, 4))):
        document[data.draw(st.integers(0, len(document) - 1))] = data.draw(st.integers(0, 255))
    try:
        method, params = ours.parse_call(document)
        assert isinstance(method, str)
        assert isinstance(params, list)
    except ProtocolError as error:
        assert error.reason


@given(body=st.binary(max_size=300), cuts=st.lists(st.integers(0, 400), max_size=6))
def test_http_does_not_care_where_the_stream_is_cut(body: bytes, cuts: list[int]) -> None:
    data = http.emit_request("h:1", "/", body) + http.emit_request("h:1", "/two", b"")
    edges = [0, *sorted(min(cut, len(data)) for cut in cuts), len(data)]
    parser = http.RequestParser()
    found = [one for a, b in itertools.pairwise(edges) for one in parser.feed(data[a:b])]
    assert [(one.path, one.body) for one in found] == [("/", body), ("/two", b"")]
    assert parser.idle


@given(data=st.binary(max_size=300))
def test_any_bytes_leave_the_http_parsers_in_order(data: bytes) -> None:
    for parser in (http.RequestParser(256, 256), http.ResponseParser(256, 256)):
        parser.feed(data)
        assert parser.failed == (parser.error is not None)


class _Handler(xmlrpc.server.SimpleXMLRPCRequestHandler):
    protocol_version = "HTTP/1.1"
    encode_threshold = 10

    def log_message(self, format: str, *args: Any) -> None:  # noqa: A002
        pass


def test_a_server_that_would_compress_does_not_for_us() -> None:
    # We do not say Accept-Encoding, so even a willing server must send plain XML.
    import socket

    with xmlrpc.server.SimpleXMLRPCServer(("127.0.0.1", 0), _Handler, logRequests=False) as server:
        server.register_function(lambda: "x" * 5000, "long")
        thread = threading.Thread(target=server.handle_request)
        thread.start()
        with socket.create_connection(server.server_address) as sock:  # type: ignore[arg-type]
            sock.settimeout(5)
            sock.sendall(http.emit_request("127.0.0.1", "/", ours.emit_call("long", [])))
            parser = http.ResponseParser()
            found: list[http.Response] = []
            while not found:
                found = parser.feed(sock.recv(65536))
        thread.join(5)
    assert ours.parse_response(found[0].body) == "x" * 5000
    assert not found[0].body.startswith(gzip.compress(b"")[:2])
