"""The shell of one ROS 1 engine on MicroPython: two listening sockets, and a stream for each connection."""

from roslet.engine.ros1.links import IncomingLink, PublisherLink
from roslet.engine.ros1.rpc import RpcClient, RpcServer
from roslet.io.micropython import sockets
from roslet.io.micropython.streams import Stream, lose_machine

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from roslet.engine.ros1.engine import Engine
    from roslet.io.micropython.loop import Loop


class Ros1Shell:
    """Runs `engine` on `loop`. At most `connections` come in; beyond it the one that was silent for longest, of those that
    carry no topic and no service, makes room. `room`: bytes that are read at once of calls."""

    def __init__(self, engine: "Engine", loop: "Loop", connections: int, room: int) -> None:
        self.engine = engine
        self.loop = loop
        self.room = bytearray(room)
        self.max_unsent = engine.max_body  # bytes of answers that wait for a peer which does not read them
        self.streams: list[Stream] = []  # the latest used at the end
        self._connections = connections
        self._opening: list[Any] = []  # machines whose connection is being made
        self._closed = False
        self._rpc, rpc_port = sockets.listen()
        self._tcpros, tcpros_port = sockets.listen()
        engine.listening(rpc_port, tcpros_port)
        loop.register(self._rpc, self._accept_rpc)
        loop.register(self._tcpros, self._accept_tcpros)
        loop.timed.append(self)

    # -- connections in

    def _accept_rpc(self, events: int) -> None:
        found = self._accept(self._rpc)
        if found is not None:
            server = self.engine.accept_rpc(self.loop.now())
            self.streams.append(Stream(self, server, found[0], "rpc", found[1]))

    def _accept_tcpros(self, events: int) -> None:
        found = self._accept(self._tcpros)
        if found is not None:
            link = self.engine.accept_tcpros(self.loop.now())
            self.streams.append(Stream(self, link, found[0], "tcpros"))

    def _accept(self, listener: "Any") -> "tuple[Any, str] | None":
        try:
            sock, raw = listener.accept()
        except OSError:
            self.engine.count("no-descriptors")
            self._evict()
            return None
        accepted = len([stream for stream in self.streams if stream.kind != "out"])
        if accepted >= self._connections and not self._evict():
            self.engine.count("too-many-connections")
            sock.close()
            return None
        sock.setblocking(False)
        sockets.tune(sock)
        return sock, sockets.host(raw)

    def _evict(self) -> bool:
        for stream in self.streams:
            if stream.kind != "out" and isinstance(stream.machine, (RpcServer, IncomingLink)):
                self.engine.count("connection-evicted")
                stream.lose("closed for a newer connection")
                return True
        return False

    def after(self, stream: Stream) -> None:
        """Something happened on a connection: do what follows from it."""
        machine = stream.machine
        now = self.loop.now()
        if stream.closed:
            if stream in self.streams:
                self.streams.remove(stream)
            if machine in self._opening:
                self._opening.remove(machine)
        elif not stream.connecting and machine in self._opening:
            self._opening.remove(machine)
        if stream.kind == "rpc":
            for reason in machine.take_refused():
                self.engine.count(reason)
            if not stream.closed:
                self.engine.rpc_pump(machine, now, stream.host)
                if len(self.streams) > 1 and stream is not self.streams[-1]:
                    self.streams.remove(stream)
                    self.streams.append(stream)
        elif stream.kind == "tcpros" and not stream.closed:
            successor = getattr(machine, "successor", None)
            if successor is not None:
                stream.adopt(successor, machine.take_rest())
                stream.flush()
                if isinstance(successor, PublisherLink) and not stream.closed:
                    if stream.rest:
                        successor.queue.push_rest(bytes(stream.rest))
                        stream.rest = b""
                    successor.publication.opened(successor)
        self.update()

    # -- connections out

    def update(self) -> None:
        """Do what the engine wants by now: open, send, close. Call it after each use of the engine."""
        engine = self.engine
        engine.pump(self.loop.now())
        for machine in engine.take_connections():
            self._open(machine)
        for touched in engine.take_touched():
            stream: Any = getattr(touched, "channel", None)
            if stream is not None and not stream.closed:
                if stream.connecting and stream.closing:
                    stream.lose("given up")
                stream.flush()

    def _open(self, machine: "Any") -> None:
        if isinstance(machine, RpcClient):
            host, port = machine.host, machine.port
        else:
            host, port = machine.address
        if self._closed or machine in self._opening:
            return
        try:
            sock = sockets.connect(host, port)
        except OSError as error:
            lose_machine(machine, "cannot connect: errno %s" % error.errno, self.loop.now())
            return
        self._opening.append(machine)
        self.streams.append(Stream(self, machine, sock, "out"))

    # -- time

    def deadline(self) -> "float | None":
        """When `handle_deadline` has something to do."""
        soonest = self.engine.deadline()
        for stream in self.streams:
            when = stream.deadline()
            if when is not None and (soonest is None or when < soonest):
                soonest = when
        return soonest

    def handle_deadline(self, now: float) -> None:
        """Do what is due."""
        when = self.engine.deadline()
        if when is not None and when <= now:
            self.engine.handle_deadline(now)
        for stream in list(self.streams):
            when = stream.deadline()
            if when is not None and when <= now:
                stream.handle_deadline(now)
        self.update()

    @property
    def unsent(self) -> bool:
        """Whether anything waits for room in a socket."""
        for stream in self.streams:
            queue = getattr(stream.machine, "queue", None)
            if stream.rest or (queue is not None and len(queue)):
                return True
        return False

    def close(self) -> None:
        """Close every socket, at once. Unregistering is the owner's business, before."""
        self._closed = True
        self.loop.timed.remove(self)
        for listener in (self._rpc, self._tcpros):
            self.loop.unregister(listener)
            listener.close()
        for stream in list(self.streams):
            stream.flush()
            if not stream.closed:
                stream.close()
                lose_machine(stream.machine, "the node was closed", self.loop.now())
        self.streams = []
        self.engine.close(self.loop.now())
