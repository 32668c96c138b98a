"""What a program's subscribers of one topic and type share: roslet's subscription, and the thread of their callbacks."""

from __future__ import annotations

import threading
import traceback
from typing import TYPE_CHECKING, Any

from roslet.compat.callbacks import UNBOUNDED, Worker
from roslet.compat.messages import simplify
from roslet.compat.publishing import Connection
from roslet.compat.rospy import core
from roslet.compat.rospy.msg import AnyMsg
from roslet.compat.session import session
from roslet.node import QoS
from roslet.wire.tcpros import MAX_FRAME

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.node import Node
    from roslet.node.ros1.topics import Ros1Subscription

    Callback = tuple[Callable[..., object], Any]

topics: dict[tuple[str, Any], SubscribedTopic] = {}


class SubscribedTopic:
    """The subscribers of one topic with one message class in this program."""

    def __init__(self, name: str, data_class: Any, queue_size: int | None) -> None:
        self.name = name
        self.data_class = data_class
        self.callbacks: list[Callback] = []
        self.users = 0
        self.handle: Ros1Subscription | None = None
        self.worker = Worker(f"topic {name}", self._work, queue_size)
        self.type = getattr(data_class, "_numpy_of", data_class)
        self._simplify = None
        if data_class is not AnyMsg:
            self._simplify = simplify(self.type, self.type is not data_class)
        self._paused: set[Any] = set()
        self._latched: dict[Any, Any] = {}  # the last message of each latching publisher
        self._lock = threading.Lock()
        self._asked = False

    def attach(self) -> None:
        """Register with the master, as soon as there is a node. Further calls have no effect."""
        if not self._asked:
            self._asked = True
            session.when_initialized(self._attach)

    def remove(self, callback: Callback | None) -> None:
        """One rospy.Subscriber less; the last one ends the subscription."""
        with self._lock:
            if callback is not None and callback in self.callbacks:
                self.callbacks.remove(callback)
            self.users -= 1
            if self.users:
                return
        if topics.get((self.name, self.data_class)) is self:
            del topics[self.name, self.data_class]
        if self.handle is not None:
            self.handle.close()
        self.worker.close()

    # Programs, actionlib's for example, ask these of rospy's own object in this place.

    def get_num_connections(self) -> int:
        """How many publishers are connected."""
        return 0 if self.handle is None else self.handle.publisher_count

    def has_connections(self) -> bool:
        """Whether any is."""
        return self.get_num_connections() > 0

    def has_connection(self, endpoint_id: str) -> bool:
        """Whether the node of this name is."""
        return any(connection.endpoint_id == endpoint_id for connection in self.connections)

    @property
    def connections(self) -> list[Connection]:
        """The publishers."""
        handle = self.handle
        if handle is None:
            return []
        links = () if handle._entry is None else handle._entry.links.values()
        found = [
            Connection(link.peer_header["callerid"])
            for link in links
            if "callerid" in getattr(link, "peer_header", {})
        ]
        return found if handle._publisher is None else [*found, Connection(session.name)]

    def _attach(self, node: Node) -> None:
        if not self.users or session.shutting_down.is_set():
            return
        kind = "*" if self.data_class is AnyMsg else self.type
        # Messages wait in the worker; what this program publishes itself must not be dropped before it gets there.
        qos = QoS(history="keep_all")
        network = node._ros1("rospy")
        self.handle = network.subscription(
            node.resolve(self.name),
            kind,
            self._received,
            qos,
            MAX_FRAME,
            with_link=True,
        )

    def add(self, callback: Callback | None) -> None:
        """One rospy.Subscriber more. From a latched topic it gets the last message, if there was one already."""
        with self._lock:
            self.users += 1
            if callback is None:
                return
            self.callbacks.append(callback)
            for message in self._latched.values():
                self.worker.put((message, None, callback))

    # In the loop's thread: hand over, never wait.

    def _received(self, message: Any, link: Any) -> None:
        worker = self.worker
        worker.put((message, link, None))
        if worker.size is None and len(worker) >= UNBOUNDED and link is not None and link not in self._paused:
            channel = getattr(link, "channel", None)
            if channel is not None:
                self._paused.add(link)
                channel.pause(True)

    # In the worker's thread.

    def _work(self, item: tuple[Any, Any, Callback | None]) -> None:
        message, link, only = item
        if self._paused and len(self.worker) < UNBOUNDED // 2:
            self._resume()
        if session.shutting_down.is_set():
            return
        if only is not None:
            self._call(only, message)
            return
        message = self._made(message, link)
        with self._lock:
            callbacks = list(self.callbacks)
            if message._connection_header.get("latching") == "1":
                if link not in self._latched:
                    self._latched = {key: value for key, value in self._latched.items() if not _gone(key)}
                self._latched[link] = message
        for callback in callbacks:
            self._call(callback, message)

    def _made(self, message: Any, link: Any) -> Any:
        """What came, as the program gets it."""
        if self.data_class is AnyMsg:
            raw, message = message, AnyMsg()
            message._buff = raw.data
        elif link is None:
            # From a publisher of this very program: by way of the wire's format, as it would be under rospy.
            body = message.serialize()
            message = self.type.deserialize_from(memoryview(bytearray(body)), 0, len(body))
        if self._simplify is not None:
            self._simplify(message)
        if self.type is not self.data_class:
            message.__class__ = self.data_class  # of the same layout
        message._connection_header = self._own_header() if link is None else link.peer_header
        return message

    def _call(self, callback: Callback, message: Any) -> None:
        function, argument = callback
        try:
            if argument is None:
                function(message)
            else:
                function(message, argument)
        except Exception:  # the program's own code, which may raise anything; rospy logs it and goes on
            if not session.shutting_down.is_set():
                core.logerr("bad callback: %s\n%s" % (function, traceback.format_exc()))

    def _resume(self) -> None:
        for link in list(self._paused):
            self._paused.discard(link)
            link.channel.pause(False)

    def _own_header(self) -> dict[str, str]:
        """What this program's own publisher would say of itself."""
        node = session.node
        publisher = node._ros1("rospy")._publishers.get(self.name) if node is not None else None
        entry = publisher._entry if publisher is not None else None
        return {} if entry is None else entry.header()


def _gone(link: Any) -> bool:
    """Whether a publisher's connection has ended."""
    return link is not None and bool(link.closing)


__all__ = ["SubscribedTopic", "topics"]
