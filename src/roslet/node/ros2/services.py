"""Services and their clients on the ROS 2 network."""

from __future__ import annotations

from collections import deque

from roslet.engine.ros2.services import ServiceClient, ServiceServer
from roslet.engine.rtps.history import HistoryFull
from roslet.errors import NodeClosed, RosletError, ServiceFailed
from roslet.node.future import Future
from roslet.node.ros2 import qos as presets
from roslet.node.ros2.qos import to_dds
from roslet.node.services import Client, Service

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.ros2.services import Request
    from roslet.engine.rtps.reader import WriterProxy
    from roslet.node.node import Node
    from roslet.node.qos import QoS
    from roslet.node.ros2.network import Ros2Network
    from roslet.wire.rtps.data import Data

    Reply = Callable[[bytes], None]

# Requests that wait for somebody to spin; more are dropped, the newest, and counted.
MAX_REQUESTS = 1000
# Calls of one client that wait for a server.
MAX_WAITING = 1000


class Ros2Service(Service):
    """A service with its two endpoints. With `background` the handler runs in the loop whoever runs it, with the reactor's
    lock held: it must be quick and of ours."""

    def __init__(
        self,
        network: Ros2Network,
        node: Node,
        name: str,
        service_type: Any,
        handler: Callable[[Any], Any],
        qos: QoS = presets.SERVICES,
        background: bool = False,
    ) -> None:
        super().__init__(node, name, service_type, handler)
        self._network = network
        self.background = background
        self._requests: deque[tuple[Any, Reply]] = deque()
        self._due = False
        reactor = network.reactor
        with reactor.lock:
            self._server: ServiceServer | None = ServiceServer(
                network.shell.context,
                network.handle,
                name,
                service_type._type,
                to_dds(qos),
                reactor.now(),
                (service_type.Request._type_hash, service_type.Response._type_hash),
                self._sample,
            )
            network.process.services.setdefault(name, []).append(self)
            for client in network.process.clients.get(name, ()):
                if client.type._type == service_type._type:
                    client.served_here(self)
            network.shell.flush()

    def _sample(self, proxy: WriterProxy, value: Data, time: int | None) -> None:
        """In the loop, with the lock held."""
        server = self._server
        if server is None:
            return
        request = server.request(proxy, value, time)
        if request is not None:
            body = bytearray(request.payload)
            request.payload = b""
            self.receive(body, lambda response: self._reply(request, response))

    def receive(self, body: Any, reply: Reply) -> None:
        """A request, from the network or from a client of this process; `reply` gets the bytes of the response. With the
        reactor's lock held."""
        if self.background:
            self._respond(body, reply)
            return
        if len(self._requests) >= MAX_REQUESTS:
            self.node._count("requests-full")
            return
        self._requests.append((body, reply))
        if not self._due:
            self._due = True
            self.node.reactor.call_soon(self._serve, user=True)

    def _serve(self) -> None:
        self._due = False
        for _ in range(len(self._requests)):
            if self._server is None or not self._requests:
                return
            self._respond(*self._requests.popleft())

    def _respond(self, body: Any, reply: Reply) -> None:
        try:
            response = self._answer(memoryview(body), None)
        except ServiceFailed:
            return  # it is logged and counted; ROS 2 has no answer for it
        if isinstance(response, Future):
            response.add_done_callback(lambda done: self._respond_late(done, reply))
        else:
            reply(response)

    def _respond_late(self, done: Future[Any], reply: Reply) -> None:
        try:
            response = self._answer_of(done)
        except ServiceFailed:
            return
        reply(response)

    def _reply(self, request: Request, response: bytes) -> None:
        reactor = self._network.reactor
        with reactor.lock:
            if self._server is None:
                return
            try:
                self._server.reply(request, response, reactor.now())
            except HistoryFull:
                self.node._count("reply-history-full")
            self._network.shell.flush()

    def close(self) -> None:
        server, self._server = self._server, None
        if server is not None:
            network = self._network
            with network.reactor.lock:
                network.process.services[self.name].remove(self)
                network.services_made.remove(self)
                server.close(network.reactor.now())
                network.shell.flush()


class Ros2Client(Client):
    """Many calls may be in flight. A call that is made before a server is there waits for one."""

    def __init__(
        self, network: Ros2Network, node: Node, name: str, service_type: Any, qos: QoS = presets.SERVICES
    ) -> None:
        super().__init__(node, name, service_type)
        self._network = network
        self._waiting: deque[tuple[bytes, Future[Any]]] = deque()
        self._calls: dict[int, Future[Any]] = {}
        reactor = network.reactor
        with reactor.lock:
            self._client = ServiceClient(
                network.shell.context,
                network.handle,
                name,
                service_type._type,
                to_dds(qos),
                reactor.now(),
                (service_type.Request._type_hash, service_type.Response._type_hash),
                self._sample,
            )
            for endpoint in (self._client.reader, self._client.writer):
                network.shell.handle(endpoint.entity_id, self._matched)
            network.process.clients.setdefault(name, []).append(self)
            network.shell.flush()

    def ready(self) -> bool:
        """Whether a server is there, and both ways are matched."""
        return self._server_here() is not None or self._client.ready()

    def call_async(self, request: Any = None, /, **fields: Any) -> Future[Any]:
        body, future = self._begin(request, fields)
        network = self._network
        with network.reactor.lock:
            server = self._server_here()
            if server is not None:
                self._call_here(server, body, future)
            elif self._client.ready():
                self._send(body, future)
            elif len(self._waiting) >= MAX_WAITING:
                future.set_exception(RosletError(f"{self.name}: {MAX_WAITING} calls wait for a server"))
            else:
                self._waiting.append((body, future))
        return future

    def _send(self, body: bytes, future: Future[Any]) -> None:
        if future.done():
            return  # given up
        try:
            number = self._client.call(body, self._network.reactor.now())
        except RosletError as error:
            future.set_exception(error)
            return
        self._calls[number] = future
        future.add_done_callback(lambda _: self._forget(number))
        self._network.shell.flush()

    def _forget(self, number: int) -> None:
        with self._network.reactor.lock:
            if self._calls.pop(number, None) is not None:
                self._client.forget(number)

    def _matched(self, _event: Any) -> None:
        while self._waiting and self._client.ready():
            self._send(*self._waiting.popleft())

    def served_here(self, server: Ros2Service) -> None:
        """A service of this name and type has come up in this process. With the reactor's lock held."""
        while self._waiting:
            body, future = self._waiting.popleft()
            if not future.done():
                self._call_here(server, body, future)

    def _server_here(self) -> Ros2Service | None:
        """The service of this name and type in this process."""
        for server in self._network.process.services.get(self.name, ()):
            if server.type._type == self.type._type:
                return server
        return None

    def _call_here(self, server: Ros2Service, body: bytes, future: Future[Any]) -> None:
        server.receive(bytearray(body), lambda response: self._end(future, response))

    def _sample(self, proxy: WriterProxy, value: Data, time: int | None) -> None:
        """In the loop, with the lock held."""
        found = self._client.response(proxy, value)
        if found is not None:
            number, body = found
            future = self._calls.pop(number, None)
            if future is not None:
                self._end(future, bytearray(body))

    def wait(self, timeout: float | None = None) -> bool:
        node = self.node
        node.reactor.run_until(lambda: self.ready() or node.is_shutdown, timeout, user=False)
        return self.ready()

    def close(self) -> None:
        if self.closed:
            return
        self.closed = True
        network = self._network
        with network.reactor.lock:
            for endpoint in (self._client.reader, self._client.writer):
                network.shell.handle(endpoint.entity_id, None)
            self._client.close(network.reactor.now())
            network.clients.remove(self)
            network.process.clients[self.name].remove(self)
            network.shell.flush()
            unanswered = [future for _, future in self._waiting] + list(self._calls.values())
            self._waiting.clear()
        for future in unanswered:
            future.set_exception(NodeClosed(f"the client of {self.name} is closed"))
