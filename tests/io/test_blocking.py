"""Calls on a blocking socket, against the standard library's XML-RPC server and against servers that misbehave."""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Iterator
from xmlrpc.server import SimpleXMLRPCRequestHandler, SimpleXMLRPCServer

import pytest

from roslet.errors import CallTimeout, Fault, HandshakeRefused, InvalidName, ProtocolError, Unreachable
from roslet.io.blocking import Caller, exchange_headers
from roslet.wire.tcpros import emit_header


class Keeping(SimpleXMLRPCRequestHandler):
    """Keeps its connections, as roscpp does; the default closes each after a reply, as rospy does."""

    protocol_version = "HTTP/1.1"


@pytest.fixture(params=[SimpleXMLRPCRequestHandler, Keeping])
def uri(request: pytest.FixtureRequest) -> Iterator[str]:
    with SimpleXMLRPCServer(("127.0.0.1", 0), request.param, logRequests=False) as server:
        server.register_function(lambda caller, value: [1, "echo", value], "echo")
        server.register_function(lambda caller: [-1, "you are wrong", 0], "refuse")
        server.register_function(lambda caller: "nothing of the kind", "odd")
        thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
        thread.start()
        yield f"http://127.0.0.1:{server.server_address[1]}/"
        server.shutdown()
        thread.join()


def test_several_calls_are_answered_whether_the_server_keeps_its_connections_or_not(uri: str) -> None:
    with Caller(uri, 5.0) as caller:
        for value in (1, "two", [3.0, {"four": True}]):
            assert caller.call("echo", "/me", value) == value


def test_failures_of_the_api_are_faults(uri: str) -> None:
    with Caller(uri, 5.0) as caller:
        with pytest.raises(Fault, match="you are wrong"):
            caller.call("refuse", "/me")
        with pytest.raises(ProtocolError, match="bad-reply"):
            caller.call("odd", "/me")
        with pytest.raises(Fault, match="not supported"):
            caller.call("nothing", "/me")
        assert caller.call("echo", "/me", 5) == 5


def test_where_nobody_listens_it_is_unreachable() -> None:
    with Caller("http://127.0.0.1:1/", 5.0) as caller, pytest.raises(Unreachable, match="Connection refused"):
        caller.call("getPid", "/me")


def test_an_address_that_is_none_is_refused_at_once() -> None:
    with pytest.raises(InvalidName):
        Caller("nonsense", 5.0)


@pytest.fixture
def serve() -> Iterator[Callable[[Callable[[socket.socket], None]], str]]:
    """Serve one connection with a function; gives host:port."""
    listeners: list[socket.socket] = []
    threads: list[threading.Thread] = []

    def begin(function: Callable[[socket.socket], None]) -> str:
        listener = socket.socket()
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        listeners.append(listener)

        def run() -> None:
            connection, _ = listener.accept()
            with connection:
                function(connection)

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        threads.append(thread)
        return f"127.0.0.1:{listener.getsockname()[1]}"

    yield begin
    for listener in listeners:
        listener.close()
    for thread in threads:
        thread.join(5)


def silent(connection: socket.socket) -> None:
    while connection.recv(4096):
        pass


def test_a_server_that_never_answers_is_a_timeout(serve: Callable[..., str]) -> None:
    with (
        Caller(f"http://{serve(silent)}/", 0.1) as caller,
        pytest.raises(CallTimeout, match="no answer to getPid"),
    ):
        caller.call("getPid", "/me")


def test_a_server_that_hangs_up_is_unreachable(serve: Callable[..., str]) -> None:
    where = serve(lambda connection: connection.recv(1) and None)
    with Caller(f"http://{where}/", 5.0) as caller, pytest.raises(Unreachable):
        caller.call("getPid", "/me")


def test_garbage_is_a_protocol_error(serve: Callable[..., str]) -> None:
    def answer(connection: socket.socket) -> None:
        connection.recv(4096)
        connection.sendall(b"SSH-2.0-server\r\n\r\n")
        silent(connection)

    with Caller(f"http://{serve(answer)}/", 5.0) as caller, pytest.raises(ProtocolError):
        caller.call("getPid", "/me")


def test_connection_headers_are_exchanged(serve: Callable[..., str]) -> None:
    got: list[bytes] = []

    def answer(connection: socket.socket) -> None:
        got.append(connection.recv(4096))
        data = emit_header({"type": "a/B", "md5sum": "x"})
        connection.sendall(data[:7])  # in pieces, as TCP may
        connection.sendall(data[7:])

    assert exchange_headers(f"rosrpc://{serve(answer)}", {"probe": "1"}, 5.0) == {
        "type": "a/B",
        "md5sum": "x",
    }
    assert got == [emit_header({"probe": "1"})]


def test_a_refusal_carries_the_servers_words(serve: Callable[..., str]) -> None:
    where = serve(
        lambda connection: connection.recv(4096) and connection.sendall(emit_header({"error": "no thanks"}))
    )
    with pytest.raises(HandshakeRefused, match="no thanks"):
        exchange_headers(f"rosrpc://{where}", {"probe": "1"}, 5.0)


@pytest.mark.parametrize(
    "answer, error",
    [
        (b"", Unreachable),
        (b"\x10\0\0\0half", Unreachable),
        (b"\xff\xff\xff\xff", ProtocolError),
        (b"\x04\0\0\0\xff\xff\xff\xff", ProtocolError),
    ],
)
def test_a_header_that_is_none_is_refused_and_nothing_is_allocated_for_it(
    answer: bytes, error: type[Exception], serve: Callable[..., str]
) -> None:
    def send(connection: socket.socket) -> None:
        connection.recv(4096)
        connection.sendall(answer)

    with pytest.raises(error):
        exchange_headers(f"rosrpc://{serve(send)}", {"probe": "1"}, 5.0)


def test_a_server_that_sends_no_header_is_a_timeout(serve: Callable[..., str]) -> None:
    with pytest.raises(CallTimeout):
        exchange_headers(f"rosrpc://{serve(silent)}", {"probe": "1"}, 0.1)
