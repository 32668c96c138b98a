"""Publishers, subscriptions, services and clients on MicroPython: what they are on either network. See `roslet.node` for the
contracts; what differs is said here."""

from roslet.errors import CallTimeout, NodeClosed, ServiceFailed
from roslet.node.micropython import bounds
from roslet.node.micropython.types import converted
from roslet.wire.message import BufferTooSmall

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.node.micropython.node import Node


class Future:
    """The answer to a call that is under way. `result()` waits; `await` works in asyncio programs."""

    def __init__(self, node: "Node", what: str) -> None:
        self._node = node
        self._what = what
        self._done = False
        self._value: Any = None
        self._error: Exception | None = None
        self._callbacks: list[Callable[[Future], object]] = []
        node._futures.append(self)

    def done(self) -> bool:
        return self._done

    def result(self, timeout: "float | None" = None) -> "Any":
        """The value. Raises the call's error, or CallTimeout after `timeout` seconds."""
        if not self._done and not self._node.loop.run_until(self.done, timeout):
            raise CallTimeout("%s: no answer within %s s" % (self._what, timeout))
        if self._error is not None:
            raise self._error
        return self._value

    def add_done_callback(self, function: "Callable[[Future], object]") -> None:
        """Call `function(self)` when done; at once if done already."""
        if self._done:
            function(self)
        else:
            self._callbacks.append(function)

    def set_result(self, value: "Any") -> None:
        if not self._done:
            self._value = value
            self._finish()

    def set_exception(self, error: Exception) -> None:
        if not self._done:
            self._error = error
            self._finish()

    def _finish(self) -> None:
        self._done = True
        if self in self._node._futures:
            self._node._futures.remove(self)
        for function in self._callbacks:
            function(self)
        self._callbacks = []

    def __iter__(self) -> "Any":
        yield from self._node.loop.run(self.done)  # type: ignore[misc]  # a coroutine is a generator on MicroPython
        return self.result(0)

    __await__ = __iter__


def serialized(message: "Any") -> bytes:
    """The bytes of a message, in a buffer that grows to what it needs. Raises InvalidMessage."""
    size = message._fixed_size or bounds.PUBLISH
    while True:
        buffer = memoryview(bytearray(size))
        try:
            return bytes(buffer[: message.serialize_into(buffer, 0)])
        except BufferTooSmall as error:
            size = error.size


class Topics:
    """The publishers and subscriptions of a node. Those of one topic are no network's business: they are paired here."""

    def __init__(self) -> None:
        self.publishers: list[Any] = []
        self.subscriptions: list[Any] = []

    def add_publisher(self, publisher: "Publisher") -> None:
        self.publishers.append(publisher)
        for subscription in self.subscriptions:
            if subscription.topic == publisher.topic:
                publisher._local.append(subscription)

    def add_subscription(self, subscription: "Subscription") -> None:
        self.subscriptions.append(subscription)
        for publisher in self.publishers:
            if publisher.topic == subscription.topic:
                publisher._local.append(subscription)

    def remove_subscription(self, subscription: "Subscription") -> None:
        self.subscriptions.remove(subscription)
        for publisher in self.publishers:
            if subscription in publisher._local:
                publisher._local.remove(subscription)

    def publishers_of(self, subscription: "Subscription") -> int:
        """How many of the node's own publishers a subscription hears."""
        return len([one for one in self.publishers if subscription in one._local])


class Publisher:
    """Publishes one topic. Serialises into a buffer of its own, which only grows."""

    def __init__(self, node: "Node", topic: str, kind: "Any", qos: "Any") -> None:
        self.node = node
        self.topic = topic
        self.type = kind
        self.qos = qos
        self.messages = 0
        self._buffer = memoryview(bytearray(kind._fixed_size + 4 if kind._fixed_size else bounds.PUBLISH))
        self._whole = self._buffer
        self._local: list[Subscription] = []

    def publish(self, message: "Any" = None, **fields: "Any") -> None:
        """Send a message: one of this type, a dict, or its fields as keywords. Raises InvalidMessage, TypeError,
        NodeClosed."""
        if fields:
            message = self.type(**fields)
        elif message.__class__ is not self.type:
            message = converted(self.type, message, self.topic)
        self.messages += 1
        while True:
            try:
                self._send(message)
                break
            except BufferTooSmall as error:
                self._buffer = memoryview(bytearray(error.size + 4))
                self._whole = self._buffer
        for subscription in self._local:
            if not self.node.loop.later(subscription.deliver, message.copy()):
                self.node._count("receive-queue-full")

    def _send(self, message: "Any") -> None:
        raise NotImplementedError

    def _part(self, end: int) -> memoryview:
        """The buffer up to `end`; of one message after another of the same size the same object."""
        if len(self._whole) != end:
            self._whole = self._buffer[:end]
        return self._whole

    @property
    def subscriber_count(self) -> int:
        """Subscribers connected now, those of this node included."""
        raise NotImplementedError

    def wait_for_subscribers(self, count: int = 1, timeout: "float | None" = None) -> bool:
        """Serve until at least `count` subscribers are connected; false after `timeout` seconds."""
        return self.node.loop.run_until(lambda: self.subscriber_count >= count, timeout)

    def flush(self, timeout: "float | None" = None) -> bool:
        """Serve until every subscriber has been sent what was published; false after `timeout` seconds."""
        return self.node.loop.run_until(self._flushed, timeout)

    def _flushed(self) -> bool:
        raise NotImplementedError

    def close(self) -> None:
        """Withdraw the publisher. Closing twice is allowed."""
        raise NotImplementedError


class Subscription:
    """Receives one topic. A message may have views on the receive buffer: it is good until its callback returns, and
    `copy()` keeps it. What comes while a callback runs waits, as bytes, `qos.depth` messages at most."""

    def __init__(
        self, node: "Node", topic: str, kind: "Any", callback: "Callable[[Any], object] | None", qos: "Any"
    ) -> None:
        self.node = node
        self.topic = topic
        self.type = kind
        self.qos = qos
        self.closed = False
        self.messages = 0
        self.malformed = 0
        self.dropped = 0
        self._callback = callback
        self._queue: list[Any] = []
        self._waiting = 0

    def _take_in(self, view: "Any", start: int, end: int) -> None:
        """The bytes of a message; a view that is good until this returns."""
        if self.node.loop.busy:
            if self._waiting < self.qos.depth and self.node.loop.later(self._late, bytes(view[start:end])):
                self._waiting += 1
            else:
                self._drop()
            return
        try:
            message = self.type.deserialize_from(view, start, end)
        except (
            Exception
        ) as error:  # a peer's bytes must not come out of spin, whatever they do to the decoder
            self.malformed += 1
            self.node._count("malformed-message")
            if self.malformed == 1:
                self.node.log.error("%s: a message is malformed: %s" % (self.topic, error))
            return
        self.deliver(message)

    def _late(self, data: bytes) -> None:
        self._waiting -= 1
        if not self.closed:
            self._take_in(memoryview(data), 0, len(data))

    def deliver(self, message: "Any") -> None:
        """Hand a message over."""
        self.messages += 1
        callback = self._callback
        if callback is not None:
            self.node.loop.call(callback, message)
            return
        if len(self._queue) >= self.qos.depth:
            self._queue.pop(0)
            self._drop()
        self._queue.append(message.copy() if self.type._views else message)

    def _drop(self) -> None:
        self.dropped += 1
        self.node._count("receive-queue-full")

    @property
    def publisher_count(self) -> int:
        """Publishers connected now, those of this node included."""
        raise NotImplementedError

    def wait_for_publishers(self, count: int = 1, timeout: "float | None" = None) -> bool:
        """Serve until at least `count` publishers are connected; false after `timeout` seconds."""
        return self.node.loop.run_until(lambda: self.publisher_count >= count, timeout)

    def take(self, timeout: "float | None" = None) -> "Any":
        """The oldest message kept; None where there was none in time."""
        if not self._queue:
            self.node.loop.run_until(lambda: self._queue or self.closed, timeout)
        return self._queue.pop(0) if self._queue else None

    def __aiter__(self) -> "Subscription":
        return self

    async def __anext__(self) -> "Any":
        await self.node.loop.run(lambda: self._queue or self.closed)
        if not self._queue:
            raise StopAsyncIteration
        return self._queue.pop(0)

    def close(self) -> None:
        """Unsubscribe. Closing twice is allowed."""
        if not self.closed:
            self.closed = True
            self._disconnect()

    def _disconnect(self) -> None:
        raise NotImplementedError


class Service:
    """Offers a service. `handler(request)` returns a response, a dict of its fields, None, or a Future of any of these."""

    def __init__(self, node: "Node", name: str, kind: "Any", handler: "Callable[[Any], Any]") -> None:
        self.node = node
        self.name = name
        self.type = kind
        self.calls = 0
        self._handler = handler

    def _serve(self, body: bytes, answer: "Callable[[bytes | None, str], None]") -> None:
        """Run the handler; `answer(response, "")` or `answer(None, failure)` is called once."""
        self.calls += 1
        loop = self.node.loop
        before = loop.busy
        loop.busy = True
        try:
            request = self.type.Request.deserialize_from(memoryview(body), 0, len(body))
            response = self._handler(request)
            if not isinstance(response, Future):
                response = self._bytes(response)
        except Exception as error:
            self._failed(error, answer)
            return
        finally:
            loop.busy = before
        if isinstance(response, Future):
            response.add_done_callback(lambda future: self._finish(future, answer))
        else:
            answer(response, "")

    def _finish(self, future: Future, answer: "Callable[[bytes | None, str], None]") -> None:
        try:
            body = self._bytes(future.result(0))
        except Exception as error:
            self._failed(error, answer)
            return
        answer(body, "")

    def _failed(self, error: Exception, answer: "Callable[[bytes | None, str], None]") -> None:
        if not isinstance(error, ServiceFailed):
            self.node._count("handler-raised")
            self.node.log.error("%s: the handler raised %s: %s" % (self.name, type(error).__name__, error))
        answer(None, str(error) or type(error).__name__)

    def _bytes(self, response: "Any") -> bytes:
        return serialized(converted(self.type.Response, response, self.name))

    def close(self) -> None:
        """Withdraw the service. Closing twice is allowed."""
        raise NotImplementedError


class Client:
    """Calls a service."""

    def __init__(self, node: "Node", name: str, kind: "Any") -> None:
        self.node = node
        self.name = name
        self.type = kind
        self.closed = False

    def call(self, request: "Any" = None, *, timeout: "float | None" = None, **fields: "Any") -> "Any":
        """Call and wait; serves the loop meanwhile. Raises CallTimeout, ServiceFailed, Unreachable."""
        future = self.call_async(request, **fields)
        try:
            return future.result(timeout)
        except CallTimeout as error:
            future.set_exception(error)
            raise

    def call_async(self, request: "Any" = None, **fields: "Any") -> Future:
        """Call; the response comes to the Future."""
        if self.closed or self.node.is_shutdown:
            raise NodeClosed(self.name)
        kind = self.type.Request
        message = kind(**fields) if fields else converted(kind, request, self.name)
        future = Future(self.node, self.name)
        self._send(serialized(message), future)
        return future

    def _send(self, body: bytes, future: Future) -> None:
        raise NotImplementedError

    def _end(self, future: Future, body: "Any") -> None:
        try:
            future.set_result(self.type.Response.deserialize_from(memoryview(body), 0, len(body)))
        except Exception as error:
            future.set_exception(error)

    def ready(self) -> bool:
        """Whether a server is there."""
        raise NotImplementedError

    def wait(self, timeout: "float | None" = None) -> bool:
        """Serve until a server is there; false after `timeout` seconds."""
        return self.node.loop.run_until(self.ready, timeout)

    def close(self) -> None:
        """Closing twice is allowed."""
        self.closed = True
