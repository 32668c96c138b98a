"""One question and its answer on a blocking socket, for a program that does nothing else meanwhile.

Command-line tools that ask the master or a node and then end need neither the loop nor a node of their own.
"""

from __future__ import annotations

import socket
import time
from struct import unpack

from roslet.engine.ros1.rpc import CallFailed, RpcClient, unpack_reply
from roslet.errors import CallTimeout, HandshakeRefused, ProtocolError, Unreachable
from roslet.names import parse_host_port
from roslet.wire.tcpros import MAX_HEADER, emit_header, parse_header

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import TracebackType
    from typing import Any

# Bytes taken from a socket in one go.
ROOM = 64 << 10


class Caller:
    """Calls the XML-RPC API at `uri` over one kept connection. `timeout` is in seconds, for each call.

    Raises InvalidName where `uri` is none.
    """

    def __init__(self, uri: str, timeout: float) -> None:
        host, port = parse_host_port(uri)
        path = "/" + uri.partition("://")[2].partition("/")[2]
        self._timeout = timeout
        self._client = RpcClient(host, port, path, timeout)
        self._sock: socket.socket | None = None

    def call(self, method: str, *params: Any) -> Any:
        """The value of the reply. Raises Fault, Unreachable, CallTimeout, ProtocolError."""
        client = self._client
        now = time.monotonic()
        end = now + self._timeout
        client.call(method, params, now)
        while True:
            event = client.next_event()
            if isinstance(event, CallFailed):
                self.close()
                raise event.error
            if event is not None:
                if client.wants_close:
                    self.close()
                return unpack_reply(event.value)
            if client.wants_connection:
                self._connect(end)
            elif client.wants_close:
                self.close()
            else:
                self._exchange(end)
            client.handle_deadline(time.monotonic())

    def _connect(self, end: float) -> None:
        client = self._client
        try:
            self._sock = connect(client.host, client.port, end)
        except (Unreachable, CallTimeout) as error:
            client.connection_lost(str(error), time.monotonic())
        else:
            client.connected(time.monotonic())

    def _exchange(self, end: float) -> None:
        """Send what there is, or else wait for an answer; a failure ends the connection."""
        sock, client = self._sock, self._client
        if sock is None:
            return
        try:
            sock.settimeout(max(0.001, end - time.monotonic()))
            output = client.data_to_send()
            if output:
                sock.sendall(output)
                return
            data = sock.recv(ROOM)
        except TimeoutError:
            return  # the client's own deadline has passed as well
        except OSError as error:
            self._lost(error.strerror or str(error))
            return
        if data:
            client.receive_data(data, time.monotonic())
        else:
            self._lost("closed by the peer")

    def _lost(self, reason: str) -> None:
        if self._sock is not None:
            self._sock.close()
            self._sock = None
            self._client.connection_lost(reason, time.monotonic())

    def close(self) -> None:
        """Close the connection; a later call makes a new one."""
        self._lost("closed here")

    def __enter__(self) -> Caller:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def connect(host: str, port: int, end: float) -> socket.socket:
    """A connected socket, by the moment `end` of the monotonic clock. Raises Unreachable, CallTimeout."""
    where = f"{host}:{port}"
    try:
        sock = socket.create_connection((host, port), max(0.001, end - time.monotonic()))
    except TimeoutError:
        raise CallTimeout(f"{where}: no connection in time") from None
    except OSError as error:
        raise Unreachable(f"{where}: {error.strerror or error}") from None
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return sock


def exchange_headers(uri: str, fields: dict[str, str], timeout: float) -> dict[str, str]:
    """What the TCPROS server at `uri` (rosrpc://host:port) answers to a connection header of `fields`.

    Raises Unreachable, CallTimeout, HandshakeRefused with the server's text, ProtocolError.
    """
    host, port = parse_host_port(uri)
    end = time.monotonic() + timeout
    with connect(host, port, end) as sock:
        try:
            sock.sendall(emit_header(fields))
            size: int = unpack("<I", _receive(sock, 4, end))[0]
            if size > MAX_HEADER:
                raise ProtocolError("header-too-long", f"{host}:{port} announces a header of {size} bytes")
            answer = parse_header(_receive(sock, size, end))
        except TimeoutError:
            raise CallTimeout(f"{host}:{port}: no connection header in time") from None
        except OSError as error:
            raise Unreachable(f"{host}:{port}: {error.strerror or error}") from None
    if "error" in answer:
        raise HandshakeRefused(answer["error"])
    return answer


def _receive(sock: socket.socket, size: int, end: float) -> bytes:
    data = b""
    while len(data) < size:
        sock.settimeout(max(0.001, end - time.monotonic()))
        piece = sock.recv(min(ROOM, size - len(data)))
        if not piece:
            raise Unreachable("the connection was closed before its header was whole")
        data += piece
    return data
