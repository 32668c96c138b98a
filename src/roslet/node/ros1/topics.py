"""Publishers and subscriptions of the ROS 1 network: TCPROS and UDPROS."""

from __future__ import annotations

import select
import socket
from struct import pack_into
from time import monotonic

from roslet.engine.ros1.links import PublisherLink
from roslet.engine.ros1.udp import UdpSender
from roslet.errors import NodeClosed, ProtocolError
from roslet.io.memory import LARGE, keep_large_blocks
from roslet.node.topics import MAX_BLOCKING, Publisher, RawMessage, Subscription
from roslet.wire.message import BufferTooSmall

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.ros1.graph import Publication
    from roslet.engine.ros1.graph import Subscription as Entry
    from roslet.node.node import Node
    from roslet.node.qos import QoS
    from roslet.node.ros1.network import Ros1Network
    from roslet.wire.message import Message

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
# sendmsg takes at most this many buffers (IOV_MAX).
MAX_GATHER = 1024


class Ros1Publisher(Publisher):
    """A publisher of one topic in a node: a node is registered as its publisher once."""

    def __init__(
        self, network: Ros1Network, node: Node, topic: str, message_type: type[Message], qos: QoS
    ) -> None:
        super().__init__(node, topic, message_type, qos)
        self._network = network
        self._has_header = bool(getattr(message_type, "_has_header", False))
        self._dropped = 0  # of a closed publisher
        self._latched: bytes | None = None
        self._latched_local: Message | None = None
        self._entry: Publication | None = network.advertise(self)

    @property
    def subscriber_count(self) -> int:
        """Subscribers connected now: over TCPROS and UDPROS, and those of this node."""
        entry = self._entry
        return 0 if entry is None else len(entry.links) + len(entry.senders) + len(self._local)

    @property
    def statistics(self) -> dict[str, int]:
        entry = self._entry
        dropped = (
            self._dropped
            if entry is None
            else entry.dropped + sum(link.queue.dropped for link in entry.links)
        )
        return {"messages": self.messages, "dropped": dropped, "subscribers": self.subscriber_count}

    def publish(self, message: Any = None, /, **fields: Any) -> None:
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
            if not self._network.send_datagram(datagram, sender.address):
                self.node._count("udp-not-sent")

    def _flushed(self) -> bool:
        entry = self._entry
        return entry is None or not any(link.queue.bytes for link in entry.links)

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

    # -- within this node, nothing is serialised for its own subscriptions

    def _deliver_locally(self, message: Message) -> None:
        for subscription in self._local:
            subscription._deliver_later(self._for_local(subscription, message))
        if self._latch:
            self._latched_local = message.copy()

    def _attach(self, subscription: Subscription) -> None:
        super()._attach(subscription)
        if self._latched_local is not None:
            subscription._deliver_later(self._for_local(subscription, self._latched_local))

    def _for_local(self, subscription: Subscription, message: Message) -> Any:
        """A message of its own for one of this node's subscriptions."""
        if subscription.type is None:
            return RawMessage(message.serialize(), self.type._type, self.type._md5sum, self.type._full_text)
        return message.copy()

    def close(self) -> None:
        self._dropped = self.statistics["dropped"]
        entry, self._entry = self._entry, None
        if entry is not None:
            self._network.unadvertise(self, entry)


def wait_writable(sock: socket.socket, timeout: float) -> bool:
    """Whether the socket took room within `timeout` seconds; false also when it was closed."""
    if timeout <= 0 or sock.fileno() < 0:
        return False
    poller = select.poll()
    poller.register(sock, select.POLLOUT)
    return bool(poller.poll(timeout * 1000))


class Ros1Subscription(Subscription):
    """A subscription of one topic. The links that its callback may get are those of the engine."""

    def __init__(
        self,
        network: Ros1Network,
        node: Node,
        topic: str,
        message_type: type[Message] | None,
        callback: Callable[..., object] | None,
        qos: QoS,
        max_message: int,
        with_link: bool = False,
    ) -> None:
        super().__init__(node, topic, message_type, callback, qos, with_link)
        self._network = network
        self._publisher: Ros1Publisher | None = None  # this node's own
        self._entry: Entry | None = network.subscribe(self, self._make_sink(), max_message)

    def _make_sink(self) -> Callable[[memoryview, int, int, Any], None]:
        decode = self.type.deserialize_from if self.type is not None else None
        deliver = self._deliver

        def sink(view: memoryview, start: int, end: int, link: Any) -> None:
            if decode is None:
                message: Any = raw(view, start, end, link)
            else:
                try:
                    message = decode(view, start, end)
                except (
                    Exception
                ) as error:  # a peer's bytes must not come out of spin, whatever they do to the decoder
                    self._reject(error, getattr(link, "uri", "a publisher"))
                    return
            if end > LARGE:
                keep_large_blocks()
            deliver(message, link)

        return sink

    def _link_changed(self, link: Any, opened: bool) -> None:
        who = getattr(link, "peer_header", {}).get("callerid", getattr(link, "uri", ""))
        for function in self._on_connect if opened else self._on_disconnect:
            self.node._call_back(function, who)

    @property
    def publisher_count(self) -> int:
        """Publishers connected now, this node's own included."""
        entry = self._entry
        if entry is None:
            return 0
        return sum(1 for link in entry.links.values() if link.state == 2) + (
            1 if self._publisher is not None else 0
        )

    def _disconnect(self) -> None:
        entry, self._entry = self._entry, None
        if entry is not None:
            self._network.unsubscribe(self, entry)


def raw(view: memoryview, start: int, end: int, link: Any) -> RawMessage:
    """A message as it came, with what the link's peer says of it."""
    header = getattr(link, "peer_header", {})
    return RawMessage(
        bytes(view[start:end]),
        header.get("type", "*"),
        header.get("md5sum", "*"),
        header.get("message_definition", ""),
    )
