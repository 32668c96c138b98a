"""Services and their clients on the ROS 1 network."""

from __future__ import annotations

from roslet.errors import CallTimeout, RosletError, ServiceFailed, Unreachable
from roslet.node.future import Future
from roslet.node.services import Client, Service

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.ros1.graph import ServiceOffer
    from roslet.engine.ros1.links import ServiceClientLink
    from roslet.node.node import Node
    from roslet.node.ros1.network import Ros1Network

# Seconds between two looks for a service that is not there yet.
LOOK_AGAIN = 0.1


class Ros1Service(Service):
    """A service that is registered with the master."""

    def __init__(
        self, network: Ros1Network, node: Node, name: str, service_type: Any, handler: Callable[[Any], Any]
    ) -> None:
        super().__init__(node, name, service_type, handler)
        self._network = network
        self._entry: ServiceOffer | None = network.offer(self, self._serve)

    def _serve(self, view: memoryview, start: int, end: int, link: Any) -> bytes | None:
        # A buffer of its own: the handler may keep the request, and its views.
        answer = self._answer(memoryview(bytearray(view[start:end])), link)
        if not isinstance(answer, Future):
            return answer
        answer.add_done_callback(lambda done: self._respond_late(done, link))
        return None

    def _respond_late(self, done: Future[Any], link: Any) -> None:
        try:
            right, body = True, self._answer_of(done)
        except ServiceFailed as error:
            right, body = False, str(error).encode()
        network = self._network
        with network.reactor.lock:
            link.answer(right, body)
            network.engine.touch(link)
            network.update()
        network.reactor.wake()

    def close(self) -> None:
        entry, self._entry = self._entry, None
        if entry is not None:
            self._network.withdraw(entry)


class Ros1Client(Client):
    """`persistent` keeps one connection for many calls; they are answered in order, several may be in flight. Otherwise
    each call looks the service up and connects anew, as ROS does by default."""

    def __init__(
        self, network: Ros1Network, node: Node, name: str, service_type: Any, persistent: bool = False
    ) -> None:
        super().__init__(node, name, service_type)
        self.persistent = persistent
        self._network = network
        self._link: ServiceClientLink | None = None

    def call_async(self, request: Any = None, /, **fields: Any) -> Future[Any]:
        body, future = self._begin(request, fields)
        network = self._network
        with network.reactor.lock:
            link = self._link
            if link is not None and not link.closing:
                link.call(body, self._answer_to(future))
                network.engine.touch(link)
            else:
                self._look_up(body, future)
            network.update()
        return future

    def _look_up(self, body: bytes, future: Future[Any]) -> None:
        network = self._network

        def found(value: object, error: Exception | None, now: float) -> None:
            if error is not None or not isinstance(value, str):
                future.set_exception(error or RosletError(f"{self.name}: the master answered {value!r}"))
                return
            if future.done():
                return  # given up
            try:
                link = network.engine.service_link(value, self._header(), now)
            except RosletError as bad:
                future.set_exception(bad)
                return
            if self.persistent:
                self._link = link
            else:
                future.add_done_callback(lambda _: self._disconnect(link))
            link.call(body, self._answer_to(future))

        network.engine.call_master("lookupService", [self.node.name, self.name], found, network.reactor.now())

    def _header(self) -> dict[str, str]:
        fields = {
            "callerid": self.node.name,
            "md5sum": self.type._md5sum,
            "service": self.name,
            "type": self.type._type,
        }
        if self.persistent:
            fields["persistent"] = "1"
        return fields

    def _answer_to(self, future: Future[Any]) -> Callable[[bytes | None, RosletError | None], None]:
        def done(body: bytes | None, error: RosletError | None) -> None:
            if error is not None or body is None:
                future.set_exception(error or ServiceFailed(f"{self.name}: no response"))
            else:
                self._end(future, body)

        return done

    def ready(self) -> bool:
        try:
            return self.node.lookup_service(self.name) is not None
        except (Unreachable, CallTimeout):
            return False  # the master may come

    def wait(self, timeout: float | None = None) -> bool:
        node = self.node
        end = None if timeout is None else node.reactor.now() + timeout
        while not self.ready():
            left = LOOK_AGAIN if end is None else min(LOOK_AGAIN, end - node.reactor.now())
            if left <= 0:
                return False
            if node.reactor.run_until(lambda: node.is_shutdown, left, user=False):
                return False
        return True

    def close(self) -> None:
        self.closed = True
        link, self._link = self._link, None
        if link is not None:
            self._disconnect(link)

    def _disconnect(self, link: ServiceClientLink) -> None:
        """Close the connection; the call may be answered, or its caller no longer waits."""
        network = self._network
        with network.reactor.lock:
            if not link.closing:
                link.closing = True
                network.engine.touch(link)
                network.reactor.call_soon(network.update)
