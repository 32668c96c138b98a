"""HTTP messages as ROS peers write them, in every cut, and what ends a stream."""

import pytest

from roslet.wire import http

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython

ROSCPP_REQUEST = (
    b"POST / HTTP/1.1\r\nUser-Agent: XMLRPC++ 0.7\r\nHost: localhost:11311\r\nContent-Type: text/xml\r\n"
    b"Content-length: 5\r\n\r\nhello"
)
ROSPY_REQUEST = (
    b"POST /RPC2 HTTP/1.1\r\nHost: localhost:11311\r\nAccept-Encoding: gzip\r\nContent-Type: text/xml\r\n"
    b"User-Agent: Python-xmlrpc/3.11\r\nContent-Length: 3\r\n\r\nabc"
)
ROSCPP_RESPONSE = (
    b"HTTP/1.1 200 OK\r\nServer: XMLRPC++ 0.7\r\nContent-Type: text/xml\r\nContent-length: 4\r\n\r\nabcd"
)
ROSPY_RESPONSE = (
    b"HTTP/1.0 200 OK\r\nServer: BaseHTTP/0.6 Python/3.11.2\r\nDate: Sat, 22 Nov 2025 21:00:00 GMT\r\n"
    b"Content-type: text/xml\r\nContent-length: 4\r\n\r\nabcd"
)
CHUNKED_RESPONSE = (
    b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n"
    b"4\r\nabcd\r\nA;note=of nobody\r\n0123456789\r\n0\r\nX-Trailer: 1\r\n\r\n"
)


def feed_bytewise(parser: "Any", data: bytes) -> "list[Any]":
    found: list[Any] = []
    for at in range(len(data)):
        found.extend(parser.feed(data[at : at + 1]))
    return found


@pytest.mark.parametrize("data", [ROSCPP_REQUEST, ROSPY_REQUEST, ROSCPP_REQUEST.replace(b"\r\n", b"\n")])
def test_a_request_is_the_same_whole_byte_by_byte_and_with_a_tail(data: bytes) -> None:
    whole = http.RequestParser().feed(data)
    bytewise = feed_bytewise(http.RequestParser(), data)
    parser = http.RequestParser()
    with_tail = parser.feed(data + data[:20])
    for found in (whole, bytewise, with_tail):
        assert len(found) == 1
        assert found[0].method == "POST"
        assert found[0].body in (b"hello", b"abc")
        assert found[0].keep_alive
    assert not parser.idle
    assert [request.body for request in parser.feed(data[20:])] == [whole[0].body]
    assert parser.idle
    assert parser.error is None


@pytest.mark.parametrize(
    ("data", "body", "keep"),
    [
        (ROSCPP_RESPONSE, b"abcd", True),
        (ROSPY_RESPONSE, b"abcd", False),
        (CHUNKED_RESPONSE, b"abcd0123456789", True),
    ],
)
def test_a_response_is_the_same_whole_byte_by_byte_and_with_a_tail(
    data: bytes, body: bytes, keep: bool
) -> None:
    for found in (
        http.ResponseParser().feed(data),
        feed_bytewise(http.ResponseParser(), data),
        http.ResponseParser().feed(data + b"HTTP/1"),
    ):
        assert [(one.status, one.body, one.keep_alive) for one in found] == [(200, body, keep)]


def test_many_messages_in_one_piece_come_out_in_order() -> None:
    found = http.RequestParser().feed(ROSCPP_REQUEST + b"\r\n\r\n" + ROSPY_REQUEST + ROSCPP_REQUEST)
    assert [request.path for request in found] == ["/", "/RPC2", "/"]


def test_header_names_are_lower_case_and_values_stripped() -> None:
    (request,) = http.RequestParser().feed(
        b"GET /x HTTP/1.0\r\nX-Odd:   a b \r\nCONNECTION: Keep-Alive\r\n\r\n"
    )
    assert request.headers == {"x-odd": "a b", "connection": "Keep-Alive"}
    assert request.keep_alive
    assert request.body == b""


@pytest.mark.parametrize(
    ("line", "header", "keep"),
    [
        ("HTTP/1.1", "", True),
        ("HTTP/1.1", "Connection: close\r\n", False),
        ("HTTP/1.0", "", False),
        ("HTTP/1.0", "Connection: keep-alive\r\n", True),
    ],
)
def test_the_connection_is_kept_as_the_version_and_header_say(line: str, header: str, keep: bool) -> None:
    data = ("POST / %s\r\n%sContent-Length: 0\r\n\r\n" % (line, header)).encode()
    (request,) = http.RequestParser().feed(data)
    assert request.keep_alive == keep


def test_a_response_without_length_ends_with_the_connection() -> None:
    parser = http.ResponseParser()
    assert parser.feed(b"HTTP/1.0 200 OK\r\n\r\nab") == []
    assert parser.feed(b"cd") == []
    (response,) = parser.end()
    assert response.body == b"abcd"
    assert not response.keep_alive


def test_interim_responses_are_skipped() -> None:
    found = http.ResponseParser().feed(http.emit_continue() + ROSCPP_RESPONSE)
    assert [response.status for response in found] == [200]


def test_a_client_that_expects_to_be_asked_is_asked_once() -> None:
    parser = http.RequestParser()
    assert parser.feed(b"POST / HTTP/1.1\r\nExpect: 100-continue\r\nContent-Length: 3\r\n\r\n") == []
    assert parser.take_continue()
    assert not parser.take_continue()
    assert [request.body for request in parser.feed(b"abc")] == [b"abc"]


def test_a_client_that_sent_the_body_already_is_not_asked() -> None:
    parser = http.RequestParser()
    assert len(parser.feed(b"POST / HTTP/1.1\r\nExpect: 100-continue\r\nContent-Length: 1\r\n\r\na")) == 1
    assert not parser.take_continue()


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"garbage\r\n\r\n", "bad-start-line"),
        (b"POST / FTP/1.1\r\n\r\n", "bad-start-line"),
        (b"POST / HTTP/2.0\r\n\r\n", "unsupported-version"),
        (b"POST / HTTP/1.1\r\nno colon\r\n\r\n", "bad-header"),
        (b"POST / HTTP/1.1\r\n: empty\r\n\r\n", "bad-header"),
        (b"POST / HTTP/1.1\r\nContent-Length : 3\r\n\r\nabc", "bad-header"),
        (b"POST / HTTP/1.1\r\nContent-Length: -1\r\n\r\n", "bad-content-length"),
        (b"POST / HTTP/1.1\r\nContent-Length: 1x\r\n\r\n", "bad-content-length"),
        (b"POST / HTTP/1.1\r\nContent-Length: \xc2\xb2\r\n\r\n", "bad-content-length"),
        (b"POST / HTTP/1.1\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\nab", "bad-content-length"),
        (b"POST / HTTP/1.1\r\nContent-Length: 9999999999999999999999\r\n\r\n", "bad-content-length"),
        (b"POST / HTTP/1.1\r\nContent-Length: 101\r\n\r\n", "body-too-large"),
        (b"POST / HTTP/1.1\r\nTransfer-Encoding: gzip\r\n\r\n", "unsupported-encoding"),
        (b"POST / HTTP/1.1\r\nContent-Encoding: gzip\r\nContent-Length: 1\r\n\r\nx", "unsupported-encoding"),
        (b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n", "bad-chunk"),
        (b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n1\r\nabc", "bad-chunk"),
        (b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n" + b"1" * 300, "bad-chunk"),
        (b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\nff\r\n", "body-too-large"),
        (
            b"POST / HTTP/1.1\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n" + b"a: b\r\n" * 60,
            "header-too-large",
        ),
        (b"A" * 300, "header-too-large"),
        (b"POST / HTTP/1.1\r\n" + b"a: b\r\n" * 60, "header-too-large"),
    ],
)
def test_a_fault_ends_the_stream_under_its_reason(data: bytes, reason: str) -> None:
    parser = http.RequestParser(max_header=200, max_body=100)
    assert parser.feed(data) == []
    assert parser.error is not None
    assert parser.error.reason == reason
    assert parser.feed(ROSCPP_REQUEST) == []
    bytewise = http.RequestParser(max_header=200, max_body=100)
    assert feed_bytewise(bytewise, data) == []
    assert bytewise.error is not None
    assert bytewise.error.reason == reason


def test_what_was_complete_before_a_fault_is_still_returned() -> None:
    parser = http.RequestParser()
    assert len(parser.feed(ROSCPP_REQUEST + b"garbage\r\n\r\n")) == 1
    assert parser.error is not None
    assert parser.error.reason == "bad-start-line"


def test_a_close_inside_a_response_is_named_at_every_byte() -> None:
    for length in range(1, len(ROSCPP_RESPONSE)):
        parser = http.ResponseParser()
        assert parser.feed(ROSCPP_RESPONSE[:length]) == []
        assert parser.end() == []
        assert parser.error is not None
        assert parser.error.reason == "truncated"


def test_a_close_between_responses_is_no_fault() -> None:
    parser = http.ResponseParser()
    assert len(parser.feed(ROSCPP_RESPONSE)) == 1
    assert parser.end() == []
    assert parser.error is None


@pytest.mark.parametrize("data", [b"HTTP/1.1 2x0 OK\r\n\r\n", b"HTTP/1.1\r\n\r\n", b"HTTP/1.1 099 x\r\n\r\n"])
def test_a_response_needs_a_status(data: bytes) -> None:
    parser = http.ResponseParser()
    assert parser.feed(data) == []
    assert parser.error is not None
    assert parser.error.reason == "bad-start-line"


def test_what_is_emitted_is_parsed_back() -> None:
    (request,) = http.RequestParser().feed(http.emit_request("host:1", "/p", b"body"))
    assert (request.method, request.path, request.body) == ("POST", "/p", b"body")
    assert request.headers["host"] == "host:1"
    (response,) = http.ResponseParser().feed(http.emit_response(b"xyz"))
    assert (response.status, response.body, response.keep_alive) == (200, b"xyz", True)
    (response,) = http.ResponseParser().feed(http.emit_response(b"xyz", keep_alive=False))
    assert not response.keep_alive
    (response,) = http.ResponseParser().feed(http.emit_error(405))
    assert (response.status, response.keep_alive) == (405, False)
    assert response.headers["allow"] == "POST"


def test_a_large_body_in_small_pieces_costs_linear_work() -> None:
    size = 200_000
    data = http.emit_request("h:1", "/", b"x" * size)
    parser = http.RequestParser()
    found: list[Any] = []
    for at in range(0, len(data), 997):
        found.extend(parser.feed(data[at : at + 997]))
    assert len(found) == 1
    assert len(found[0].body) == size


def test_many_small_chunks_in_one_piece_cost_linear_work() -> None:
    count = 20_000
    data = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n" + b"1\r\na\r\n" * count + b"0\r\n\r\n"
    (response,) = http.ResponseParser().feed(data)
    assert len(response.body) == count
