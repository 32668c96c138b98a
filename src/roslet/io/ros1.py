"""The shell of one ROS 1 engine: its two listening sockets, its datagram socket, and a stream for each connection."""

from __future__ import annotations

import os
import socket

from roslet.engine.ros1.links import IncomingLink, PublisherLink
from roslet.engine.ros1.rpc import RpcClient, RpcServer
from roslet.io.select import EXHAUSTED, READ, Timer, listen, tune
from roslet.io.streams import Stream, connect, lose_machine

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from roslet.engine.ros1.engine import Engine
    from roslet.io.select import Reactor

# Connections of others to one node at a time, RPC and TCPROS each: more than a large robot has, fewer than the usual
# limit of 1024 descriptors. Beyond it a new one is closed at once and counted.
MAX_CONNECTIONS = 400
# Connections taken from a listening socket in one turn of the loop.
ACCEPTS = 16
# Seconds to leave a listening socket alone when the process has no descriptor left.
PAUSE = 0.2
DATAGRAM = 65536


class Ros1Shell:
    """Runs `engine` on `reactor`. `bind` is the address to listen on."""

    def __init__(self, engine: Engine, reactor: Reactor, bind: str = "") -> None:
        self.engine = engine
        self.reactor = reactor
        self.streams: set[Stream] = set()
        self._accepted = {"rpc": 0, "tcpros": 0}
        self._timer: Timer | None = None
        self._closed = False
        self._rpc = listen(bind)
        self._tcpros = listen(bind)
        engine.listening(self._rpc.getsockname()[1], self._tcpros.getsockname()[1])
        self._datagrams = Datagrams(engine, reactor, bind)
        engine.udp = self._datagrams
        reactor.register(self._rpc.fileno(), lambda events: self._accept(self._rpc, "rpc"))
        reactor.register(self._tcpros.fileno(), lambda events: self._accept(self._tcpros, "tcpros"))

    # -- connections in

    def _accept(self, listener: socket.socket, kind: str) -> None:
        for _ in range(ACCEPTS):
            try:
                sock, _address = listener.accept()
            except OSError as error:
                if error.errno in EXHAUSTED and not self._closed:
                    self.engine.count(f"{kind}: no-descriptors")
                    fd = listener.fileno()
                    self.reactor.modify(fd, 0)
                    self.reactor.call_at(self.reactor.now() + PAUSE, lambda fd=fd: self._resume(fd))
                return
            if self._accepted[kind] >= MAX_CONNECTIONS:
                self.engine.count(f"{kind}: too-many-connections")
                sock.close()
                continue
            tune(sock)
            now = self.reactor.now()
            machine: RpcServer | IncomingLink
            machine = self.engine.accept_rpc(now) if kind == "rpc" else self.engine.accept_tcpros(now)
            self._accepted[kind] += 1
            self.streams.add(
                Stream(self.reactor, machine, sock, self._rpc_after if kind == "rpc" else self._after, False)
            )

    def _resume(self, fd: int) -> None:
        if not self._closed:
            self.reactor.modify(fd, READ)

    def _rpc_after(self, stream: Stream) -> None:
        if not stream.closed:
            self.engine.rpc_pump(stream.machine, self.reactor.now())
        self._forget(stream, "rpc")
        self.update()

    def _after(self, stream: Stream) -> None:
        machine = stream.machine
        successor = getattr(machine, "successor", None)
        if successor is not None and not stream.closed:
            stream.adopt(successor, machine.take_rest())
            stream.flush()
            if isinstance(successor, PublisherLink) and not stream.closed:
                successor.publication.opened(successor)
        self._forget(stream, "tcpros")
        self.update()

    def _forget(self, stream: Stream, kind: str) -> None:
        if stream.closed and stream in self.streams:
            self.streams.discard(stream)
            if stream.machine.__class__ is not RpcClient and getattr(stream.machine, "address", None) is None:
                self._accepted[kind] -= 1

    # -- connections out

    def update(self) -> None:
        """Do what the engine wants by now: open, send, close, wake. Call it, with the loop's lock held, after each use of
        the engine."""
        engine = self.engine
        engine.pump(self.reactor.now())
        for machine in engine.take_connections():
            self._open(machine)
        for touched in engine.take_touched():
            stream = getattr(touched, "channel", None)
            if stream is not None and not stream.closed:
                stream.flush()
                stream.arm()
        self._arm()

    def _open(self, machine: Any) -> None:
        if isinstance(machine, RpcClient):
            if getattr(machine, "opening", False):
                return
            machine.opening = True
            address = (machine.host, machine.port)
        else:
            address = machine.address

        def failed(reason: str) -> None:
            machine.opening = False
            lose_machine(machine, reason, self.reactor.now())
            self.reactor.call_soon(self.update)

        connect(self.reactor, machine, address, self._after_out, failed)

    def _after_out(self, stream: Stream) -> None:
        if stream.closed:
            stream.machine.opening = False
            self.streams.discard(stream)
        else:
            self.streams.add(stream)
        self.update()

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
                stream.close()
            self.streams.clear()
            self._datagrams.close()


class Datagrams:
    """The node's UDPROS socket, made when the first topic wants it."""

    def __init__(self, engine: Engine, reactor: Reactor, bind: str) -> None:
        self._engine = engine
        self._reactor = reactor
        self._bind = bind
        self._sock: socket.socket | None = None
        self._buffer = bytearray(DATAGRAM)

    def _socket(self) -> socket.socket:
        if self._sock is None:
            sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            sock.setblocking(False)
            sock.bind((self._bind, 0))
            self._sock = sock
            self._reactor.register(sock.fileno(), self._ready, user=True)
        return self._sock

    @property
    def port(self) -> int:
        return int(self._socket().getsockname()[1])

    def _ready(self, events: int) -> None:
        if self._sock is None:
            return
        try:
            size, source = self._sock.recvfrom_into(self._buffer)
        except OSError:
            return
        self._engine.receive_datagram(memoryview(self._buffer)[:size], source, self._reactor.now())

    def send(self, datagram: bytes, address: tuple[str, int]) -> bool:
        """False where the datagram could not be handed to the kernel."""
        try:
            self._socket().sendto(datagram, address)
        except OSError:
            return False
        return True

    def close(self) -> None:
        if self._sock is not None:
            self._reactor.unregister(self._sock.fileno())
            self._sock.close()
            self._sock = None


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
