"""`rclpy.event_handler`: what publishers and subscriptions are told apart from messages."""

from __future__ import annotations

import threading
from enum import IntEnum
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy._entity import Entity
from roslet.compat.rclpy.logging import get_logger
from roslet.compat.rclpy.qos import QoSPolicyKind
from roslet.node import events

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.compat.rclpy._network import QueuedPublisher, QueuedSubscription
    from roslet.compat.rclpy.callback_groups import CallbackGroup


class UnsupportedEventTypeError(RuntimeError):
    """There is no such event."""


class QoSPublisherEventType(IntEnum):
    """What a publisher is told."""

    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED = 0
    RCL_PUBLISHER_LIVELINESS_LOST = 1
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS = 2
    RCL_PUBLISHER_INCOMPATIBLE_TYPE = 3
    RCL_PUBLISHER_MATCHED = 4


class QoSSubscriptionEventType(IntEnum):
    """What a subscription is told."""

    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED = 0
    RCL_SUBSCRIPTION_LIVELINESS_CHANGED = 1
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS = 2
    RCL_SUBSCRIPTION_MESSAGE_LOST = 3
    RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE = 4
    RCL_SUBSCRIPTION_MATCHED = 5


class _Info:
    """Counts; those whose names end in `_change` are since the callback was last called."""

    _names: tuple[str, ...] = ("total_count", "total_count_change")

    def __init__(self, values: dict[str, Any]) -> None:
        for name in self._names:
            setattr(self, name, values.get(name, 0))

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={getattr(self, name)}' for name in self._names)})"


class QoSRequestedDeadlineMissedInfo(_Info):
    """A subscription: nothing came in time."""


class QoSOfferedDeadlineMissedInfo(_Info):
    """A publisher: nothing was published in time."""


class QoSLivelinessLostInfo(_Info):
    """A publisher: it did not assert its liveliness."""


class QoSMessageLostInfo(_Info):
    """A subscription: messages that will never come."""


class IncompatibleTypeInfo(_Info):
    """Somebody has another type on this topic; never told here."""


class QoSLivelinessChangedInfo(_Info):
    """A subscription: how many of its publishers live."""

    _names = ("alive_count", "not_alive_count", "alive_count_change", "not_alive_count_change")


class QoSRequestedIncompatibleQoSInfo(_Info):
    """A peer that offers less than is requested; `last_policy_kind` names why."""

    _names = ("total_count", "total_count_change", "last_policy_kind")


class QoSPublisherMatchedInfo(_Info):
    """A peer has come or gone."""

    _names = ("total_count", "total_count_change", "current_count", "current_count_change")


QoSOfferedIncompatibleQoSInfo = QoSRequestedIncompatibleQoSInfo
QoSSubscriptionMatchedInfo = QoSPublisherMatchedInfo

_PUBLISHER = QoSPublisherEventType
_SUBSCRIPTION = QoSSubscriptionEventType
_KINDS: dict[IntEnum, tuple[str, type[_Info]]] = {
    _PUBLISHER.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED: ("deadline", QoSOfferedDeadlineMissedInfo),
    _PUBLISHER.RCL_PUBLISHER_LIVELINESS_LOST: ("lost", QoSLivelinessLostInfo),
    _PUBLISHER.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS: ("incompatible", QoSOfferedIncompatibleQoSInfo),
    _PUBLISHER.RCL_PUBLISHER_INCOMPATIBLE_TYPE: ("type", IncompatibleTypeInfo),
    _PUBLISHER.RCL_PUBLISHER_MATCHED: ("matched", QoSPublisherMatchedInfo),
}
_OF_SUBSCRIPTIONS: dict[IntEnum, tuple[str, type[_Info]]] = {
    _SUBSCRIPTION.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED: ("deadline", QoSRequestedDeadlineMissedInfo),
    _SUBSCRIPTION.RCL_SUBSCRIPTION_LIVELINESS_CHANGED: ("alive", QoSLivelinessChangedInfo),
    _SUBSCRIPTION.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS: (
        "incompatible",
        QoSRequestedIncompatibleQoSInfo,
    ),
    _SUBSCRIPTION.RCL_SUBSCRIPTION_MESSAGE_LOST: ("messages", QoSMessageLostInfo),
    _SUBSCRIPTION.RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE: ("type", IncompatibleTypeInfo),
    _SUBSCRIPTION.RCL_SUBSCRIPTION_MATCHED: ("matched", QoSSubscriptionMatchedInfo),
}


class EventHandler(Entity):
    """Calls `callback(info)` for one kind of event. Several that come before the call are told at once."""

    def __init__(
        self, *, callback_group: CallbackGroup | None, callback: Callable[[Any], Any], event_type: IntEnum
    ) -> None:
        super().__init__(callback_group)
        kinds = _KINDS if isinstance(event_type, QoSPublisherEventType) else _OF_SUBSCRIPTIONS
        self._kind, self._info = kinds[event_type]
        self.callback = callback
        self.event_type = event_type
        self._lock = threading.Lock()
        self._counts: dict[str, Any] = {}
        self._due = False

    def _add(self, name: str, number: int) -> None:
        for key in (name, name + "_change"):
            self._counts[key] = self._counts.get(key, 0) + number

    def told(self, event: events.Event) -> None:
        """Note an event, in the loop; those of other kinds are nothing to it."""
        with self._lock:
            if not self._note(event):
                return
            self._due = True
        self._notify()

    def _note(self, event: events.Event) -> bool:
        kind = type(event)
        if self._kind == "matched" and kind in (events.Matched, events.Unmatched):
            came = kind is events.Matched
            self._add("current_count", 1 if came else -1)
            self._add("total_count", int(came))
        elif self._kind == "incompatible" and isinstance(event, events.QosIncompatible):
            self._add("total_count", 1)
            self._counts["last_policy_kind"] = QoSPolicyKind.__members__.get(
                event.policies[0].upper() if event.policies else "", QoSPolicyKind.INVALID
            )
        elif (self._kind == "deadline" and kind is events.DeadlineMissed) or (
            self._kind == "lost" and kind is events.LivelinessLost
        ):
            self._add("total_count", 1)
        elif self._kind == "messages" and isinstance(event, events.MessagesLost):
            self._add("total_count", event.count)
        elif self._kind == "alive":
            return self._note_life(event)
        else:
            return False
        return True

    def _note_life(self, event: events.Event) -> bool:
        dead: set[bytes] = self._counts.setdefault("dead", set())
        kind = type(event)
        if kind is events.Matched:
            self._add("alive_count", 1)
        elif kind is events.Unmatched:
            self._add("not_alive_count" if event.gid in dead else "alive_count", -1)
            dead.discard(event.gid)
        elif kind is events.LivelinessLost and event.gid not in dead:
            dead.add(event.gid)
            self._add("alive_count", -1)
            self._add("not_alive_count", 1)
        elif kind is events.LivelinessRegained and event.gid in dead:
            dead.discard(event.gid)
            self._add("alive_count", 1)
            self._add("not_alive_count", -1)
        else:
            return False
        return True

    def _ready(self) -> bool:
        return self._due and not self._destroyed

    def _take(self) -> Any:
        with self._lock:
            if not self._due:
                return self._nothing
            self._due = False
            info = self._info(self._counts)
            for name in self._counts:
                if name.endswith("_change"):
                    self._counts[name] = 0
            return info

    def _run(self, work: Any) -> Any:
        return self.callback(work)


class _Callbacks:
    """`names` are (attribute, event type)."""

    _names: tuple[tuple[str, IntEnum], ...] = ()
    incompatible_qos: Callable[[Any], Any] | None
    use_default_callbacks: bool

    def create_event_handlers(
        self,
        callback_group: CallbackGroup | None,
        endpoint: QueuedPublisher | QueuedSubscription,
        topic_name: str,
        logger_name: str = "",
    ) -> list[EventHandler]:
        """A handler for each callback that is set; a line of the log for incompatible ones where none is."""
        made = []
        for name, event_type in self._names:
            callback = getattr(self, name)
            if callback is None and name == "incompatible_qos" and self.use_default_callbacks:
                callback = self._line(topic_name, logger_name)
            if callback is not None:
                handler = EventHandler(
                    callback_group=callback_group, callback=callback, event_type=event_type
                )
                made.append(handler)

        def told(event: events.Event) -> None:
            for one in made:
                one.told(event)

        endpoint.tell(told)
        return made

    def _line(self, topic: str, logger_name: str) -> Callable[[Any], Any]:
        logger = get_logger(logger_name or "rclpy")
        offers = isinstance(self, PublisherEventCallbacks)

        def warn(info: Any) -> None:
            peer = "subscription" if offers else "publisher"
            asks = "requests more than is offered" if offers else "offers less than is requested"
            policy = QoSPolicyKind(info.last_policy_kind).name
            logger.warning(
                f"no messages between this node and a {peer} of '{topic}', which {asks}: QoS policy {policy}"
            )

        return warn


class SubscriptionEventCallbacks(_Callbacks):
    """The callbacks of a subscription, each with an info."""

    _names = (
        ("deadline", _SUBSCRIPTION.RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED),
        ("incompatible_qos", _SUBSCRIPTION.RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS),
        ("liveliness", _SUBSCRIPTION.RCL_SUBSCRIPTION_LIVELINESS_CHANGED),
        ("message_lost", _SUBSCRIPTION.RCL_SUBSCRIPTION_MESSAGE_LOST),
        ("incompatible_type", _SUBSCRIPTION.RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE),
        ("matched", _SUBSCRIPTION.RCL_SUBSCRIPTION_MATCHED),
    )

    def __init__(
        self,
        *,
        deadline: Callable[[Any], Any] | None = None,
        incompatible_qos: Callable[[Any], Any] | None = None,
        liveliness: Callable[[Any], Any] | None = None,
        message_lost: Callable[[Any], Any] | None = None,
        incompatible_type: Callable[[Any], Any] | None = None,
        matched: Callable[[Any], Any] | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        self.deadline = deadline
        self.incompatible_qos = incompatible_qos
        self.liveliness = liveliness
        self.message_lost = message_lost
        self.incompatible_type = incompatible_type
        self.matched = matched
        self.use_default_callbacks = use_default_callbacks


class PublisherEventCallbacks(_Callbacks):
    """The callbacks of a publisher, each with an info."""

    _names = (
        ("deadline", _PUBLISHER.RCL_PUBLISHER_OFFERED_DEADLINE_MISSED),
        ("liveliness", _PUBLISHER.RCL_PUBLISHER_LIVELINESS_LOST),
        ("incompatible_qos", _PUBLISHER.RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS),
        ("incompatible_type", _PUBLISHER.RCL_PUBLISHER_INCOMPATIBLE_TYPE),
        ("matched", _PUBLISHER.RCL_PUBLISHER_MATCHED),
    )

    def __init__(
        self,
        *,
        deadline: Callable[[Any], Any] | None = None,
        liveliness: Callable[[Any], Any] | None = None,
        incompatible_qos: Callable[[Any], Any] | None = None,
        incompatible_type: Callable[[Any], Any] | None = None,
        matched: Callable[[Any], Any] | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        self.deadline = deadline
        self.liveliness = liveliness
        self.incompatible_qos = incompatible_qos
        self.incompatible_type = incompatible_type
        self.matched = matched
        self.use_default_callbacks = use_default_callbacks


__all__ = [
    "EventHandler",
    "IncompatibleTypeInfo",
    "PublisherEventCallbacks",
    "QoSLivelinessChangedInfo",
    "QoSLivelinessLostInfo",
    "QoSMessageLostInfo",
    "QoSOfferedDeadlineMissedInfo",
    "QoSOfferedIncompatibleQoSInfo",
    "QoSPublisherEventType",
    "QoSPublisherMatchedInfo",
    "QoSRequestedDeadlineMissedInfo",
    "QoSRequestedIncompatibleQoSInfo",
    "QoSSubscriptionEventType",
    "QoSSubscriptionMatchedInfo",
    "SubscriptionEventCallbacks",
    "UnsupportedEventTypeError",
]
