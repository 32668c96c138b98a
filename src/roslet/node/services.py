"""Services and their clients on the ROS 1 network."""

from __future__ import annotations

from roslet.errors import CallTimeout, NodeClosed, RosletError, ServiceFailed, Unreachable
from roslet.node.future import Future

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.ros1.graph import ServiceOffer
    from roslet.engine.ros1.links import ServiceClientLink
    from roslet.node.node import Node

# Seconds between two looks for a service that is not there yet.
LOOK_AGAIN = 0.1


class Service:
    """Offers a service. Made by `Node.service`. The handler runs inside spin, one request at a time.

    `handler(request)` returns a response, a dict of its fields, or None for an empty response; what it raises goes to the
    caller as the text of its ServiceFailed.
    """

    def __init__(self, node: Node, name: str, service_type: Any, handler: Callable[[Any], Any]) -> None:
        self.node = node
        self.name = name
        self.type = service_type
        self.calls = 0
        self._handler: Callable[..., Any] = handler
        self._with_link = False
        self._entry: ServiceOffer | None = node._offer(self, self._serve)

    def _serve(self, view: memoryview, start: int, end: int, link: Any) -> bytes:
        self.calls += 1
        # A buffer of its own: the handler may keep the request, and its views.
        body = memoryview(bytearray(view[start:end]))
        try:
            request = self.type.Request.deserialize_from(body, 0, end - start)
        except (
            Exception
        ) as error:  # a client's bytes must not come out of spin, whatever they do to the decoder
            self.node._count("malformed-request")
            raise ServiceFailed(f"{self.name}: malformed request: {error}") from None
        try:
            response = self._handler(request, link) if self._with_link else self._handler(request)
            return self._serialize(response)
        except Exception as error:
            if not isinstance(error, ServiceFailed):
                self.node._count("handler-raised")
                self.node.log.error(f"{self.name}: the handler raised {type(error).__name__}: {error}")
            text = str(error) or type(error).__name__
            raise ServiceFailed(text.encode("utf-8", "replace").decode()) from None

    def _serialize(self, response: Any) -> bytes:
        kind = self.type.Response
        if response is None:
            response = kind()
        elif isinstance(response, dict):
            response = kind(**response)
        elif not isinstance(response, kind):
            raise TypeError(
                f"{self.name}: the handler returned {type(response).__name__}, not {kind.__name__}"
            )
        return bytes(response.serialize())

    def close(self) -> None:
        """Withdraw the service. Closing twice is allowed."""
        entry, self._entry = self._entry, None
        if entry is not None:
            self.node._withdraw(entry)

    def __enter__(self) -> Service:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class Client:
    """Calls a service. Made by `Node.client`.

    `persistent` keeps one connection for many calls; they are answered in order, several may be in flight. Otherwise each
    call looks the service up and connects anew, as ROS does by default.
    """

    def __init__(self, node: Node, name: str, service_type: Any, persistent: bool = False) -> None:
        self.node = node
        self.name = name
        self.type = service_type
        self.persistent = persistent
        self._link: ServiceClientLink | None = None
        self._closed = False

    def call(self, request: Any = None, /, timeout: float | None = None, **fields: Any) -> Any:
        """The response. `request` is a request message or a dict; or give its fields as keywords.

        Raises CallTimeout after `timeout` seconds (None: waits for ever), Fault where no such service is registered,
        Unreachable, HandshakeRefused, ServiceFailed with the handler's text, InvalidMessage.
        """
        future = self.call_async(request, **fields)
        try:
            return future.result(timeout)
        except CallTimeout:
            future.set_exception(CallTimeout("given up"))
            raise CallTimeout(f"service {self.name}: no response within {timeout:g} s") from None

    def call_async(self, request: Any = None, /, **fields: Any) -> Future[Any]:
        """The same without waiting: a Future of the response, which can be awaited."""
        if self._closed:
            raise NodeClosed(f"the client of {self.name} is closed")
        self.node._check_open()
        kind = self.type.Request
        if request is None:
            request = kind(**fields)
        elif isinstance(request, dict):
            request = kind(**request)
        elif not isinstance(request, kind):
            raise TypeError(f"{self.name} takes {kind.__name__}, not {type(request).__name__}")
        body = bytes(request.serialize())
        future = self.node._future(f"service {self.name}")
        with self.node.reactor.lock:
            link = self._link
            if link is not None and not link.closing:
                link.call(body, self._answer(future))
                self.node._engine.touch(link)
            else:
                self._look_up(body, future)
            self.node._update()
        return future

    def _look_up(self, body: bytes, future: Future[Any]) -> None:
        node = self.node

        def found(value: object, error: Exception | None, now: float) -> None:
            if error is not None or not isinstance(value, str):
                future.set_exception(error or RosletError(f"{self.name}: the master answered {value!r}"))
                return
            if future.done():
                return  # given up
            try:
                link = node._engine.service_link(value, self._header(), now)
            except RosletError as bad:
                future.set_exception(bad)
                return
            if self.persistent:
                self._link = link
            else:
                future.add_done_callback(lambda _: self._disconnect(link))
            link.call(body, self._answer(future))

        node._engine.call_master("lookupService", [node.name, self.name], found, node.reactor.now())

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

    def _answer(self, future: Future[Any]) -> Callable[[bytes | None, RosletError | None], None]:
        def done(body: bytes | None, error: RosletError | None) -> None:
            if error is not None or body is None:
                future.set_exception(error or ServiceFailed(f"{self.name}: no response"))
                return
            try:
                response = self.type.Response.deserialize(body)
            except Exception as bad:  # as above
                self.node._count("malformed-response")
                future.set_exception(bad)
                return
            future.set_result(response)

        return done

    def wait(self, timeout: float | None = None) -> bool:
        """Serve until the service is registered; false after `timeout` seconds, or when the node closes."""
        node = self.node
        end = None if timeout is None else node.reactor.now() + timeout
        while True:
            try:
                if node.lookup_service(self.name) is not None:
                    return True
            except (Unreachable, CallTimeout):
                pass  # the master may come
            left = LOOK_AGAIN if end is None else min(LOOK_AGAIN, end - node.reactor.now())
            if left <= 0:
                return False
            if node.reactor.run_until(lambda: node.is_shutdown, left, user=False):
                return False

    def close(self) -> None:
        """Close the connection, if there is one. Closing twice is allowed."""
        self._closed = True
        link, self._link = self._link, None
        if link is not None:
            self._disconnect(link)

    def _disconnect(self, link: ServiceClientLink) -> None:
        """Close the connection; the call may be answered, or its caller no longer waits."""
        with self.node.reactor.lock:
            if not link.closing:
                link.closing = True
                self.node._engine.touch(link)
                self.node.reactor.call_soon(self.node._update)

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
