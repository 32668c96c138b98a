"""The shell of one ROS 1 engine: its two listening sockets, its datagram socket, and a stream for each connection."""

from __future__ import annotations

import os
import socket

from roslet.engine.ros1.links import IncomingLink, PublisherLink, ServiceClientLink
from roslet.engine.ros1.rpc import RpcClient, RpcServer
from roslet.io.select import EXHAUSTED, READ, Timer, listen, tune
from roslet.io.streams import BUSY, UNREAD, Stream, connect, lose_machine

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

    from roslet.engine.ros1.engine import Engine
    from roslet.engine.ros1.links import Machine
    from roslet.engine.ros1.udp import UdpReceiver
    from roslet.io.select import Reactor

# Connections of others to one node at a time, RPC and TCPROS each: more than a large robot has, fewer than the usual
# limit of 1024 descriptors. Beyond it the one that was silent for longest, and is neither a subscriber nor a client of a
# service, makes room (`connection-evicted`); where there is none the new one is closed (`too-many-connections`).
MAX_CONNECTIONS = 400
# Connections taken from a listening socket in one turn of the loop.
ACCEPTS = 16
# Seconds to leave a listening socket alone when the process has no descriptor left.
PAUSE = 0.2
# Bytes: no datagram is longer.
DATAGRAM = 65536


class Ros1Shell:
    """Runs `engine` on `reactor`. `bind` is the address to listen on."""

    def __init__(self, engine: Engine, reactor: Reactor, bind: str = "") -> None:
        self.engine = engine
        self.reactor = reactor
        self.streams: dict[Stream, str] = {}  # "rpc", "tcpros", or "out" for those we made; oldest first
        self._accepted = {"rpc": 0, "tcpros": 0}
        self._opening: dict[object, bool] = {}  # machines whose connection is being made
        self._timer: Timer | None = None
        self._closed = False
        self._rpc = listen(bind)
        try:
            self._tcpros = listen(bind)
        except OSError:
            self._rpc.close()
            raise
        engine.listening(self._rpc.getsockname()[1], self._tcpros.getsockname()[1])
        self._datagrams = Datagrams(engine, reactor, bind)
        engine.udp = self._datagrams
        reactor.register(self._rpc.fileno(), self._accept_rpc)
        reactor.register(self._tcpros.fileno(), self._accept_tcpros)

    # -- connections in

    def _accept_rpc(self, events: int) -> None:
        for sock, host in self._accept(self._rpc, "rpc"):
            server = self.engine.accept_rpc(self.reactor.now())

            def after(stream: Stream, host: str = host) -> None:
                self._rpc_after(stream, host)

            self.streams[Stream(self.reactor, server, sock, after, False)] = "rpc"

    def _accept_tcpros(self, events: int) -> None:
        for sock, _ in self._accept(self._tcpros, "tcpros"):
            link = self.engine.accept_tcpros(self.reactor.now())
            self.streams[Stream(self.reactor, link, sock, self._after, False)] = "tcpros"

    def _accept(self, listener: socket.socket, kind: str) -> Iterator[tuple[socket.socket, str]]:
        """The connections that have come, each with the address of its other end."""
        for _ in range(ACCEPTS):
            try:
                sock, address = listener.accept()
            except OSError as error:
                if error.errno in EXHAUSTED and not self._closed:
                    self.engine.count("no-descriptors")
                    if not self._evict(kind):
                        self._pause(listener.fileno())
                return
            if self._accepted[kind] >= MAX_CONNECTIONS and not self._evict(kind):
                self.engine.count("too-many-connections")
                sock.close()
                continue
            tune(sock)
            self._accepted[kind] += 1
            yield sock, str(address[0])

    def _evict(self, kind: str) -> bool:
        """Close the connection that was silent for longest, of those that carry no topic and no service."""
        for stream, of in self.streams.items():
            if of == kind and isinstance(stream.machine, (RpcServer, IncomingLink)):
                self.engine.count("connection-evicted")
                stream.lose("closed for a newer connection")
                return True
        return False

    def _pause(self, fd: int) -> None:
        self.reactor.modify(fd, 0)
        self.reactor.call_at(self.reactor.now() + PAUSE, lambda: self._resume(fd))

    def _resume(self, fd: int) -> None:
        if not self._closed:
            self.reactor.modify(fd, READ)

    def _rpc_after(self, stream: Stream, host: str) -> None:
        server = stream.machine
        self.streams.pop(stream, None)
        if stream.closed:
            self._accepted["rpc"] -= 1
            for reason in server.take_refused():
                self.engine.count(reason)
            if server.unfinished:
                self.engine.count("request-truncated")
            if stream.end == UNREAD:
                self.engine.count(UNREAD)
        else:
            self.streams[stream] = "rpc"  # the latest used at the end
            self.engine.rpc_pump(server, self.reactor.now(), host)
        self.update()

    def _after(self, stream: Stream) -> None:
        machine = stream.machine
        successor = getattr(machine, "successor", None)
        if successor is not None and not stream.closed:
            stream.adopt(successor, machine.take_rest())
            stream.flush()
            if isinstance(successor, PublisherLink):
                self._open_subscriber(stream, successor)
        if stream.closed and self.streams.pop(stream, None) is not None:
            self._accepted["tcpros"] -= 1
        self.update()

    def _open_subscriber(self, stream: Stream, link: PublisherLink) -> None:
        """From now on messages go to the subscriber; nothing that is published meanwhile may pass it by, or come twice."""
        if stream.closed or self._closed:
            return
        publication = link.publication
        if not publication.lock.acquire(False):
            self.reactor.call_at(self.reactor.now() + BUSY, lambda: self._open_subscriber(stream, link))
            return
        try:
            rest = stream.take_unsent()
            if rest:
                link.queue.push_rest(rest)
            publication.opened(link)
        finally:
            publication.lock.release()
        if len(link.queue):
            stream.want_write()

    # -- connections out

    def update(self) -> None:
        """Do what the engine wants by now: open, send, close, wake. Call it, with the loop's lock held, after each use of
        the engine."""
        engine = self.engine
        engine.pump(self.reactor.now())
        for machine in engine.take_connections():
            self._open(machine)
        for touched in engine.take_touched():
            stream: Any = getattr(touched, "channel", None)
            if stream is not None and not stream.closed:
                stream.flush()
                stream.arm()
        self._arm()

    def _open(self, machine: Machine | RpcClient) -> None:
        address = (machine.host, machine.port) if isinstance(machine, RpcClient) else machine.address
        if self._closed or machine in self._opening or address is None:
            return
        self._opening[machine] = True

        def failed(reason: str) -> None:
            self._opening.pop(machine, None)
            lose_machine(machine, reason, self.reactor.now())
            if not self._closed:
                self.reactor.call_soon(self.update)

        def opened(stream: Stream) -> bool:
            self.streams[stream] = "out"
            return not self._closed

        connect(self.reactor, machine, address, self._after_out, failed, opened)

    def _after_out(self, stream: Stream) -> None:
        if stream.closed:
            self.streams.pop(stream, None)
            self._opening.pop(stream.machine, None)
        elif not stream.connecting:
            self._opening.pop(stream.machine, None)
        self.update()

    @property
    def unsent(self) -> bool:
        """Whether anything waits for room in a socket."""
        return any(stream.unsent for stream in list(self.streams))

    def _arm(self) -> None:
        when = self.engine.deadline() if not self._closed else None
        timer = self._timer
        if timer is not None:
            if when is not None and timer.function is not None and timer.when == when:
                return
            timer.cancel()
            self._timer = None
        if when is not None:
            self._timer = self.reactor.call_at(when, self._due)

    def _due(self) -> None:
        self._timer = None
        self.engine.handle_deadline(self.reactor.now())
        self.update()

    def close(self) -> None:
        """Close every socket, at once. Unregistering is the owner's business, before."""
        with self.reactor.lock:
            self._closed = True
            if self._timer is not None:
                self._timer.cancel()
            for listener in (self._rpc, self._tcpros):
                self.reactor.unregister(listener.fileno())
                listener.close()
            for stream in list(self.streams):
                stream.flush()
                given_up = getattr(stream.machine, "queue", None)
                if given_up is not None and len(given_up) and not stream.closed:
                    self.engine.count("queued-at-close", len(given_up))
                stream.close()
                if isinstance(stream.machine, ServiceClientLink):
                    stream.machine.lost("the node was closed", self.reactor.now())
            self.streams.clear()
            self._opening.clear()
            self._datagrams.close_all()
            self.engine.close(self.reactor.now())

    def abandon(self) -> None:
        """In a forked child: give back the parent's sockets, and touch nothing else."""
        self._closed = True
        for listener in (self._rpc, self._tcpros):
            listener.close()
        for stream in self.streams:
            stream.closed = True
            stream.sock.close()
        self._datagrams.abandon()


class Datagrams:
    """The node's UDPROS sockets: one to send with, and one for each publisher that sends to us."""

    def __init__(self, engine: Engine, reactor: Reactor, bind: str) -> None:
        self._engine = engine
        self._reactor = reactor
        self._bind = bind
        self._sending: socket.socket | None = None
        self._receiving: dict[UdpReceiver, socket.socket] = {}
        self._buffer = bytearray(DATAGRAM)

    def _socket(self) -> socket.socket:
        sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            sock.setblocking(False)
            sock.bind((self._bind, 0))
        except OSError:
            sock.close()
            raise
        return sock

    def open(self, receiver: UdpReceiver) -> int:
        """The port on which `receiver` gets datagrams from now on; 0 where none can be had."""
        try:
            sock = self._socket()
        except OSError:
            return 0
        self._receiving[receiver] = sock

        def ready(events: int) -> None:
            self._receive(sock, receiver)

        self._reactor.register(sock.fileno(), ready, user=True)
        return int(sock.getsockname()[1])

    def _receive(self, sock: socket.socket, receiver: UdpReceiver) -> None:
        try:
            size, source = sock.recvfrom_into(self._buffer)
        except OSError:
            return
        receiver.receive_datagram(memoryview(self._buffer)[:size], source, self._reactor.now())

    def close(self, receiver: UdpReceiver) -> None:
        """Stop that. Closing what is not open is allowed."""
        sock = self._receiving.pop(receiver, None)
        if sock is not None:
            self._reactor.unregister(sock.fileno())
            sock.close()

    def send(self, datagram: bytes, address: tuple[str, int]) -> bool:
        """False where the datagram could not be handed to the kernel."""
        try:
            if self._sending is None:
                self._sending = self._socket()
            self._sending.sendto(datagram, address)
        except OSError:
            return False
        return True

    def abandon(self) -> None:
        for sock in [*self._receiving.values(), self._sending]:
            if sock is not None:
                sock.close()

    def close_all(self) -> None:
        """Close every socket."""
        for receiver in list(self._receiving):
            self.close(receiver)
        if self._sending is not None:
            self._sending.close()
            self._sending = None


def own_host(environment: dict[str, str] | os._Environ[str], master_host: str) -> str:
    """What others reach us by: $ROS_HOSTNAME, $ROS_IP, the address of the interface that leads to the master, or
    127.0.0.1. Asking the routing table sends nothing."""
    for variable in ("ROS_HOSTNAME", "ROS_IP"):
        host = environment.get(variable)
        if host:
            return host
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((master_host, 9))
            return str(probe.getsockname()[0])
        except OSError:
            return "127.0.0.1"
