"""`rospy.topics`: Publisher and Subscriber."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

from roslet.compat import publishing, subscribing
from roslet.compat.messages import adapt
from roslet.compat.publishing import PublishedTopic
from roslet.compat.rospy import names
from roslet.compat.rospy.exceptions import ROSException
from roslet.compat.rospy.msg import AnyMsg, args_kwds_to_message
from roslet.compat.session import session
from roslet.compat.subscribing import SubscribedTopic
from roslet.wire.message import Message

if TYPE_CHECKING:
    from collections.abc import Callable

DEFAULT_BUFF_SIZE = 65536


class Topic:
    """What Publisher and Subscriber have in common.

    name, resolved_name  the topic's full name
    type, md5sum         of the message class, `data_class`
    """

    def __init__(self, name: str, data_class: Any) -> None:
        if not name or not isinstance(name, str):
            raise ValueError("topic name is not a non-empty string")
        if data_class is None:
            raise ValueError("topic parameter 'data_class' is not initialized")
        if not isinstance(data_class, type):
            raise ValueError(f"data_class [{data_class}] is not a class")
        if not issubclass(data_class, Message):
            raise ValueError(f"data_class [{data_class.__class__.__name__}] is not a message data class")
        if data_class is not AnyMsg and not hasattr(data_class, "_numpy_of"):
            adapt(data_class)
        resolve = names.resolve_name if session.initialized else names.resolve_name_without_node_name
        self.name = self.resolved_name = resolve(name)
        self.data_class = data_class
        self.type = data_class._type
        self.md5sum = data_class._md5sum
        self.impl: PublishedTopic | SubscribedTopic | None = None

    def get_num_connections(self) -> int:
        """How many subscribers, or publishers, are connected."""
        return 0 if self.impl is None else self.impl.get_num_connections()


class SubscribeListener:
    """Base of what hears of a publisher's subscribers."""

    def peer_subscribe(
        self, topic_name: str, topic_publish: Callable[[Any], None], peer_publish: Callable[[Any], None]
    ) -> None:
        """A subscriber is connected. `topic_publish` sends to all, `peer_publish` to the new one only."""

    def peer_unsubscribe(self, topic_name: str, num_peers: int) -> None:
        """A subscriber is gone; `num_peers` are left."""


class Publisher(Topic):
    """Publishes a topic.

    subscriber_listener  a SubscribeListener
    tcp_nodelay          has no effect: it is always on
    latch                a subscriber that comes later gets the last message
    headers              further fields of the connection header
    queue_size           most messages kept for a slow subscriber; None publishes synchronously, 0 keeps all
    """

    def __init__(
        self,
        name: str,
        data_class: Any,
        subscriber_listener: SubscribeListener | None = None,
        tcp_nodelay: bool = False,
        latch: bool = False,
        headers: dict[str, str] | None = None,
        queue_size: int | None = None,
    ) -> None:
        super().__init__(name, data_class)
        if queue_size is None:
            warnings.warn(
                "The publisher should be created with an explicit keyword argument 'queue_size'. Please see "
                "http://wiki.ros.org/rospy/Overview/Publishers%20and%20Subscribers for more information.",
                SyntaxWarning,
                stacklevel=2,
            )
        with session.lock:
            topic = publishing.topics.get(self.resolved_name)
            if topic is None:
                topic = publishing.topics[self.resolved_name] = PublishedTopic(self.resolved_name, data_class)
            topic.add(latch, queue_size, headers, subscriber_listener)
        topic.attach()
        self.impl: PublishedTopic | None = topic

    def publish(self, *args: Any, **kwds: Any) -> None:
        """Send a message, given as a message, by its fields in order, or some by name.

        Raises ROSException before init_node and after unregister, ROSSerializationException for a value that a field
        cannot hold, but only where somebody listens.
        """
        impl = self.impl
        if impl is None:
            raise ROSException("publish() to an unregistered() handle")
        if not session.initialized:
            raise ROSException("ROS node has not been initialized yet. Please call init_node() first")
        impl.publish(args_kwds_to_message(self.data_class, args, kwds))

    def unregister(self) -> None:
        """Publish no more. Doing it twice is allowed."""
        impl, self.impl = self.impl, None
        if impl is not None:
            impl.remove()


class Subscriber(Topic):
    """Calls `callback(message)`, or `callback(message, callback_args)`, for every message of a topic, in a thread of
    that topic.

    queue_size   most messages that wait for the callback, the oldest goes first; None: all
    buff_size    has no effect
    tcp_nodelay  has no effect: it is always on
    """

    def __init__(
        self,
        name: str,
        data_class: Any,
        callback: Callable[..., object] | None = None,
        callback_args: Any = None,
        queue_size: int | None = None,
        buff_size: int = DEFAULT_BUFF_SIZE,
        tcp_nodelay: bool = False,
    ) -> None:
        super().__init__(name, data_class)
        key = (self.resolved_name, data_class)
        with session.lock:
            topic = subscribing.topics.get(key)
            if topic is None:
                topic = subscribing.topics[key] = SubscribedTopic(*key, queue_size)
            elif queue_size is not None:
                topic.worker.size = queue_size
            self.callback = callback
            self.callback_args = callback_args
            self._entry = None if callback is None else (callback, callback_args)
            topic.add(self._entry)
        topic.attach()
        self.impl: SubscribedTopic | None = topic

    def unregister(self) -> None:
        """Hear no more. Doing it twice is allowed."""
        impl, self.impl = self.impl, None
        if impl is not None:
            impl.remove(self._entry)


__all__ = ["DEFAULT_BUFF_SIZE", "Publisher", "SubscribeListener", "Subscriber", "Topic"]
