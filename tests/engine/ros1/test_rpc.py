"""Two RPC machines talking to each other under a fake clock, and what ends a connection or a call."""

import pytest

from roslet.engine.ros1 import rpc
from roslet.engine.ros1.rpc import CallFailed, CallReceived, ReplyReceived, RpcClient, RpcServer
from roslet.errors import CallTimeout, Fault, InvalidMessage, ProtocolError, Unreachable
from roslet.wire import http, xmlrpc

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

pytestmark = pytest.mark.micropython


def add(caller: str, a: int, b: int = 0) -> "list[Any]":
    return [1, caller, a + b]


def explode() -> None:
    raise RuntimeError("boom")


METHODS: "rpc.Methods" = {"add": (add, 2, 3), "explode": (explode, 0, 0)}


def exchange(client: RpcClient, server: RpcServer, now: float, step: int = 1 << 20) -> None:
    """Carry bytes both ways in pieces of `step` until nothing moves."""
    for _ in range(200):
        out = client.data_to_send()
        for at in range(0, len(out), step):
            server.receive_data(out[at : at + step], now)
        rpc.answer_calls(server, METHODS, now)
        back = server.data_to_send()
        for at in range(0, len(back), step):
            client.receive_data(back[at : at + step], now)
        if not out and not back:
            return
    raise AssertionError("the machines do not come to rest")


def events(client: RpcClient) -> "list[Any]":
    found: list[Any] = []
    while True:
        event = client.next_event()
        if event is None:
            return found
        found.append(event)


def connected_pair(now: float = 0.0) -> "tuple[RpcClient, RpcServer]":
    client = RpcClient("127.0.0.1", 1)
    client.call("add", ["/first", 1, 2], now)
    client.connected(now)
    server = RpcServer(now)
    exchange(client, server, now)
    assert events(client) == [ReplyReceived(1, [1, "/first", 3])]
    return client, server


def post(method: str, params: "list[Any]", line: str = "POST / HTTP/1.1", extra: str = "") -> bytes:
    body = xmlrpc.emit_call(method, params)
    return ("%s\r\n%sContent-Length: %d\r\n\r\n" % (line, extra, len(body))).encode() + body


def answers(data: bytes) -> "list[Any]":
    return [xmlrpc.parse_response(one.body) for one in http.ResponseParser().feed(data)]


@pytest.mark.parametrize("step", [1, 7, 1 << 20])
def test_calls_are_answered_in_order_however_the_stream_is_cut(step: int) -> None:
    client = RpcClient("127.0.0.1", 11311)
    assert not client.wants_connection
    ids = [client.call("add", ["/n", index, 1], 0.0) for index in range(5)]
    assert client.wants_connection
    assert client.pending == 5
    client.connected(0.0)
    exchange(client, RpcServer(0.0), 1.0, step)
    assert events(client) == [ReplyReceived(ids[index], [1, "/n", index + 1]) for index in range(5)]
    assert client.pending == 0


def test_one_call_is_in_flight_at_a_time() -> None:
    client = RpcClient("127.0.0.1", 1)
    client.call("add", ["/n", 1, 1], 0.0)
    client.call("add", ["/n", 2, 1], 0.0)
    client.connected(0.0)
    assert len(http.RequestParser().feed(client.data_to_send())) == 1
    assert client.data_to_send() == b""


def test_a_fault_and_a_wrong_number_of_parameters_come_back_as_such() -> None:
    client, server = connected_pair()
    client.call("nope", [], 0.0)
    client.call("explode", [], 0.0)
    client.call("add", ["/n"], 0.0)
    exchange(client, server, 0.0)
    unknown, exploded, arity = events(client)
    assert isinstance(unknown.error, Fault)
    assert "nope" in unknown.error.message
    assert isinstance(exploded.error, Fault)
    assert "RuntimeError: boom" in exploded.error.message
    assert arity.value == [-1, "add takes 2 to 3 parameters, got 1", 0]


def test_a_multicall_answers_each_call_by_itself() -> None:
    client, server = connected_pair()
    calls: list[Any] = [
        {"methodName": "add", "params": ["/n", 1, 2]},
        {"methodName": "nope", "params": []},
        {"methodName": "explode", "params": []},
        {"methodName": "system.multicall", "params": [[]]},
        "no struct",
        {"methodName": "system.listMethods", "params": []},
    ]
    client.call("system.multicall", [calls], 0.0)
    exchange(client, server, 0.0)
    (event,) = events(client)
    first, unknown, exploded, nested, wrong, names = event.value
    assert first == [[1, "/n", 3]]
    assert unknown["faultCode"] == rpc.FAULT_NO_METHOD
    assert exploded["faultString"] == "RuntimeError: boom"
    assert nested["faultCode"] == wrong["faultCode"] == rpc.FAULT_PARSE
    assert names == [["add", "explode", "system.listMethods", "system.multicall"]]


@pytest.mark.parametrize("params", [[], ["x"], [[0] * (rpc.MAX_MULTICALL + 1)]])
def test_a_multicall_needs_one_bounded_array(params: "list[Any]") -> None:
    with pytest.raises(Fault):
        rpc.dispatch(METHODS, "system.multicall", params)


# -- the server


def test_pipelined_calls_are_handed_out_one_by_one() -> None:
    server = RpcServer(0.0)
    server.receive_data(post("add", ["/a", 1]) + post("add", ["/b", 2]), 0.0)
    assert server.next_event() == CallReceived(1, "add", ["/a", 1])
    assert server.next_event() is None
    server.reply(1, [1, "", 0], 0.0)
    assert server.next_event() == CallReceived(2, "add", ["/b", 2])
    server.reply(2, [1, "", 1], 0.0)
    assert answers(server.data_to_send()) == [[1, "", 0], [1, "", 1]]
    assert not server.closing


def test_an_answer_to_a_call_that_is_not_open_is_dropped() -> None:
    server = RpcServer(0.0)
    server.reply(1, "unasked", 0.0)
    assert server.data_to_send() == b""
    server.receive_data(post("add", ["/a", 1]), 0.0)
    server.reply(1, "once", 0.0)
    server.reply(1, "twice", 0.0)
    assert answers(server.data_to_send()) == ["once"]


def test_an_answer_that_cannot_be_sent_is_a_fault_for_the_client_and_raises_here() -> None:
    server = RpcServer(0.0)
    server.receive_data(post("add", []), 0.0)
    with pytest.raises(InvalidMessage):
        server.reply(1, object(), 0.0)
    with pytest.raises(Fault):
        answers(server.data_to_send())


def test_a_call_that_is_no_xml_rpc_fails_alone() -> None:
    server = RpcServer(0.0)
    bad = b"POST / HTTP/1.1\r\nContent-Length: 7\r\n\r\n<hello>"
    server.receive_data(bad + post("add", ["/n", 1]), 0.0)
    rpc.answer_calls(server, METHODS, 0.0)
    responses = http.ResponseParser().feed(server.data_to_send())
    with pytest.raises(Fault, match="unexpected-tag"):
        xmlrpc.parse_response(responses[0].body)
    assert xmlrpc.parse_response(responses[1].body) == [1, "/n", 1]
    assert not server.closing


@pytest.mark.parametrize(
    ("data", "status", "reason"),
    [
        (b"GET / HTTP/1.1\r\nHost: x\r\n\r\n", 405, "not-post"),
        (b"\x00\x01\x02 garbage\r\n\r\n", 400, "bad-start-line"),
        (b"POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n", 413, "body-too-large"),
        (b"POST / HTTP/3.0\r\n\r\n", 505, "unsupported-version"),
        (b"A" * (http.MAX_HEADER + 1), 431, "header-too-large"),
        (b"POST / HTTP/1.1\r\nTransfer-Encoding: gzip\r\n\r\n", 501, "unsupported-encoding"),
    ],
)
def test_what_is_no_request_is_answered_and_ends_the_connection(
    data: bytes, status: int, reason: str
) -> None:
    server = RpcServer(0.0)
    server.receive_data(data, 0.0)
    assert server.next_event() is None
    (response,) = http.ResponseParser().feed(server.data_to_send())
    assert response.status == status
    assert server.closing
    assert server.close_reason == reason
    assert server.deadline() is None
    server.receive_data(post("add", []), 0.0)
    assert server.next_event() is None


def test_calls_before_a_fault_in_the_stream_are_answered_first() -> None:
    server = RpcServer(0.0)
    server.receive_data(post("add", ["/n", 1]) + b"garbage\r\n\r\n", 0.0)
    assert not server.closing
    rpc.answer_calls(server, METHODS, 0.0)
    responses = http.ResponseParser().feed(server.data_to_send())
    assert [response.status for response in responses] == [200, 400]
    assert server.closing


def test_more_calls_ahead_of_the_answers_than_the_bound_end_the_connection() -> None:
    server = RpcServer(0.0)
    server.receive_data(post("add", ["/n", 1]) * (rpc.MAX_PIPELINED + 2), 0.0)
    assert server.close_reason == "too-many-requests"


@pytest.mark.parametrize(
    ("line", "extra", "closes"),
    [
        ("POST / HTTP/1.0", "", True),
        ("POST / HTTP/1.0", "Connection: keep-alive\r\n", False),
        ("POST / HTTP/1.1", "Connection: close\r\n", True),
    ],
)
def test_the_connection_ends_after_the_answer_where_the_client_wants_it(
    line: str, extra: str, closes: bool
) -> None:
    server = RpcServer(0.0)
    server.receive_data(post("add", ["/n", 1], line, extra), 0.0)
    rpc.answer_calls(server, METHODS, 0.0)
    (response,) = http.ResponseParser().feed(server.data_to_send())
    assert response.keep_alive != closes
    assert server.closing == closes


def test_a_client_that_half_closes_still_gets_its_answer() -> None:
    server = RpcServer(0.0)
    server.receive_data(post("add", ["/n", 1]), 0.0)
    server.receive_end(0.0)
    assert not server.closing
    rpc.answer_calls(server, METHODS, 0.0)
    assert answers(server.data_to_send()) == [[1, "/n", 1]]
    assert server.close_reason == "peer-closed"


def test_a_silent_connection_is_closed_after_its_time() -> None:
    server = RpcServer(100.0)
    assert server.deadline() == 100.0 + rpc.REQUEST_TIMEOUT
    server.handle_deadline(100.0 + rpc.REQUEST_TIMEOUT - 0.1)
    assert not server.closing
    server.handle_deadline(100.0 + rpc.REQUEST_TIMEOUT)
    assert server.close_reason == "idle"


def test_a_kept_connection_may_be_idle_for_longer() -> None:
    _client, server = connected_pair(5.0)
    assert server.deadline() == 5.0 + rpc.IDLE_TIMEOUT


def test_a_trickled_request_does_not_extend_its_time() -> None:
    server = RpcServer(0.0)
    data = post("add", ["/n", 1])
    for at in range(20):
        server.receive_data(data[at : at + 1], float(at))
    assert server.deadline() == rpc.REQUEST_TIMEOUT
    server.handle_deadline(rpc.REQUEST_TIMEOUT)
    assert server.close_reason == "slow-request"
    (response,) = http.ResponseParser().feed(server.data_to_send())
    assert response.status == 408


def test_no_time_runs_while_a_call_waits_for_its_answer() -> None:
    server = RpcServer(0.0)
    server.receive_data(post("add", ["/n", 1]), 1.0)
    assert server.deadline() is None
    server.handle_deadline(1e9)
    assert not server.closing
    server.reply(1, [1, "", 0], 50.0)
    assert server.deadline() == 50.0 + rpc.IDLE_TIMEOUT


def test_a_client_that_waits_to_be_asked_for_the_body_is_asked() -> None:
    server = RpcServer(0.0)
    data = post("add", ["/n", 1], extra="Expect: 100-continue\r\n")
    head = data.find(b"\r\n\r\n") + 4
    server.receive_data(data[:head], 0.0)
    assert server.data_to_send() == http.emit_continue()
    server.receive_data(data[head:], 0.0)
    assert rpc.answer_calls(server, METHODS, 0.0) == 1


# -- the client


def test_a_refused_connection_fails_all_calls_that_wait() -> None:
    client = RpcClient("127.0.0.1", 1)
    ids = [client.call("add", [], 0.0), client.call("add", [], 0.0)]
    client.connection_lost("connection refused", 0.0)
    found = events(client)
    assert [event.call_id for event in found] == ids
    for event in found:
        assert isinstance(event.error, Unreachable)
        assert "127.0.0.1:1: connection refused" in str(event.error)
    assert not client.wants_connection
    assert client.pending == 0


def test_a_server_that_closes_after_each_answer_gets_a_connection_for_each_call() -> None:
    client = RpcClient("127.0.0.1", 1)
    client.call("add", ["/n", 1, 1], 0.0)
    client.call("add", ["/n", 2, 2], 0.0)
    for expected in (2, 4):
        assert client.wants_connection
        client.connected(0.0)
        assert len(http.RequestParser().feed(client.data_to_send())) == 1
        body = xmlrpc.emit_response([1, "", expected])
        client.receive_data(b"HTTP/1.0 200 OK\r\nContent-length: %d\r\n\r\n" % len(body) + body, 0.0)
        assert client.wants_close
        client.connection_lost("", 0.0)
    assert [event.value[2] for event in events(client)] == [2, 4]


def test_an_answer_may_end_with_the_connection() -> None:
    client = RpcClient("127.0.0.1", 1)
    client.call("add", [], 0.0)
    client.connected(0.0)
    client.data_to_send()
    client.receive_data(b"HTTP/1.0 200 OK\r\n\r\n" + xmlrpc.emit_response(7), 0.0)
    assert events(client) == []
    client.connection_lost("closed by the peer", 0.0)
    assert events(client) == [ReplyReceived(1, 7)]


def test_a_kept_connection_that_turns_out_closed_is_replaced_once() -> None:
    client, _server = connected_pair()
    call_id = client.call("add", ["/n", 1, 1], 10.0)
    request = client.data_to_send()
    client.connection_lost("connection reset", 10.0)
    assert events(client) == []
    assert client.wants_connection
    client.connected(10.0)
    assert client.data_to_send() == request
    client.connection_lost("connection reset", 10.0)
    (event,) = events(client)
    assert event.call_id == call_id
    assert isinstance(event.error, Unreachable)


def test_a_first_connection_that_breaks_is_not_tried_again() -> None:
    client = RpcClient("127.0.0.1", 1)
    client.call("add", [], 0.0)
    client.connected(0.0)
    client.connection_lost("connection reset", 0.0)
    (event,) = events(client)
    assert isinstance(event.error, Unreachable)
    assert not client.wants_connection


def test_an_answer_cut_short_is_not_asked_for_again() -> None:
    client, _server = connected_pair()
    client.call("add", [], 0.0)
    client.receive_data(b"HTTP/1.1 200", 0.0)
    client.connection_lost("closed by the peer", 0.0)
    (event,) = events(client)
    assert isinstance(event.error, Unreachable)


def test_a_call_without_an_answer_fails_after_its_time_and_the_next_gets_a_new_connection() -> None:
    client = RpcClient("127.0.0.1", 1, timeout=5.0)
    first = client.call("add", [], 0.0)
    second = client.call("add", [], 2.0, timeout=20.0)
    client.connected(1.0)
    assert client.deadline() == 5.0
    client.handle_deadline(5.0)
    (event,) = events(client)
    assert event.call_id == first
    assert isinstance(event.error, CallTimeout)
    assert client.wants_close
    client.connection_lost("", 5.0)
    assert client.wants_connection
    assert client.deadline() == 22.0
    client.handle_deadline(22.0)
    assert [one.call_id for one in events(client)] == [second]
    assert not client.wants_connection
    assert client.deadline() is None


def test_an_unused_connection_is_closed_by_the_client() -> None:
    client, _server = connected_pair(1.0)
    assert client.deadline() == 1.0 + rpc.CLIENT_IDLE_TIMEOUT
    client.handle_deadline(1.0 + rpc.CLIENT_IDLE_TIMEOUT)
    assert client.wants_close
    client.connection_lost("", 40.0)
    assert not client.wants_connection


@pytest.mark.parametrize(
    ("data", "kind", "text"),
    [
        (b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n", ProtocolError, "http-status"),
        (b"HTTP/1.1 200 OK\r\nContent-Length: 3\r\n\r\n<a>", ProtocolError, "unexpected-tag"),
        (b"SSH-2.0-OpenSSH\r\n\r\n", ProtocolError, "bad-start-line"),
        (b"HTTP/1.1 200 OK\r\nContent-Length: 99999999999\r\n\r\n", ProtocolError, "body-too-large"),
    ],
)
def test_an_answer_that_is_none_fails_the_call(data: bytes, kind: type, text: str) -> None:
    client = RpcClient("127.0.0.1", 1)
    client.call("add", [], 0.0)
    client.connected(0.0)
    client.receive_data(data, 0.0)
    (event,) = events(client)
    assert isinstance(event, CallFailed)
    assert isinstance(event.error, kind)
    assert text in str(event.error)


def test_bytes_that_answer_nothing_end_the_connection() -> None:
    client, _server = connected_pair()
    client.receive_data(b"HTTP/1.1 408 Request Timeout\r\n", 0.0)
    assert client.wants_close
    other, _server = connected_pair()
    other.call("add", [], 0.0)
    answer = http.emit_response(xmlrpc.emit_response(1))
    other.receive_data(answer + answer, 0.0)
    assert events(other) == [ReplyReceived(2, 1)]
    assert other.wants_close


def test_more_calls_than_the_bound_are_refused() -> None:
    client = RpcClient("127.0.0.1", 1)
    for _ in range(rpc.MAX_QUEUED_CALLS):
        client.call("add", [], 0.0)
    with pytest.raises(Unreachable):
        client.call("add", [], 0.0)


def test_a_value_that_cannot_be_sent_raises_at_the_call() -> None:
    client = RpcClient("127.0.0.1", 1)
    with pytest.raises(InvalidMessage):
        client.call("add", [object()], 0.0)
    assert client.pending == 0


def test_closing_fails_what_waits() -> None:
    client, _server = connected_pair()
    ids = [client.call("add", [], 0.0), client.call("add", [], 0.0)]
    client.close(0.0)
    assert [event.call_id for event in events(client)] == ids
    assert client.wants_close


def test_the_host_header_brackets_an_ipv6_address() -> None:
    client = RpcClient("::1", 80, "/RPC2")
    client.call("add", [], 0.0)
    client.connected(0.0)
    (request,) = http.RequestParser().feed(client.data_to_send())
    assert request.headers["host"] == "[::1]:80"
    assert request.path == "/RPC2"


def test_a_ros_reply_is_unpacked_or_raises() -> None:
    assert rpc.unpack_reply([1, "fine", "value"]) == "value"
    with pytest.raises(Fault, match="not set"):
        rpc.unpack_reply([-1, "not set", 0])
    for bad in ([1, "x"], "text", None, ["1", "", 0], [True, "", 0]):
        with pytest.raises(ProtocolError):
            rpc.unpack_reply(bad)
