"""The master as a rospy program asks it: through the node where there is one, over a connection of its own before."""

from __future__ import annotations

import os
import socket
import time
from typing import TYPE_CHECKING, Any

from roslet.compat.session import session
from roslet.engine.ros1.rpc import CallFailed, RpcClient, unpack_reply
from roslet.errors import ProtocolError, Unreachable
from roslet.names import parse_host_port, parse_network
from roslet.wire.tcpros import MAX_HEADER, emit_header, parse_header

if TYPE_CHECKING:
    from roslet.engine.ros1.rpc import ReplyReceived

# Seconds for one question.
TIMEOUT = 10.0
# Seconds for a service to answer that it is there.
PROBE_TIMEOUT = 2.0


def uri() -> str:
    """Where the master is."""
    if session.node is not None:
        return session.node.master_uri
    return parse_network(
        "ros1://", session.arguments.specials.get("master") or os.environ.get("ROS_MASTER_URI")
    )[1]


def call(method: str, *arguments: Any) -> Any:
    """What the master answers; our name is put before the arguments. Raises Fault, Unreachable, CallTimeout."""
    node = session.node
    if node is not None and not node.is_shutdown:
        return node.call_master(method, *arguments, timeout=TIMEOUT)
    return unpack(remote(uri(), method, [session.name, *arguments]))


def remote(where: str, method: str, arguments: list[Any], timeout: float = TIMEOUT) -> Any:
    """The whole reply of the XML-RPC server at `where`, over a connection for this call only.

    Raises Fault, Unreachable, CallTimeout, ProtocolError.
    """
    host, port = parse_host_port(where)
    begin = time.monotonic()
    client = RpcClient(host, port)
    client.call(method, arguments, 0.0)
    try:
        with socket.create_connection((host, port), timeout) as sock:
            client.connected(0.0)
            sock.sendall(client.data_to_send())
            while True:
                event = client.next_event()
                if event is not None:
                    return _outcome(event)
                data = sock.recv(65536)
                now = time.monotonic() - begin
                if not data:
                    client.connection_lost("closed by the peer", now)
                    event = client.next_event()
                    if event is None:
                        raise Unreachable(f"{where}: closed by the peer before an answer")
                    return _outcome(event)
                client.receive_data(data, now)
    except OSError as error:
        raise Unreachable(f"{where}: {error.strerror or error}") from None


def unpack(reply: Any) -> Any:
    """The value of a reply (code, status, value). Raises Fault where the code is not success."""
    return unpack_reply(reply)


def _outcome(event: ReplyReceived | CallFailed) -> Any:
    if isinstance(event, CallFailed):
        raise event.error
    return event.value


def probe_service(address: tuple[str, int], name: str) -> bool:
    """Whether the server at `address` offers the service `name`. Raises OSError."""
    fields = {"probe": "1", "md5sum": "*", "callerid": session.name, "service": name}
    with socket.create_connection(address, PROBE_TIMEOUT) as sock:
        sock.sendall(emit_header(fields))
        data = b""
        while len(data) < 4 or len(data) < 4 + int.from_bytes(data[:4], "little"):
            more = sock.recv(4096)
            if not more or len(data) > MAX_HEADER:
                return False
            data += more
    try:
        return "error" not in parse_header(data[4 : 4 + int.from_bytes(data[:4], "little")])
    except ProtocolError:
        return False


__all__ = ["call", "probe_service", "remote", "unpack", "uri"]
