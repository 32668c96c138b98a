"""Publishers and subscriptions of the ROS 2 network.

Between a publisher and a subscription of one process a message is copied, not serialised; to all others it goes by RTPS.
"""

from __future__ import annotations

from collections import deque
from time import monotonic

from roslet.engine.rtps import events as facts
from roslet.engine.rtps.qos import incompatible
from roslet.errors import NodeClosed
from roslet.io.memory import LARGE, keep_large_blocks
from roslet.node import events
from roslet.node.ros2.qos import to_dds
from roslet.node.topics import MAX_BLOCKING, MAX_KEPT, Publisher, RawMessage, Subscription
from roslet.wire.message import BufferTooSmall
from roslet.wire.rtps.data import FLAG_D

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.reader import Reader, WriterProxy
    from roslet.engine.rtps.writer import Writer
    from roslet.node.node import Node
    from roslet.node.qos import QoS
    from roslet.node.ros2.network import Ros2Network
    from roslet.wire.message import Message
    from roslet.wire.rtps.data import Data
    from roslet.wire.rtps.endpoint_data import EndpointData

# A sample that is longer has come in fragments, and is in memory of its own; others lie in the datagram's buffer.
DATAGRAM = 65536
# Seconds that a message without a lifespan is good for.
FOREVER = float("inf")
# Bytes that a publisher's own buffer grows to; a larger message is gathered into a buffer of its own, which the writer
# keeps without a further copy.
MAX_BUFFER = 60_000
# Events of a publisher or subscription that nobody listens to yet; older ones are forgotten.
MAX_EARLY = 100


class MessageInfo:
    """Where a message came from: times in nanoseconds of the Unix epoch (`source_timestamp` None where the publisher told
    none), `publisher_gid` 16 octets, `sequence_number` the publisher's."""

    __slots__ = ("publisher_gid", "received_timestamp", "sequence_number", "source_timestamp")

    def __init__(
        self,
        source_timestamp: int | None,
        received_timestamp: int,
        publisher_gid: bytes,
        sequence_number: int,
    ) -> None:
        self.source_timestamp = source_timestamp
        self.received_timestamp = received_timestamp
        self.publisher_gid = publisher_gid
        self.sequence_number = sequence_number


class _Endpoint:
    """What publishers and subscriptions have in common: events."""

    topic: str
    node: Node
    _network: Ros2Network
    _listeners: list[Callable[[events.Event], object]]
    _early: deque[events.Event]
    _before: deque[str]
    _on_connect: list[Callable[[str], None]]
    _on_disconnect: list[Callable[[str], None]]

    def on_event(self, function: Callable[[events.Event], object]) -> None:
        """Call `function(event)` inside spin for what `roslet.node.events` has: matches, incompatible QoS and the like.

        The first function is also told what came before it, the last MAX_EARLY: a peer that was there first matches, or
        does not, while the publisher or subscription is being made.
        """
        with self._network.reactor.lock:
            self._listeners.append(function)
            while self._early:
                self.node._call_back(function, self._early.popleft())

    def _tell(self, event: events.Event) -> None:
        """With the reactor's lock held."""
        if not self._listeners:
            self._early.append(event)
        for function in self._listeners:
            self.node._call_back(function, event)

    def _peer(self, data: EndpointData) -> tuple[str, bytes]:
        return self._network.node_of(data.guid), data.guid

    def _matched(self, peer: str, gid: bytes, matched: bool) -> None:
        self._tell((events.Matched if matched else events.Unmatched)(peer, gid))
        if matched and not self._on_connect:
            self._before.append(peer)
        for function in self._on_connect if matched else self._on_disconnect:
            self.node._call_back(function, peer)

    def on_connect(self, function: Callable[[str], None]) -> None:
        """Call `function(name of the peer's node)` inside spin when a peer is matched; the first function is also called for
        those that were there before it."""
        self._on_connect.append(function)
        while self._before:
            self.node._call_back(function, self._before.popleft())

    def _incompatible(self, peer: str, gid: bytes, policies: tuple[str, ...], offers: bool) -> None:
        what = "requests more than this publisher offers" if offers else "offers less than is requested here"
        self.node._note(
            f"{self.topic}: no messages between {self.node.name} and {peer or 'a peer'}, which {what}: "
            f"QoS {', '.join(policies)}"
        )
        self._tell(events.QosIncompatible(peer, gid, policies))

    def _happened(self, fact: Any) -> None:
        """An event of the engine, in the loop."""
        kind = type(fact)
        if kind is facts.EndpointMatched or kind is facts.EndpointUnmatched:
            self._matched(*self._peer(fact.data), kind is facts.EndpointMatched)
        elif kind is facts.QosIncompatible:
            self._incompatible(*self._peer(fact.data), fact.policies, isinstance(self, Publisher))
        elif kind is facts.DeadlineMissed:
            self._tell(events.DeadlineMissed())
        elif kind is facts.LivelinessLost or kind is facts.LivelinessRegained:
            made = events.LivelinessLost if kind is facts.LivelinessLost else events.LivelinessRegained
            self._tell(made(self._network.node_of(fact.writer), fact.writer))
        elif kind is facts.SamplesLost:
            self.node._count("messages-lost")
            self._tell(events.MessagesLost(self._network.node_of(fact.writer), fact.writer, fact.count))


class Ros2Publisher(_Endpoint, Publisher):
    """A publisher of one topic; a node may have several of the same.

    A message that only subscriptions of this process get is copied, not serialised, and so its values are not checked.
    """

    def __init__(
        self, network: Ros2Network, node: Node, topic: str, message_type: type[Message], qos: QoS
    ) -> None:
        super().__init__(node, topic, message_type, qos)
        self._network = network
        self._listeners = []
        self._early = deque(maxlen=MAX_EARLY)
        self._before = deque(maxlen=MAX_EARLY)
        self._dropped = 0
        self._policies = to_dds(qos)
        # For local subscriptions that come late.
        self._kept: deque[tuple[Message, float]] | None = deque(
            maxlen=qos.depth if not self._wait else MAX_KEPT
        )
        if not self._latch:
            self._kept = None
        # Whether a message that nobody outside gets need not be known to the writer: it counts for deadline and liveliness.
        self._here = not self._latch and qos.deadline is None and qos.liveliness == "automatic"
        self._shell = network.shell
        self._writer: Writer | None = network.create_writer(self)

    @property
    def gid(self) -> bytes:
        """The 16 octets that name this publisher in the graph. Raises NodeClosed."""
        return self._open().data.guid

    def _open(self) -> Writer:
        if self._writer is None:
            raise NodeClosed(f"the publisher of {self.topic} is closed")
        return self._writer

    @property
    def subscriber_count(self) -> int:
        """Subscriptions matched now, those of this process included."""
        writer = self._writer
        return 0 if writer is None else len(writer.proxies) + len(self._local)

    @property
    def statistics(self) -> dict[str, int]:
        return {"messages": self.messages, "dropped": self._dropped, "subscribers": self.subscriber_count}

    def publish(self, message: Any = None, /, **fields: Any) -> None:
        writer = self._writer
        if writer is None:
            raise NodeClosed(f"the publisher of {self.topic} is closed")
        if message is None:
            message = self.type(**fields)
        elif fields or message.__class__ is not self.type:
            message = self._converted(message, fields)
        if self._here and self._local and not writer.proxies:
            self.messages += 1
            self._deliver_locally(message)
            return
        with self._lock:
            try:
                payload: Any = self._view[: message.serialize_into(self._view, 0)]
            except BufferTooSmall as error:
                if error.size > MAX_BUFFER:
                    keep_large_blocks()
                    payload = message.serialize()
                else:
                    self._grow(error.size)
                    payload = self._view[: message.serialize_into(self._view, 0)]
            self._send(writer, payload)
        if self._local or self._kept is not None:
            self._deliver_locally(message)

    def publish_serialized(self, data: bytes | bytearray | memoryview) -> None:
        """Send a message that is serialised already, encapsulation header first. Nothing is checked."""
        writer = self._open()
        with self._lock:
            self._send(writer, bytes(data))
        if self._local or self._kept is not None:
            self._deliver_locally(self.type.deserialize(bytes(data)))

    def _send(self, writer: Writer, payload: Any) -> None:
        shell = self._shell
        if self._wait and writer.full(len(payload)) and not self._wait_for_room(writer, len(payload)):
            self._dropped += 1
            self.node._count("blocked-too-long")
            return
        with shell.reactor.lock:
            now = monotonic()
            writer.write(payload, now)
            shell.domain.send(now)
        self.messages += 1

    def _wait_for_room(self, writer: Writer, size: int) -> bool:
        return self._shell.reactor.run_until(lambda: not writer.full(size), MAX_BLOCKING, user=False)

    def assert_liveliness(self) -> None:
        """Say that this publisher is alive although it has nothing to publish; for liveliness "manual_by_topic"."""
        writer = self._open()
        with self._shell.reactor.lock:
            writer.assert_liveliness(self._network.reactor.now())
            self._shell.flush()

    def _flushed(self) -> bool:
        writer = self._writer
        return writer is None or writer.acknowledged(writer.last)

    # -- within this process

    def _deliver_locally(self, message: Message) -> None:
        for subscription in self._local:
            self._deliver_to(subscription, message)
        if self._kept is not None:
            self._kept.append((message.copy(), monotonic() + (self.qos.lifespan or FOREVER)))

    def _deliver_to(self, subscription: Subscription, message: Message) -> None:
        if isinstance(subscription, Ros2Subscription):
            subscription._note_sample()
        subscription._deliver_later(self._for_local(subscription, message), self._local_link())

    def _local_link(self) -> Any:
        """What a subscription of this process is told of where a message came from."""
        return None

    def _happened(self, fact: Any) -> None:
        super()._happened(fact)
        if type(fact) is facts.LivelinessLost or type(fact) is facts.LivelinessRegained:
            subscription: Any
            for subscription in self._local:
                subscription._happened(fact)

    def _attach(self, subscription: Subscription) -> None:
        super()._attach(subscription)
        if self._kept is not None and subscription.qos.durability == "transient_local":
            now = monotonic()
            for message, until in self._kept:
                if now < until:
                    self._deliver_to(subscription, message)

    @staticmethod
    def _for_local(subscription: Subscription, message: Message) -> Any:
        if subscription.type is None:
            return RawMessage(message.serialize(), message._type, message._type_hash, "")
        return message.copy()

    def close(self) -> None:
        writer, self._writer = self._writer, None
        if writer is not None:
            self._network.delete_publisher(self, writer)


class Ros2Subscription(_Endpoint, Subscription):
    """A subscription of one topic. Messages that arrive while nobody spins wait, at most `qos.depth` of them."""

    def __init__(
        self,
        network: Ros2Network,
        node: Node,
        topic: str,
        message_type: type[Message] | None,
        type_name: str,
        callback: Callable[..., object] | None,
        qos: QoS,
        max_message: int,
        with_link: bool = False,
    ) -> None:
        super().__init__(node, topic, message_type, callback, qos, with_link)
        self.type_name = type_name
        self._network = network
        self._listeners = []
        self._early = deque(maxlen=MAX_EARLY)
        self._before = deque(maxlen=MAX_EARLY)
        self._policies = to_dds(qos)
        self._max_message = max_message
        self._background = False
        self._sources: tuple[Ros2Publisher, ...] = ()  # of this process
        self._reader: Reader | None = network.create_reader(self, self._sample)

    @property
    def gid(self) -> bytes:
        """The 16 octets that name this subscription in the graph. Raises NodeClosed."""
        if self._reader is None:
            raise NodeClosed(f"the subscription of {self.topic} is closed")
        return self._reader.data.guid

    def _sample(self, proxy: WriterProxy, value: Data, time: int | None) -> None:
        """In the loop, with the lock held, whoever runs it."""
        if not value.flags & FLAG_D:
            return
        payload: Any = value.payload
        size = len(payload)
        if size > self._max_message:
            self.node._count("message-too-large")
            return
        if size <= DATAGRAM:
            payload = bytearray(payload)  # the datagram's buffer is not ours
        elif size > LARGE:
            keep_large_blocks()
        self._deliver_later(payload, (proxy.guid, value.sequence, time, self._network.now()))

    def _note_sample(self) -> None:
        """A message of this process has come: for the deadline, which the reader keeps."""
        if self.qos.deadline is not None and self._reader is not None:
            with self._network.reactor.lock:
                self._reader.note_sample(self._network.reactor.now())
                self._network.shell.flush()

    def in_loop(self, callback: Callable[[Any], object]) -> None:
        """Call `callback` in the loop whoever runs it, with the reactor's lock held: it must be quick and of ours."""
        self._callback = callback
        self._background = True

    def _deliver_later(self, message: Any, link: Any = None) -> None:
        if self._background:
            self._deliver(message, link)
        else:
            super()._deliver_later(message, link)

    def _deliver(self, message: Any, link: Any) -> None:
        if type(link) is tuple:  # from the network, not yet deserialised
            view = memoryview(message)
            gid, sequence, sent, received = link
            if self.type is None:
                message = RawMessage(bytes(view), self.type_name, self._network.graph.hash_of(gid), "")
            else:
                try:
                    message = self.type.deserialize_from(view, 0, len(view))
                except (
                    Exception
                ) as error:  # a peer's bytes must not come out of spin, whatever they do to the decoder
                    self._reject(error, self._network.node_of(gid) or "a publisher")
                    return
            link = MessageInfo(sent, received, gid, sequence) if self._with_link else None
        super()._deliver(message, link)

    @property
    def publisher_count(self) -> int:
        """Publishers matched now, those of this process included."""
        reader = self._reader
        return 0 if reader is None else len(reader.proxies) + len(self._sources)

    def _disconnect(self) -> None:
        reader, self._reader = self._reader, None
        if reader is not None:
            self._network.delete_subscription(self, reader)


def pair(publisher: Ros2Publisher, subscription: Ros2Subscription) -> None:
    """Let a publisher and a subscription of one process find each other, as two of different processes would."""
    if publisher.topic != subscription.topic or publisher.type._type != subscription.type_name:
        return
    writer, reader = publisher._writer, subscription._reader
    if writer is None or reader is None:
        return
    policies = incompatible(writer.qos, reader.qos)
    if policies:
        publisher._incompatible(subscription.node.name, reader.data.guid, policies, True)
        subscription._incompatible(publisher.node.name, writer.data.guid, policies, False)
        return
    publisher._attach(subscription)
    subscription._sources = (*subscription._sources, publisher)
    publisher._matched(subscription.node.name, reader.data.guid, True)
    subscription._matched(publisher.node.name, writer.data.guid, True)


def unpair(publisher: Ros2Publisher, subscription: Ros2Subscription) -> None:
    """Undo that, where it was done."""
    if publisher in subscription._sources:
        publisher._detach(subscription)
        subscription._sources = tuple(one for one in subscription._sources if one is not publisher)
        publisher._matched(subscription.node.name, b"", False)
        subscription._matched(publisher.node.name, b"", False)
