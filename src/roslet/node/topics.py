"""Publishers and subscriptions of the ROS 1 network."""

from __future__ import annotations

import select
import socket
import threading
from collections import deque
from struct import pack_into
from time import monotonic

from roslet.engine.ros1.links import PublisherLink
from roslet.engine.ros1.udp import UdpSender
from roslet.errors import NodeClosed, ProtocolError
from roslet.io.memory import LARGE, keep_large_blocks
from roslet.wire.message import BufferTooSmall

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable
    from typing import Any

    from roslet.engine.ros1.graph import Publication
    from roslet.engine.ros1.graph import Subscription as Entry
    from roslet.node.node import Node
    from roslet.node.qos import QoS
    from roslet.wire.message import Message

# The first size of a publisher's buffer; it grows to what its messages need.
FIRST_BUFFER = 1024
# With `keep_all`, how long publishing waits for one subscriber that takes nothing. Seconds.
MAX_BLOCKING = 10.0
# A large message overfills a socket whose reader is busy reading it. Seconds to wait for room, each time, before the
# rest is queued for the loop: handing over costs more. A reader that takes nothing costs this once, as its queue is
# filled without trying from then on.
PATIENCE = 0.001
# A reader that takes a large message more slowly than this, in bytes a second, must not slow the others down: its rest is
# queued.
PACE = 200e6
# A UDPROS subscriber does not say when it is ready; what comes before the answer to its request is lost. Seconds from that
# answer to the latched message.
UDP_LATCH_DELAY = 0.1
# With `keep_all`, most messages that a subscription keeps for `take()`, or that one of this node's own still has to get.
MAX_KEPT = 100_000
# sendmsg takes at most this many buffers (IOV_MAX).
MAX_GATHER = 1024


class RawMessage:
    """A message that was not deserialised, as a subscription of type "*" gets it.

    `data` are its bytes, `type`, `md5sum` and `definition` what the publisher said of it.
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
        self._has_header = bool(getattr(message_type, "_has_header", False))
        self._dropped = 0  # of a closed publisher
        self._latched: bytes | None = None
        self._latch = qos.durability == "transient_local"
        self._wait = qos.history == "keep_all"
        self._local: tuple[Subscription, ...] = ()
        self._latched_local: Message | None = None
        self._on_connect: list[Callable[[str], None]] = []
        self._on_disconnect: list[Callable[[str], None]] = []
        self._entry: Publication | None = node._advertise(self)

    @property
    def subscriber_count(self) -> int:
        """Subscribers connected now: over TCPROS and UDPROS, and those of this node."""
        entry = self._entry
        return 0 if entry is None else len(entry.links) + len(entry.senders) + len(self._local)

    @property
    def statistics(self) -> dict[str, int]:
        """Since the publisher was made: `messages` published, `dropped` (messages for slow or lost subscribers, one count
        for each subscriber); now: `subscribers`."""
        entry = self._entry
        dropped = (
            self._dropped
            if entry is None
            else entry.dropped + sum(link.queue.dropped for link in entry.links)
        )
        return {"messages": self.messages, "dropped": dropped, "subscribers": self.subscriber_count}

    def publish(self, message: Any = None, /, **fields: Any) -> None:
        """Send a message: a message of this type, or its fields as keywords.

        Raises InvalidMessage with the value path where a value does not fit its field, TypeError for a message of
        another type, NodeClosed. With history "keep_all" it waits while a subscriber takes nothing, at most
        MAX_BLOCKING seconds, then drops for that one.
        """
        entry = self._entry
        if entry is None:
            raise NodeClosed(f"the publisher of {self.topic} is closed")
        if message is None:
            message = self.type(**fields)
        elif fields or message.__class__ is not self.type:
            message = self._converted(message, fields)
        with self._lock:
            if self._has_header:
                message.header.seq = self.messages + 1
            links = entry.links
            parts: list[Any] | None = None if self._latch or entry.senders else []
            try:
                end = message.serialize_into(self._view, 4, parts)
            except BufferTooSmall as error:
                self._grow(4 + error.size)
                if parts:
                    parts = []
                end = message.serialize_into(self._view, 4, parts)
            self.messages += 1
            if parts:
                self._send_parts(links, parts, end)
            else:
                pack_into("<I", self._view, 0, end - 4)
                frame = self._view[:end]
                for link in links:
                    # The usual case first: nothing waits, so try the socket at once.
                    if link.queue.bytes == 0:
                        try:
                            sent = link.channel.sock.send(frame)
                        except OSError as error:
                            sent = link.channel._send_failed(error)
                        if sent == end:
                            link.messages += 1
                            link.bytes += end - 4
                            continue
                        self._later(link, frame, sent)
                    else:
                        self._queue(link, bytes(frame))
                if self._latch:
                    self._latched = bytes(frame)
                for sender in entry.senders:
                    self._send_datagrams(sender, frame)
        if self._local or self._latch:
            self._deliver_locally(message)

    def _converted(self, message: Any, fields: dict[str, Any]) -> Message:
        if fields:
            raise TypeError(f"{self.topic}: publish a message or fields, not both")
        return self.convert(message)

    def convert(self, message: Any) -> Message:
        """A message of this type from a dict, or from an equal message class. Raises TypeError."""
        if isinstance(message, dict):
            return self.type(**message)
        if isinstance(message, self.type):
            return message
        if getattr(message, "_md5sum", None) == getattr(self.type, "_md5sum", "") and hasattr(
            message, "serialize"
        ):
            converted: Message = self.type.deserialize(message.serialize())
            return converted
        given = getattr(message, "_type", type(message).__name__)
        raise TypeError(f"{self.topic} carries {self.type._type}, not {given}")

    def _grow(self, size: int) -> None:
        self._view.release()
        self._buffer = bytearray(max(size, 2 * len(self._buffer)))
        self._view = memoryview(self._buffer)

    def _send_parts(self, links: tuple[PublisherLink, ...], parts: list[Any], end: int) -> None:
        """Send the scratch buffer with large arrays between, without copying those."""
        keep_large_blocks()
        buffers: list[Any] = []
        at = 0
        total = end
        for position, data in parts:
            if position > at:
                buffers.append(self._view[at:position])
            buffers.append(data)
            total += len(data) if type(data) is bytes else memoryview(data).nbytes
            at = position
        if end > at:
            buffers.append(self._view[at:end])
        pack_into("<I", self._view, 0, total - 4)
        frame: bytes | None = None
        for link in links:
            if link.queue.bytes == 0 and len(buffers) <= MAX_GATHER:
                sent = link.channel.try_send_many(buffers)
                if sent == total:
                    link.messages += 1
                    link.bytes += total - 4
                    continue
                if self._wait:
                    self._send_rest(link, buffers, sent, total)
                    continue
                frame = frame or b"".join(buffers)
                self._later(link, memoryview(frame), sent)
            else:
                frame = frame or b"".join(buffers)
                self._queue(link, frame)

    def _later(self, link: PublisherLink, frame: memoryview, sent: int) -> None:
        """The socket took `sent` bytes of the frame: wait a moment for a reader that keeps up, then keep the rest."""
        if self._wait:
            self._send_rest(link, [frame], sent, len(frame))
            return
        channel = link.channel
        if sent:
            end = monotonic() + PATIENCE + len(frame) / PACE
            while not channel.broken and wait_writable(channel.sock, min(PATIENCE, end - monotonic())):
                sent += channel.try_send(frame[sent:])
                if sent == len(frame):
                    link.messages += 1
                    link.bytes += len(frame) - 4
                    return
            link.queue.push_rest(bytes(frame[sent:]))
        elif link.queue.push(bytes(frame)):
            self.node._count("send-queue-full")
        link.messages += 1
        link.bytes += len(frame) - 4
        channel.want_write()

    def _queue(self, link: PublisherLink, frame: bytes) -> None:
        if self._wait and not self._drain(link):
            link.queue.dropped += 1
            self.node._count("blocked-too-long")
            return
        if link.queue.push(frame):
            self.node._count("send-queue-full")
        link.messages += 1
        link.bytes += len(frame) - 4
        link.channel.want_write()

    def _send_rest(self, link: PublisherLink, buffers: list[Any], sent: int, total: int) -> None:
        """Block until the frame is out ("keep_all"), then go on."""
        channel = link.channel
        views = [memoryview(buffer).cast("B") for buffer in buffers]
        end = monotonic() + MAX_BLOCKING
        done = sent
        while True:
            while views and sent >= len(views[0]):
                sent -= len(views[0])
                del views[0]
            if not views:
                link.messages += 1
                link.bytes += total - 4
                return
            views[0] = views[0][sent:]
            sent = 0
            if channel.broken or not wait_writable(channel.sock, end - monotonic()):
                break
            sent = channel.try_send_many(views[:MAX_GATHER])
            done += sent
        if done:
            # A frame that has begun must end, or the stream is lost: its rest goes out when there is room.
            link.queue.push_rest(b"".join(views))
            link.messages += 1
            link.bytes += total - 4
            channel.want_write()
        elif not channel.broken:
            link.queue.dropped += 1
            self.node._count("blocked-too-long")

    def _drain(self, link: PublisherLink) -> bool:
        """Block until what is queued is out; false where the subscriber took too long."""
        channel = link.channel
        end = monotonic() + MAX_BLOCKING
        queue = link.queue
        while queue.bytes and not channel.broken and wait_writable(channel.sock, end - monotonic()):
            queue.sent(channel.try_send_many(queue.peek()))
        return not queue.bytes

    def _send_datagrams(self, sender: UdpSender, frame: memoryview) -> None:
        try:
            datagrams = sender.datagrams(frame)
        except ProtocolError as error:
            self.node._count(error.reason)
            return
        for datagram in datagrams:
            if not self.node._send_datagram(datagram, sender.address):
                self.node._count("udp-not-sent")

    def _link_changed(self, link: Any, opened: bool) -> None:
        if opened and self._latched is not None:
            if isinstance(link, PublisherLink):
                link.queue.push(self._latched)  # whoever opens such a link holds our lock
                link.channel.want_write()
            else:
                reactor = self.node.reactor
                reactor.call_at(reactor.now() + UDP_LATCH_DELAY, lambda: self._send_latched(link))
        for function in self._on_connect if opened else self._on_disconnect:
            self.node._call_back(function, link.callerid)

    def _send_latched(self, sender: UdpSender) -> None:
        with self._lock:
            if self._latched is not None and not sender.messages and not sender.closing:
                self._send_datagrams(sender, memoryview(self._latched))

    def on_connect(self, function: Callable[[str], None]) -> None:
        """Call `function(name of the subscriber)` inside spin when a subscriber connects."""
        self._on_connect.append(function)

    def on_disconnect(self, function: Callable[[str], None]) -> None:
        """Call `function(name of the subscriber)` inside spin when a subscriber goes."""
        self._on_disconnect.append(function)

    # -- within this node, nothing is serialised for its own subscriptions

    def _deliver_locally(self, message: Message) -> None:
        for subscription in self._local:
            subscription._receive_local(self._for_local(subscription, message))
        if self._latch:
            self._latched_local = message.copy()

    def _attach(self, subscription: Subscription) -> None:
        self._local = (*self._local, subscription)
        if self._latched_local is not None:
            subscription._receive_local(self._for_local(subscription, self._latched_local))

    def _for_local(self, subscription: Subscription, message: Message) -> Any:
        """A message of its own for one of this node's subscriptions."""
        if subscription.type is None:
            return RawMessage(message.serialize(), self.type._type, self.type._md5sum, self.type._full_text)
        return message.copy()

    def _detach(self, subscription: Subscription) -> None:
        self._local = tuple(other for other in self._local if other is not subscription)

    def wait_for_subscribers(self, count: int = 1, timeout: float | None = None) -> bool:
        """Serve until at least `count` subscribers are connected; false after `timeout` seconds."""
        return self.node.reactor.run_until(lambda: self.subscriber_count >= count, timeout, user=False)

    def close(self) -> None:
        """Unregister and disconnect every subscriber. Closing twice is allowed."""
        self._dropped = self.statistics["dropped"]
        entry, self._entry = self._entry, None
        if entry is not None:
            self.node._unadvertise(self, entry)

    def __enter__(self) -> Publisher:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


def wait_writable(sock: socket.socket, timeout: float) -> bool:
    """Whether the socket took room within `timeout` seconds; false also when it was closed."""
    if timeout <= 0 or sock.fileno() < 0:
        return False
    poller = select.poll()
    poller.register(sock, select.POLLOUT)
    return bool(poller.poll(timeout * 1000))


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
        callback: Callable[[Any], object] | None,
        qos: QoS,
        max_frame: int,
        with_link: bool = False,
    ) -> None:
        self.node = node
        self.topic = topic
        self.type = message_type
        self.qos = qos
        self.messages = 0
        self.malformed = 0
        self.dropped = 0
        self._callback: Callable[..., object] | None = callback
        self._queue: deque[Any] = deque()
        self._waiters: list[Callable[[], None]] = []
        self._local: deque[Any] = deque()  # from this node's own publisher
        self._local_due = False  # whether the loop has been asked to deliver them
        self._with_link = (
            with_link  # the callback gets (message, link); the link is None for one of this node
        )
        self._publisher: Publisher | None = None
        self._on_connect: list[Callable[[str], None]] = []
        self._on_disconnect: list[Callable[[str], None]] = []
        self._entry: Entry | None = node._subscribe(self, self._make_sink(), max_frame)

    def _make_sink(self) -> Callable[[memoryview, int, int, Any], None]:
        decode = self.type.deserialize_from if self.type is not None else None
        report = self.node.reactor.report

        def sink(view: memoryview, start: int, end: int, link: Any) -> None:
            if decode is None:
                message: Any = self._raw(view, start, end, link)
            else:
                try:
                    message = decode(view, start, end)
                except (
                    Exception
                ) as error:  # a peer's bytes must not come out of spin, whatever they do to the decoder
                    self._reject(error, link)
                    return
            self.messages += 1
            if end > LARGE:
                keep_large_blocks()
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
                report(error)

        return sink

    def _raw(self, view: memoryview, start: int, end: int, link: Any) -> RawMessage:
        header = getattr(link, "peer_header", {})
        return RawMessage(
            bytes(view[start:end]),
            header.get("type", "*"),
            header.get("md5sum", "*"),
            header.get("message_definition", ""),
        )

    def _reject(self, error: Exception, link: Any) -> None:
        self.malformed += 1
        self.node._count("malformed-message")
        if self.malformed == 1:
            self.node.log.error(
                f"{self.topic}: a message from {getattr(link, 'uri', 'a publisher')} is malformed: {error}"
            )

    def _receive_local(self, message: Message) -> None:
        """Any thread may be here."""
        self._append(self._local, message)
        if not self._local_due:
            self._local_due = True
            self.node.reactor.call_soon(self._deliver_local, user=True)

    def _deliver_local(self) -> None:
        self._local_due = False
        for _ in range(len(self._local)):
            if self._entry is None or not self._local:
                return
            message = self._local.popleft()
            self.messages += 1
            callback = self._callback
            if callback is None:
                self._keep(message)
                continue
            try:
                if self._with_link:
                    callback(message, None)
                else:
                    callback(message)
            except Exception as error:
                self.node.reactor.report(error)

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
        waiters, self._waiters = self._waiters, []
        for wake in waiters:
            wake()

    def _link_changed(self, link: Any, opened: bool) -> None:
        who = getattr(link, "peer_header", {}).get("callerid", getattr(link, "uri", ""))
        for function in self._on_connect if opened else self._on_disconnect:
            self.node._call_back(function, who)

    def on_connect(self, function: Callable[[str], None]) -> None:
        """Call `function(name of the publisher)` inside spin when a publisher is connected."""
        self._on_connect.append(function)

    def on_disconnect(self, function: Callable[[str], None]) -> None:
        """Call `function(name of the publisher)` inside spin when a publisher goes."""
        self._on_disconnect.append(function)

    @property
    def publisher_count(self) -> int:
        """Publishers connected now, this node's own included."""
        entry = self._entry
        if entry is None:
            return 0
        return sum(1 for link in entry.links.values() if link.state == 2) + (
            1 if self._publisher is not None else 0
        )

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

    def wait_for_publishers(self, count: int = 1, timeout: float | None = None) -> bool:
        """Serve until at least `count` publishers are connected; false after `timeout` seconds."""
        return self.node.reactor.run_until(lambda: self.publisher_count >= count, timeout, user=False)

    def take(self, timeout: float | None = None) -> Any:
        """The oldest message kept; spins for at most `timeout` seconds until there is one (None: for ever). None where
        there was none in time, or the node was closed. Raises TypeError on a subscription with a callback."""
        if self._callback is not None:
            raise TypeError(f"the subscription of {self.topic} has a callback; it keeps no messages to take")
        if not self._queue:
            self.node.reactor.run_until(lambda: self._queue or self._entry is None, timeout)
        return self._queue.popleft() if self._queue else None

    def __aiter__(self) -> AsyncIterator[Any]:
        return self._iterate()

    async def _iterate(self) -> AsyncIterator[Any]:
        import asyncio

        from roslet.io.asyncio import attach

        loop = asyncio.get_running_loop()
        attach(self.node.reactor, loop)
        while self._entry is not None:
            while self._queue:
                yield self._queue.popleft()
            waiter: asyncio.Future[None] = loop.create_future()

            def wake(waiter: asyncio.Future[None] = waiter) -> None:
                loop.call_soon_threadsafe(lambda: None if waiter.done() else waiter.set_result(None))

            self._waiters.append(wake)
            if not self._queue and self._entry is not None:
                await waiter

    def close(self) -> None:
        """Unsubscribe. Closing twice is allowed."""
        entry, self._entry = self._entry, None
        if entry is not None:
            self.node._unsubscribe(self, entry)
            waiters, self._waiters = self._waiters, []
            for wake in waiters:
                wake()

    def __enter__(self) -> Subscription:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
