"""`rclpy.subscription`."""

from __future__ import annotations

import inspect
from types import GenericAlias
from typing import TYPE_CHECKING, Any, TypedDict

from roslet.compat.rclpy._entity import Entity
from roslet.compat.rclpy.exceptions import RCLError
from roslet.compat.rclpy.utilities import RMW

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.compat.rclpy._network import QueuedSubscription
    from roslet.compat.rclpy.callback_groups import CallbackGroup
    from roslet.compat.rclpy.event_handler import EventHandler
    from roslet.compat.rclpy.qos import QoSProfile
    from roslet.node.ros2.topics import MessageInfo as Info


class MessageInfo(TypedDict):
    """What a callback of two arguments is told. Times are nanoseconds of the Unix epoch."""

    source_timestamp: int
    received_timestamp: int
    publication_sequence_number: int | None
    reception_sequence_number: int | None
    publisher_gid: dict[str, Any] | None


class Subscription(Entity):
    """Receives one topic. Made by `Node.create_subscription`. What arrives is kept, as many as the depth of the QoS, and
    made into a message in the executor's thread."""

    # Programs annotate with `Subscription[...]`, and Python evaluates that.
    __class_getitem__: Any = classmethod(GenericAlias)

    def __init__(
        self,
        endpoint: QueuedSubscription,
        msg_type: Any,
        topic: str,
        callback: Callable[..., Any],
        callback_group: CallbackGroup | None,
        qos_profile: QoSProfile,
        raw: bool,
        logger_name: str,
    ) -> None:
        super().__init__(callback_group)
        self._endpoint = endpoint
        self.msg_type = msg_type
        self.topic = topic
        self.qos_profile = qos_profile
        self.raw = raw
        self.event_handlers: list[EventHandler] = []
        self._logger_name = logger_name
        self.callback = callback
        endpoint.arrived = self._notify

    @property
    def callback(self) -> Callable[..., Any]:
        """Called with the message, or with the message and its MessageInfo."""
        return self._callback

    @callback.setter
    def callback(self, value: Callable[..., Any]) -> None:
        self._informed = _takes_info(value)
        self._callback = value

    @property
    def topic_name(self) -> str:
        """The topic's full name, remappings applied."""
        self._check()
        return self._endpoint.topic

    @property
    def logger_name(self) -> str:
        """The name of its node's logger."""
        return self._logger_name

    def get_publisher_count(self) -> int:
        """Publishers matched now."""
        self._check()
        return self._endpoint.publisher_count

    @property
    def is_cft_enabled(self) -> bool:
        """Whether content is filtered: never."""
        return False

    def destroy(self) -> None:
        if not self._destroyed:
            super().destroy()
            for handler in self.event_handlers:
                handler.destroy()
            self._endpoint.arrived = None
            self._endpoint.close()

    # -- for the executor

    def _ready(self) -> bool:
        return not self._destroyed and self._endpoint.waiting()

    def _take(self) -> Any:
        found = self._endpoint.take_one(self.raw)
        return self._nothing if found is None else found

    def _run(self, work: Any) -> Any:
        message, info = work
        if self._informed:
            return self._callback(message, _told(info))
        return self._callback(message)


def _told(info: Info) -> MessageInfo:
    return {
        "source_timestamp": info.source_timestamp or 0,
        "received_timestamp": info.received_timestamp,
        "publication_sequence_number": info.sequence_number,
        "reception_sequence_number": None,
        "publisher_gid": {"implementation_identifier": RMW, "data": info.publisher_gid},
    }


def _takes_info(callback: Any) -> bool:
    """Whether a callback takes two arguments. Raises RuntimeError where it takes neither one nor two."""
    if callable(callback):
        try:
            signature = inspect.signature(callback)
        except (TypeError, ValueError):
            return False
        for arguments in ((None,), (None, None)):
            try:
                signature.bind(*arguments)
            except TypeError:
                continue
            return len(arguments) == 2
    raise RuntimeError("a subscription's callback must be callable with one argument, or with two")


__all__ = ["MessageInfo", "RCLError", "Subscription"]
