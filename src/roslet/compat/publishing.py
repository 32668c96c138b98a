"""What a program's publishers of one topic share: roslet's publisher, and who wants to hear of subscribers."""

from __future__ import annotations

from struct import pack
from typing import TYPE_CHECKING, Any

from roslet.compat.callbacks import Worker
from roslet.compat.rospy import core
from roslet.compat.rospy.exceptions import ROSException, ROSSerializationException
from roslet.compat.rospy.msg import AnyMsg
from roslet.compat.session import session
from roslet.engine.ros1.links import PublisherLink
from roslet.errors import InvalidMessage, NodeClosed
from roslet.node import QoS
from roslet.node.ros1.topics import Ros1Publisher, Ros1Subscription

if TYPE_CHECKING:
    from roslet.node import Node, Subscription

# queue_size=0 asks for a queue without bound. This many messages for one slow subscriber are more than any program means,
# and an end to what it can hold.
UNBOUNDED = 1_000_000

topics: dict[str, PublishedTopic] = {}


class Connection:
    """Who is at the other end: `endpoint_id`, which `callerid_pub` is too, is its node's name."""

    def __init__(self, callerid: str) -> None:
        self.endpoint_id = callerid
        self.callerid_pub = callerid


class PublishedTopic:
    """The publishers of one topic in this program."""

    def __init__(self, name: str, data_class: Any) -> None:
        self.name = name
        self.data_class = data_class
        self.type = getattr(data_class, "_numpy_of", data_class)
        self.listeners: list[Any] = []
        self.latch = False
        self.queue_size: int | None = None
        self.headers: dict[str, str] = {}
        self.users = 0
        self.handle: Ros1Publisher | None = None
        self._events: Worker | None = None
        self._asked = False

    def attach(self) -> None:
        """Register with the master, as soon as there is a node. Further calls have no effect."""
        if not self._asked:
            self._asked = True
            session.when_initialized(self._attach)

    def add(self, latch: bool, queue_size: int | None, headers: dict[str, str] | None, listener: Any) -> None:
        """One more rospy.Publisher of the topic, with its wishes."""
        self.users += 1
        self.latch = self.latch or latch
        self.queue_size = (
            queue_size if self.users == 1 else max(self.queue_size or 0, queue_size or 0) or None
        )
        self.headers.update(headers or {})
        if listener is not None:
            self.listeners.append(listener)
        if self.handle is not None:
            self._configure(self.handle)

    def remove(self) -> None:
        """One less; the last one ends the publication."""
        self.users -= 1
        if self.users:
            return
        if topics.get(self.name) is self:
            del topics[self.name]
        handle = self.handle
        if handle is None:
            return
        if self._events is not None:
            self._events.close()
            peers = [*handle._local, *(() if handle._entry is None else handle._entry.links)]
            for left, peer in zip(reversed(range(len(peers))), peers, strict=True):
                self._tell((peer, False), left)
        if session.node is not None and handle is not session.node.log._publisher:
            handle.close()

    # Programs, actionlib's for example, ask these of rospy's own object in this place.

    def get_num_connections(self) -> int:
        """How many subscribers are connected."""
        return 0 if self.handle is None else self.handle.subscriber_count + self._sets_own_clock

    def has_connections(self) -> bool:
        """Whether any is."""
        return self.get_num_connections() > 0

    def has_connection(self, endpoint_id: str) -> bool:
        """Whether the node of this name is."""
        return any(connection.endpoint_id == endpoint_id for connection in self.connections)

    @property
    def connections(self) -> list[Connection]:
        """The subscribers."""
        handle = self.handle
        if handle is None:
            return []
        links = () if handle._entry is None else handle._entry.links
        return [
            *(Connection(link.callerid) for link in links),
            *(Connection(session.name) for _ in handle._local),
        ]

    @property
    def _sets_own_clock(self) -> bool:
        """Whether this is /clock in a program that itself goes by it, as a simulator does. The node's own subscription
        does not connect to the node."""
        return self.name == "/clock" and not session.wall_time

    def _attach(self, node: Node) -> None:
        if not self.users or session.shutting_down.is_set():
            return
        if self.type is AnyMsg:
            return  # nobody could read it
        size = self.queue_size
        qos = QoS(history="keep_all") if size is None else QoS(depth=size or UNBOUNDED)
        self.handle = node._ros1("rospy").publisher(node.resolve(self.name), self.type, qos)
        self._configure(self.handle)

    def _configure(self, handle: Ros1Publisher) -> None:
        entry = handle._entry
        if entry is None:
            return
        handle._latch = entry.latching = self.latch
        if self.headers:
            plain = type(entry).header
            entry.header = lambda: {**plain(entry), **self.headers}  # type: ignore[method-assign]
        if self.listeners and self._events is None:
            self._events = Worker(f"listeners {self.name}", self._tell)
            forward = handle._link_changed

            def changed(link: Any, opened: bool) -> None:
                forward(link, opened)
                if self._events is not None:
                    self._events.put((link, opened))

            entry.on_link = changed
            self._watch_local(handle)

    def _watch_local(self, handle: Ros1Publisher) -> None:
        """This program's own subscribers have no connection; the listeners hear of them all the same."""
        attach, detach, events = handle._attach, handle._detach, self._events

        def attached(subscription: Subscription) -> None:
            attach(subscription)
            if events is not None:
                events.put((subscription, True))

        def detached(subscription: Subscription) -> None:
            detach(subscription)
            if events is not None:
                events.put((subscription, False))

        handle._attach = attached  # type: ignore[method-assign]
        handle._detach = detached  # type: ignore[method-assign]
        for subscription in handle._local:
            events.put((subscription, True))  # type: ignore[union-attr]

    def _tell(self, event: tuple[Any, bool], left: int | None = None) -> None:
        """A subscriber has come or gone (`left` are there): tell the listeners, outside the loop."""
        link, opened = event
        for listener in list(self.listeners):
            try:
                if opened:
                    listener.peer_subscribe(self.name, self.publish, lambda m: self.publish_to(link, m))
                else:
                    listener.peer_unsubscribe(self.name, self.get_num_connections() if left is None else left)
            except Exception as error:
                core.logwarn("the subscriber listener of %s failed: %s" % (self.name, error))

    def publish(self, message: Any) -> None:
        """Send to all. Raises ROSSerializationException."""
        handle = self.handle
        if handle is None or (not self.latch and not self.has_connections()):
            return
        if handle._has_header and message.header.frame_id is None:
            message.header.frame_id = "0"
        try:
            if message.__class__ is AnyMsg:
                message = self._known(message)
            handle.publish(message)
            if self._sets_own_clock and session.node is not None:
                session.node.clock.advance(message.clock.secs, message.clock.nsecs)
        except InvalidMessage as error:
            raise ROSSerializationException(str(error)) from None
        except NodeClosed:
            if not session.shutting_down.is_set():
                raise ROSException("publish() to a closed topic") from None

    def _known(self, message: AnyMsg) -> Any:
        return self.type.deserialize(message._buff or b"")

    def publish_to(self, link: Any, message: Any) -> None:
        """Send to one subscriber only."""
        handle = self.handle
        if handle is None:
            return
        if isinstance(link, Ros1Subscription):
            link._deliver_later(handle._for_local(link, message))
            return
        if not isinstance(link, PublisherLink) or link.closing:
            return
        try:
            body = message.serialize()
        except InvalidMessage as error:
            raise ROSSerializationException(str(error)) from None
        with handle._lock:
            handle._queue(link, pack("<I", len(body)) + body)


__all__ = ["Connection", "PublishedTopic", "topics"]
