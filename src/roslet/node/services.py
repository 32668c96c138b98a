"""Services and their clients: what they are on any network."""

from __future__ import annotations

from roslet.errors import CallTimeout, NodeClosed, ServiceFailed
from roslet.node.convert import message_of
from roslet.node.future import Future

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from typing_extensions import Self

    from roslet.node.node import Node


class Service:
    """Offers a service. Made by `Node.service`. The handler runs inside spin, one request at a time.

    `handler(request)` returns a response, a dict of its fields, None for an empty response, or a Future of any of these,
    which is answered when it is done. What it raises is logged
    and, on ROS 1, goes to the caller as the text of its ServiceFailed; ROS 2 has no such answer, so there the caller gets
    none.
    """

    def __init__(self, node: Node, name: str, service_type: Any, handler: Callable[[Any], Any]) -> None:
        self.node = node
        self.name = name
        self.type = service_type
        self.calls = 0
        self._handler: Callable[..., Any] = handler
        self._with_link = False

    def _answer(self, view: memoryview, link: Any) -> bytes | Future[Any]:
        """The response to a request, or a Future of what `_serialize` takes. `view` is the handler's to keep. Raises
        ServiceFailed."""
        self.calls += 1
        try:
            request = self.type.Request.deserialize_from(view, 0, len(view))
        except (
            Exception
        ) as error:  # a client's bytes must not come out of spin, whatever they do to the decoder
            self.node._count("malformed-request")
            raise ServiceFailed(f"{self.name}: malformed request: {error}") from None
        try:
            response = self._handler(request, link) if self._with_link else self._handler(request)
            return response if isinstance(response, Future) else self._serialize(response)
        except Exception as error:
            raise self._failure(error) from None

    def _answer_of(self, future: Future[Any]) -> bytes:
        """The response that a handler promised. Raises ServiceFailed."""
        try:
            return self._serialize(future.result(0))
        except Exception as error:
            raise self._failure(error) from None

    def _failure(self, error: Exception) -> ServiceFailed:
        if not isinstance(error, ServiceFailed):
            self.node._count("handler-raised")
            self.node.log.error(f"{self.name}: the handler raised {type(error).__name__}: {error}")
        text = str(error) or type(error).__name__
        return ServiceFailed(text.encode("utf-8", "replace").decode())

    def _serialize(self, response: Any) -> bytes:
        kind = self.type.Response
        made = kind() if response is None else message_of(kind, response, f"{self.name}: a response is")
        return bytes(made.serialize())

    def close(self) -> None:
        """Withdraw the service. Closing twice is allowed."""
        raise NotImplementedError

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class Client:
    """Calls a service. Made by `Node.client`."""

    def __init__(self, node: Node, name: str, service_type: Any) -> None:
        self.node = node
        self.name = name
        self.type = service_type
        self.closed = False

    def call(self, request: Any = None, /, timeout: float | None = None, **fields: Any) -> Any:
        """The response. `request` is a request message or a dict; or give its fields as keywords.

        Raises CallTimeout after `timeout` seconds (None: waits for ever), InvalidMessage. On ROS 1 also Fault where no
        such service is registered, Unreachable, HandshakeRefused, ServiceFailed with the handler's text; on ROS 2 the
        call waits until a server is there.
        """
        future = self.call_async(request, **fields)
        try:
            return future.result(timeout)
        except CallTimeout:
            future.set_exception(CallTimeout("given up"))
            raise CallTimeout(f"service {self.name}: no response within {timeout:g} s") from None

    def call_async(self, request: Any = None, /, **fields: Any) -> Future[Any]:
        """The same without waiting: a Future of the response, which can be awaited."""
        raise NotImplementedError

    def _begin(self, request: Any, fields: dict[str, Any]) -> tuple[bytes, Future[Any]]:
        """The bytes of a request, and what will hold its response."""
        if self.closed:
            raise NodeClosed(f"the client of {self.name} is closed")
        self.node._check_open()
        kind = self.type.Request
        made = kind(**fields) if request is None else message_of(kind, request, f"{self.name} takes")
        return bytes(made.serialize()), self.node._future(f"service {self.name}")

    def _end(self, future: Future[Any], body: Any) -> None:
        """The bytes of the response are there."""
        try:
            response = self.type.Response.deserialize(body)
        except Exception as bad:  # as with requests
            self.node._count("malformed-response")
            future.set_exception(bad)
            return
        future.set_result(response)

    def ready(self) -> bool:
        """Whether the service is there now; ROS 1 asks the master."""
        raise NotImplementedError

    def wait(self, timeout: float | None = None) -> bool:
        """Serve until the service is there; false after `timeout` seconds, or when the node closes."""
        raise NotImplementedError

    def close(self) -> None:
        """Call no more; a call that cannot be answered any more ends with an error: on ROS 2 NodeClosed, on ROS 1, where
        only persistent clients lose theirs, Unreachable. Closing twice is allowed."""
        raise NotImplementedError

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
