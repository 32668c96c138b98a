"""`rclpy.service`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy._entity import Entity
from roslet.compat.rclpy.executors import await_or_execute
from roslet.node.future import Future as RosletFuture

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.compat.rclpy._network import QueuedService
    from roslet.compat.rclpy.callback_groups import CallbackGroup
    from roslet.compat.rclpy.qos import QoSProfile


class Requests(Entity):
    """Serves what arrives at a roslet service in the executor's thread: `handler(request)` gives the response message or
    a dict, a coroutine, a roslet Future, or `Then`."""

    def __init__(
        self,
        endpoint: QueuedService,
        callback_group: CallbackGroup | None,
        handler: Callable[[Any], Any] | None,
    ) -> None:
        super().__init__(callback_group)
        self._endpoint = endpoint
        self._handle = handler if handler is not None else endpoint._handler
        endpoint.arrived = self._notify

    def destroy(self) -> None:
        if not self._destroyed:
            super().destroy()
            self._endpoint.arrived = None
            self._endpoint.close()

    def _ready(self) -> bool:
        return not self._destroyed and self._endpoint.waiting()

    def _take(self) -> Any:
        found = self._endpoint.take_one()
        return self._nothing if found is None else found

    async def _run(self, work: Any) -> None:
        request, reply = work
        response = await await_or_execute(self._handle, request)
        if isinstance(response, RosletFuture):
            response.add_done_callback(lambda done: self._reply_late(done, reply))
        elif isinstance(response, Then):
            reply(self._endpoint._serialize(response.response))
            await await_or_execute(response.function)
        else:
            reply(self._endpoint._serialize(response))

    def _reply_late(self, done: RosletFuture[Any], reply: Callable[[bytes], None]) -> None:
        if done.exception() is None:
            reply(self._endpoint._serialize(done.result(0)))


class Then:
    """A response, and what is to be done when it has been sent."""

    def __init__(self, response: Any, function: Callable[[], Any]) -> None:
        self.response = response
        self.function = function


class Service(Requests):
    """Answers requests: `callback(request, response)` returns the response, or is a coroutine function. Made by
    `Node.create_service`."""

    def __init__(
        self,
        endpoint: QueuedService,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        callback_group: CallbackGroup | None,
        qos_profile: QoSProfile,
        logger_name: str,
    ) -> None:
        super().__init__(endpoint, callback_group, self._answer)
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.callback = callback
        self.qos_profile = qos_profile
        self._logger_name = logger_name

    async def _answer(self, request: Any) -> Any:
        response = await await_or_execute(self.callback, request, self.srv_type.Response())
        if not isinstance(response, self.srv_type.Response):
            raise TypeError(
                f"{self.service_name}: the callback returned {type(response).__name__}, no response"
            )
        return response

    @property
    def service_name(self) -> str:
        """The service's full name, remappings applied."""
        self._check()
        return self._endpoint.name

    @property
    def logger_name(self) -> str:
        """The name of its node's logger."""
        return self._logger_name


__all__ = ["Requests", "Service", "Then"]
