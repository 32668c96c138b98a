"""`rclpy.publisher`."""

from __future__ import annotations

from types import GenericAlias
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy.duration import Duration
from roslet.compat.rclpy.exceptions import InvalidHandle

if TYPE_CHECKING:
    from types import TracebackType

    from typing_extensions import Self

    from roslet.compat.rclpy._network import QueuedPublisher
    from roslet.compat.rclpy.event_handler import EventHandler
    from roslet.compat.rclpy.qos import QoSProfile


class Publisher:
    """Publishes one topic. Made by `Node.create_publisher`."""

    # Programs annotate with `Publisher[...]`, and Python evaluates that.
    __class_getitem__: Any = classmethod(GenericAlias)

    def __init__(
        self, endpoint: QueuedPublisher, msg_type: Any, topic: str, qos_profile: QoSProfile, logger_name: str
    ) -> None:
        self._endpoint = endpoint
        self.msg_type = msg_type
        self.topic = topic
        self.qos_profile = qos_profile
        self.event_handlers: list[EventHandler] = []
        self._logger_name = logger_name
        self._destroyed = False

    def _open(self) -> QueuedPublisher:
        if self._destroyed:
            raise InvalidHandle()
        return self._endpoint

    @property
    def topic_name(self) -> str:
        """The topic's full name, remappings applied."""
        return self._open().topic

    @property
    def logger_name(self) -> str:
        """The name of its node's logger."""
        return self._logger_name

    def publish(self, msg: Any) -> None:
        """Send a message, or the bytes of one. Raises TypeError for anything else, InvalidHandle."""
        endpoint = self._open()
        if isinstance(msg, self.msg_type):
            endpoint.publish(msg)
        elif isinstance(msg, bytes):
            endpoint.publish_serialized(msg)
        else:
            raise TypeError(f"expected {self.msg_type.__name__}, not {type(msg).__name__}")

    def get_subscription_count(self) -> int:
        """Subscriptions matched now."""
        return self._open().subscriber_count

    def assert_liveliness(self) -> None:
        """Say that it is alive, for liveliness MANUAL_BY_TOPIC."""
        self._open().assert_liveliness()

    def wait_for_all_acked(self, timeout: Duration = Duration(seconds=-1)) -> bool:  # noqa: B008 - as in rclpy
        """Until every reliable subscription has acknowledged what was published; False where the time is over before. A
        negative time has no end."""
        endpoint = self._open()
        seconds = timeout.nanoseconds * 1e-9
        return endpoint._shell.reactor.run_until(
            endpoint._flushed, None if seconds < 0 else seconds, user=False
        )

    def destroy(self) -> None:
        """Withdraw it. Twice is allowed."""
        if not self._destroyed:
            self._destroyed = True
            for handler in self.event_handlers:
                handler.destroy()
            self._endpoint.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.destroy()


__all__ = ["Publisher"]
