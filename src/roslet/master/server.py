"""The master on sockets: RPC connections in, notifications out, on the loop of `roslet.io.select`.

Nothing a client does ends the server, and no node waits for another: each node that is due notifications has
its own bounded queue, its own connection and its own timeouts. A node that cannot be reached stays
registered, as with rosmaster: it may only be slow, and its own registrations are its own to withdraw.
"""

from __future__ import annotations

import os
import signal
import socket
import sys
import threading
import uuid
from contextlib import nullcontext
from typing import TYPE_CHECKING, Any

from roslet.engine.ros1.rpc import CallFailed, RpcClient, RpcServer, answer_calls
from roslet.errors import InvalidName, RosletError
from roslet.io.interrupts import on_sigint
from roslet.io.select import EXHAUSTED, listen, tune
from roslet.io.select import reactor as shared_reactor
from roslet.io.streams import Stream, connect
from roslet.master.core import Master, Notification
from roslet.names import parse_host_port

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from roslet.io.select import Reactor

DEFAULT_PORT = 11311

# Open connections; past it the one that was silent for longest is closed, and its client reconnects with its
# next call. A ROS node holds two or three.
MAX_CONNECTIONS = 4096

# Notifications that wait for one node. A newer one replaces an older one about the same topic or parameter,
# so this is the number of topics and parameters that one node subscribes; past it the oldest is dropped and
# counted.
MAX_WAITING = 10_000

# Seconds that a node has for one notification, connecting included. roscpp and rospy answer within
# milliseconds.
NOTIFICATION_TIMEOUT = 10.0

# Connections that the kernel holds until they are accepted: past it clients wait a second to try again, and a
# launch file starts a hundred nodes at once.
BACKLOG = 1024

# Seconds without accepting when the process has no descriptor left and no connection to give up.
ACCEPT_PAUSE = 0.1
_EVICTED_AT_ONCE = 16
_ACCEPTED_AT_ONCE = 64


class MasterServer:
    """A master that listens on `host`:`port` (0: any free port) from construction until `close`.

    Raises OSError where it cannot listen. It runs on `reactor`, or on the process's own loop, which has a
    background thread: nobody needs to spin. `uri` is what nodes use as ROS_MASTER_URI; it names
    $ROS_HOSTNAME, $ROS_IP, `host` where that is one address, or this machine's name. `stopped` is set by
    `close` and by a client's shutdown call.
    """

    def __init__(
        self,
        host: str = "127.0.0.1",
        port: int = DEFAULT_PORT,
        reactor: Reactor | None = None,
        max_connections: int = MAX_CONNECTIONS,
        notification_timeout: float = NOTIFICATION_TIMEOUT,
    ) -> None:
        self.reactor = shared_reactor() if reactor is None else reactor
        self.stopped = threading.Event()
        self.drops: dict[str, int] = {}
        self._max_connections = max_connections
        self._timeout = notification_timeout
        self._streams: dict[Stream, None] = {}  # the least recently used first
        self._peers: dict[str, _Peer] = {}
        self._delivering = False
        self._listener = listen(host, port, BACKLOG)
        self.port = int(self._listener.getsockname()[1])
        self.uri = f"http://{_advertised(host)}:{self.port}/"
        self.master = Master(self.uri, os.getpid())
        self._methods = self.master.methods()
        with self.reactor.lock:
            self.reactor.register(self._listener.fileno(), self._accept)

    def __enter__(self) -> MasterServer:
        return self

    def __exit__(self, *ignored: object) -> None:
        self.close()

    @property
    def connections(self) -> int:
        """Open connections of clients."""
        return len(self._streams)

    def call(self, method: str, *params: Any) -> list[Any]:
        """Call the master from within the process: `call("setParam", "/me", "/key", 1)`."""
        with self.reactor.lock:
            reply = self.master.call(method, params)
            self._deliver_soon()
        return reply

    def close(self) -> None:
        """Stop listening and close every connection. May be called from any thread, and twice."""
        with self.reactor.lock:
            if self._listener.fileno() >= 0:
                self.reactor.unregister(self._listener.fileno())
                self._listener.close()
            for stream in list(self._streams):
                stream.close()
            self._streams.clear()
            for peer in list(self._peers.values()):
                peer.close()
            self._peers.clear()
            self.stopped.set()
        self.reactor.wake()

    def count(self, reason: str) -> None:
        """Count something dropped under its reason; `drops` holds the sums."""
        self.drops[reason] = self.drops.get(reason, 0) + 1

    # -- clients

    def _accept(self, events: int) -> None:
        for _ in range(_ACCEPTED_AT_ONCE):
            try:
                sock, _address = self._listener.accept()
            except BlockingIOError:
                return
            except OSError as error:
                if error.errno in EXHAUSTED and not self._evict(_EVICTED_AT_ONCE):
                    self._pause_accepting()
                return
            tune(sock)
            machine = RpcServer(self.reactor.now())
            self._streams[Stream(self.reactor, machine, sock, self._served, connecting=False)] = None
            if len(self._streams) > self._max_connections:
                self._evict(1)

    def _evict(self, most: int) -> int:
        """Close up to `most` connections, those that were silent for longest; how many were closed."""
        victims = list(self._streams)[:most]
        for stream in victims:
            self.count("connection-evicted")
            stream.lose("evicted")
        return len(victims)

    def _pause_accepting(self) -> None:
        self.count("no-descriptors")
        self.reactor.unregister(self._listener.fileno())
        self.reactor.call_at(self.reactor.now() + ACCEPT_PAUSE, self._resume_accepting)

    def _resume_accepting(self) -> None:
        if not self.stopped.is_set():
            self.reactor.register(self._listener.fileno(), self._accept)

    def _served(self, stream: Stream) -> None:
        machine: RpcServer = stream.machine
        self._streams.pop(stream, None)
        if stream.closed:
            if machine.close_reason not in ("", "peer-closed"):
                self.count(machine.close_reason)
            return
        self._streams[stream] = None
        if answer_calls(machine, self._methods, self.reactor.now()):
            self._deliver_soon()
            if self.master.stopping:
                # In the loop's next turn: this one still sends the answer.
                self.reactor.call_soon(self.close)

    # -- nodes

    def _deliver_soon(self) -> None:
        if not self._delivering:
            self._delivering = True
            self.reactor.call_soon(self._deliver)

    def _deliver(self) -> None:
        self._delivering = False
        if self.stopped.is_set():
            return
        touched: dict[str, _Peer] = {}
        for notification in self.master.take_notifications():
            peer = touched.get(notification.api) or self._peer(notification.api)
            if peer is not None:
                peer.add(notification)
                touched[notification.api] = peer
        for peer in touched.values():
            peer.pump()

    def _peer(self, api: str) -> _Peer | None:
        peer = self._peers.get(api)
        if peer is None:
            try:
                peer = self._peers[api] = _Peer(self, api, self._timeout)
            except InvalidName:
                self.count("bad-uri")
        return peer

    def forget(self, api: str) -> None:
        """A peer has nothing left to do."""
        self._peers.pop(api, None)


class _Peer:
    """The notifications that one node is due, delivered one after another over one connection at a time."""

    def __init__(self, server: MasterServer, api: str, timeout: float) -> None:
        host, port = parse_host_port(api)
        if not api.startswith("http://"):
            raise InvalidName(f"{api!r}: notifications go to http:// URIs only")
        path = "/" + api.partition("://")[2].partition("/")[2]
        self._server = server
        self._api = api
        self._client = RpcClient(host, port, path, timeout)
        self._waiting: dict[tuple[str, str], Notification] = {}
        self._current: Notification | None = None
        self._connecting = False
        self._stream: Stream | None = None

    def add(self, notification: Notification) -> None:
        """Queue a notification, instead of an older one about the same."""
        about = (notification.method, notification.key)
        self._waiting.pop(about, None)
        if len(self._waiting) >= MAX_WAITING:
            del self._waiting[next(iter(self._waiting))]
            self._server.count("notification-queue-full")
        self._waiting[about] = notification

    def pump(self) -> None:
        """Send the next notification, where none is under way."""
        client = self._client
        reactor = self._server.reactor
        if self._current is None and self._waiting:
            self._current = self._waiting.pop(next(iter(self._waiting)))
            try:
                client.call(self._current.method, self._current.params, reactor.now())
            except RosletError:
                self._server.count("notification-unsendable")
                self._current = None
                reactor.call_soon(self.pump)
                return
        if client.wants_connection:
            if not self._connecting:
                self._connecting = True
                connect(reactor, client, (client.host, client.port), self._changed, self._failed)
        elif self._stream is not None:
            self._stream.flush()
            self._stream.arm()
        elif self._current is None:
            self._server.forget(self._api)

    def close(self) -> None:
        self._waiting.clear()
        self._current = None
        if self._stream is not None:
            self._stream.close()

    def _failed(self, reason: str) -> None:
        """No socket could be made, or the host is unknown."""
        self._connecting = False
        self._client.connection_lost(reason, self._server.reactor.now())
        self._take_events()

    def _changed(self, stream: Stream) -> None:
        self._connecting = False
        self._stream = None if stream.closed else stream
        self._take_events()

    def _take_events(self) -> None:
        while True:
            event = self._client.next_event()
            if event is None:
                break
            notification, self._current = self._current, None
            if isinstance(event, CallFailed):
                self._server.count("notification-failed")
            elif notification is not None:
                self._server.master.notification_answered(notification, event.value)
        # Not from within the stream's own call: pump may send and close.
        self._server.reactor.call_soon(self.pump)


def _advertised(host: str) -> str:
    for variable in ("ROS_HOSTNAME", "ROS_IP"):
        if os.environ.get(variable):
            return os.environ[variable]
    return host if host not in ("", "0.0.0.0") else socket.gethostname()


def run(
    host: str = "0.0.0.0",
    port: int = DEFAULT_PORT,
    beside: Callable[[MasterServer], AbstractContextManager[object]] | None = None,
) -> int:
    """Be a master until Ctrl-C, SIGTERM or a client's shutdown call; what `roslet master` does. Returns the
    exit code.

    Sets /run_id, which roslaunch compares with its own. `beside(server)` is entered once the master listens, and left
    before it ends.
    """
    try:
        server = MasterServer(host, port)
    except OSError as error:
        print(f"roslet master: cannot listen on {host}:{port}: {error.strerror or error}", file=sys.stderr)
        return 1
    server.call("setParam", "/roslet_master", "/run_id", str(uuid.uuid1()))

    # As Ctrl-C: a handler that only set a flag would not end the loop's sleep.
    previous = signal.signal(signal.SIGTERM, on_sigint)
    try:
        with nullcontext() if beside is None else beside(server):
            print(f"ROS_MASTER_URI={server.uri}", flush=True)
            server.reactor.run_until(server.stopped.is_set)
    except KeyboardInterrupt:
        pass
    finally:
        signal.signal(signal.SIGTERM, previous)
        server.close()
    return 0
