"""Publishers and subscriptions: what they are on any network."""

from __future__ import annotations

import threading
from collections import deque

from roslet.errors import Unsupported
from roslet.node.convert import message_of

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from typing import Any

    from typing_extensions import Self

    from roslet.node.events import Event
    from roslet.node.node import Node
    from roslet.node.qos import QoS
    from roslet.wire.message import Message

# The first size of a publisher's buffer; it grows to what its messages need.
FIRST_BUFFER = 1024
# With `keep_all`, how long publishing waits for one subscriber that takes nothing. Seconds.
MAX_BLOCKING = 10.0
# With `keep_all`, most messages that a subscription keeps for `take()`, or that one of this node's own still has to get.
MAX_KEPT = 100_000


class RawMessage:
    """A message that was not deserialised, as a subscription of type "*" gets it.

    `data` are its bytes, `type`, `md5sum` and `definition` what the publisher said of it. On ROS 2 `data` begin with the
    encapsulation header, `md5sum` is the RIHS01 type hash, "" where the publisher told none, and `definition` is empty.
    """

    __slots__ = ("data", "definition", "md5sum", "type")

    def __init__(self, data: bytes, type: str, md5sum: str, definition: str) -> None:  # noqa: A002 - the field's name
        self.data = data
        self.type = type
        self.md5sum = md5sum
        self.definition = definition

    def __repr__(self) -> str:
        return f"RawMessage({self.type}, {len(self.data)} bytes)"


class Publisher:
    """Publishes one topic. Made by `Node.publisher`. Any thread may publish.

    statistics: messages, dropped (for slow subscribers, oldest first).
    """

    def __init__(self, node: Node, topic: str, message_type: type[Message], qos: QoS) -> None:
        self.node = node
        self.topic = topic
        self.type = message_type
        self.qos = qos
        self.messages = 0
        self._lock = threading.Lock()
        self._buffer = bytearray(FIRST_BUFFER)
        self._view = memoryview(self._buffer)
        self._latch = qos.durability == "transient_local"
        self._wait = qos.history == "keep_all"
        self._local: tuple[Subscription, ...] = ()
        self._on_connect: list[Callable[[str], None]] = []
        self._on_disconnect: list[Callable[[str], None]] = []

    @property
    def subscriber_count(self) -> int:
        """Subscribers connected now, those of this process included."""
        raise NotImplementedError

    @property
    def statistics(self) -> dict[str, int]:
        """Since the publisher was made: `messages` published, `dropped` (messages for slow or lost subscribers, one count
        for each subscriber); now: `subscribers`."""
        raise NotImplementedError

    def publish(self, message: Any = None, /, **fields: Any) -> None:
        """Send a message: a message of this type, or its fields as keywords.

        Raises InvalidMessage with the value path where a value does not fit its field, TypeError for a message of
        another type, NodeClosed. With history "keep_all" it waits while a subscriber takes nothing, at most
        MAX_BLOCKING seconds, then drops for that one.
        """
        raise NotImplementedError

    def _converted(self, message: Any, fields: dict[str, Any]) -> Message:
        if fields:
            raise TypeError(f"{self.topic}: publish a message or fields, not both")
        return self.convert(message)

    def convert(self, message: Any) -> Message:
        """A message of this type from what `message_of` takes. Raises TypeError."""
        return message_of(self.type, message, f"{self.topic} carries")

    def _grow(self, size: int) -> None:
        self._view.release()
        self._buffer = bytearray(max(size, 2 * len(self._buffer)))
        self._view = memoryview(self._buffer)

    def on_connect(self, function: Callable[[str], None]) -> None:
        """Call `function(name of the subscriber)` inside spin when a subscriber connects."""
        self._on_connect.append(function)

    def on_disconnect(self, function: Callable[[str], None]) -> None:
        """Call `function(name of the subscriber)` inside spin when a subscriber goes."""
        self._on_disconnect.append(function)

    def on_event(self, function: Callable[[Event], object]) -> None:
        """ROS 2: call `function(event)` inside spin for what `roslet.node.events` has. The first function is also told what
        came before it. Raises Unsupported on ROS 1."""
        raise Unsupported("on_event: the ROS 1 network tells no such events")

    @property
    def gid(self) -> bytes:
        """ROS 2: the 16 octets that name this publisher in the graph. Raises NodeClosed, Unsupported on ROS 1."""
        raise Unsupported("gid: the ROS 1 network has no such thing")

    def wait_for_subscribers(self, count: int = 1, timeout: float | None = None) -> bool:
        """Serve until at least `count` subscribers are connected; false after `timeout` seconds."""
        return self.node.reactor.run_until(lambda: self.subscriber_count >= count, timeout, user=False)

    def flush(self, timeout: float | None = None) -> bool:
        """Serve until every subscriber has been sent what was published, on ROS 2 until every reliable one has acknowledged
        it; false after `timeout` seconds."""
        return self.node.reactor.run_until(self._flushed, timeout)

    def _flushed(self) -> bool:
        raise NotImplementedError

    # -- within this process, nothing is serialised

    def _attach(self, subscription: Subscription) -> None:
        self._local = (*self._local, subscription)

    def _detach(self, subscription: Subscription) -> None:
        self._local = tuple(other for other in self._local if other is not subscription)

    def close(self) -> None:
        """Withdraw the publisher and disconnect every subscriber. Closing twice is allowed."""
        raise NotImplementedError

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class Subscription:
    """Receives one topic. Made by `Node.subscribe`.

    With a callback each message goes to it inside spin, in the thread that spins. Without one, messages are kept, at
    most `qos.depth` (the oldest is dropped and counted), for `take()` and `async for`.

    statistics: messages, dropped, malformed, publishers.
    """

    def __init__(
        self,
        node: Node,
        topic: str,
        message_type: type[Message] | None,
        callback: Callable[..., object] | None,
        qos: QoS,
        with_link: bool = False,
    ) -> None:
        self.node = node
        self.topic = topic
        self.type = message_type
        self.qos = qos
        self.closed = False
        self.messages = 0
        self.malformed = 0
        self.dropped = 0
        self._callback: Callable[..., object] | None = callback
        self._with_link = with_link
        self._queue: deque[Any] = deque()  # messages, for take()
        self._arrived: deque[tuple[Any, Any]] = deque()  # (message, link) that the loop still has to deliver
        self._delivery_due = False  # whether it has been asked to
        self._waiters: list[Callable[[], None]] = []
        self._on_connect: list[Callable[[str], None]] = []
        self._on_disconnect: list[Callable[[str], None]] = []

    # -- from the network, or from a publisher of this process, to whoever asked for it

    def _deliver(self, message: Any, link: Any) -> None:
        """Hand a message over; in the thread that spins. `link` tells where it came from: see `Node.subscribe`."""
        self.messages += 1
        callback = self._callback
        if callback is None:
            self._keep(message)
            return
        try:
            if self._with_link:
                callback(message, link)
            else:
                callback(message)
        except Exception as error:
            self.node.reactor.report(error)

    def _deliver_later(self, message: Any, link: Any = None) -> None:
        """The same from any thread, at the loop's next turn."""
        self._append(self._arrived, (message, link))
        if not self._delivery_due:
            self._delivery_due = True
            self.node.reactor.call_soon(self._deliver_arrived, user=True)

    def _deliver_arrived(self) -> None:
        self._delivery_due = False
        for _ in range(len(self._arrived)):
            if self.closed or not self._arrived:
                return
            self._deliver(*self._arrived.popleft())

    def _append(self, queue: deque[Any], message: Any) -> None:
        if len(queue) >= (self.qos.depth if self.qos.history == "keep_last" else MAX_KEPT):
            try:
                queue.popleft()
            except IndexError:
                pass  # another thread has just taken it
            else:
                self.dropped += 1
                self.node._count("receive-queue-full")
        queue.append(message)

    def _keep(self, message: Any) -> None:
        self._append(self._queue, message)
        self._wake_waiters()

    def _wake_waiters(self) -> None:
        waiters, self._waiters = self._waiters, []
        for wake in waiters:
            wake()

    def _reject(self, error: Exception, whence: str) -> None:
        """A message from `whence` is not one of the type."""
        self.malformed += 1
        self.node._count("malformed-message")
        if self.malformed == 1:
            self.node.log.error(f"{self.topic}: a message from {whence} is malformed: {error}")

    # -- for users

    def on_connect(self, function: Callable[[str], None]) -> None:
        """Call `function(name of the publisher)` inside spin when a publisher is connected."""
        self._on_connect.append(function)

    def on_disconnect(self, function: Callable[[str], None]) -> None:
        """Call `function(name of the publisher)` inside spin when a publisher goes."""
        self._on_disconnect.append(function)

    @property
    def publisher_count(self) -> int:
        """Publishers connected now, those of this process included."""
        raise NotImplementedError

    @property
    def statistics(self) -> dict[str, int]:
        """Since the subscription was made: `messages` received, `dropped` because nobody took them in time, `malformed`;
        now: `publishers`."""
        return {
            "messages": self.messages,
            "dropped": self.dropped,
            "malformed": self.malformed,
            "publishers": self.publisher_count,
        }

    def on_event(self, function: Callable[[Event], object]) -> None:
        """ROS 2: call `function(event)` inside spin for what `roslet.node.events` has. The first function is also told what
        came before it. Raises Unsupported on ROS 1."""
        raise Unsupported("on_event: the ROS 1 network tells no such events")

    @property
    def gid(self) -> bytes:
        """ROS 2: the 16 octets that name this subscription in the graph. Raises NodeClosed, Unsupported on ROS 1."""
        raise Unsupported("gid: the ROS 1 network has no such thing")

    def wait_for_publishers(self, count: int = 1, timeout: float | None = None) -> bool:
        """Serve until at least `count` publishers are connected; false after `timeout` seconds."""
        return self.node.reactor.run_until(lambda: self.publisher_count >= count, timeout, user=False)

    def take(self, timeout: float | None = None) -> Any:
        """The oldest message kept; spins for at most `timeout` seconds until there is one (None: for ever). None where
        there was none in time, or the node was closed. Raises TypeError on a subscription with a callback."""
        if self._callback is not None:
            raise TypeError(f"the subscription of {self.topic} has a callback; it keeps no messages to take")
        if not self._queue:
            self.node.reactor.run_until(lambda: self._queue or self.closed, timeout)
        return self._queue.popleft() if self._queue else None

    def __aiter__(self) -> AsyncIterator[Any]:
        return self._iterate()

    async def _iterate(self) -> AsyncIterator[Any]:
        import asyncio

        from roslet.io.asyncio import attach

        loop = asyncio.get_running_loop()
        attach(self.node.reactor, loop)
        while not self.closed:
            while self._queue:
                yield self._queue.popleft()
            waiter: asyncio.Future[None] = loop.create_future()

            def wake(waiter: asyncio.Future[None] = waiter) -> None:
                loop.call_soon_threadsafe(lambda: None if waiter.done() else waiter.set_result(None))

            self._waiters.append(wake)
            if not self._queue and not self.closed:
                await waiter

    def close(self) -> None:
        """Unsubscribe. Closing twice is allowed."""
        if not self.closed:
            self.closed = True
            self._disconnect()
            self._wake_waiters()

    def _disconnect(self) -> None:
        """Tell the network that nobody listens any more."""
        raise NotImplementedError

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
