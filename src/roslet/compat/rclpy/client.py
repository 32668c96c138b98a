"""`rclpy.client`."""

from __future__ import annotations

import threading
from collections import deque
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy._entity import Entity
from roslet.compat.rclpy.task import Future
from roslet.errors import RosletError

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.compat.rclpy.callback_groups import CallbackGroup
    from roslet.compat.rclpy.context import Context
    from roslet.compat.rclpy.qos import QoSProfile
    from roslet.node.future import Future as RosletFuture
    from roslet.node.ros2.services import Ros2Client


class _GivenUp(RosletError):
    """The program waits for this no more: its future stays as it is."""


class Inbox(Entity):
    """What the loop has for the executor to do, in order: no more than was asked for, so there is no bound of its own."""

    def __init__(self, callback_group: CallbackGroup | None) -> None:
        super().__init__(callback_group)
        self._todo: deque[Callable[[], Any]] = deque()

    def put(self, function: Callable[[], Any]) -> None:
        """Have the executor call `function()`. From any thread."""
        self._todo.append(function)
        self._notify()

    def resolve(self, future: Future[Any], asked: RosletFuture[Any], convert: Callable[[Any], Any]) -> None:
        """Have the executor give a future what is asked of a peer, when it is there. A future that was given up meanwhile
        stays as it is."""

        def end() -> None:
            if not future._pending():
                return
            node = None if self._home is None else self._home()
            future._set_executor(None if node is None else node.executor)
            error = asked.exception()
            if isinstance(error, _GivenUp):
                return
            if error is not None:
                future.set_exception(error)
            else:
                future.set_result(convert(asked.result(0)))

        asked.add_done_callback(lambda _: self.put(end))

    def _ready(self) -> bool:
        return bool(self._todo) and not self._destroyed

    def _take(self) -> Any:
        try:
            return self._todo.popleft()
        except IndexError:
            return self._nothing

    def _run(self, work: Any) -> Any:
        return work()


def wait_done(future: Future[Any], timeout: float | None = None) -> bool:
    """Wait, not spinning, until a future is done or cancelled: somebody else spins."""
    done = threading.Event()
    future._wake_when_done(done.set)
    return done.wait(timeout)


class Client(Inbox):
    """Calls a service. Made by `Node.create_client`."""

    def __init__(
        self,
        endpoint: Ros2Client,
        context: Context,
        srv_type: Any,
        srv_name: str,
        callback_group: CallbackGroup | None,
        qos_profile: QoSProfile,
        logger_name: str,
    ) -> None:
        super().__init__(callback_group)
        self._endpoint = endpoint
        self.context = context
        self.srv_type = srv_type
        self.srv_name = srv_name
        self.qos_profile = qos_profile
        self._logger_name = logger_name
        self._pending: dict[Future[Any], RosletFuture[Any]] = {}

    def call(self, request: Any, timeout_sec: float | None = None) -> Any:
        """The response. Somebody else must spin meanwhile. Raises TimeoutError where there is none in time, TypeError."""
        future = self.call_async(request)
        if not wait_done(future, timeout_sec):
            self.remove_pending_request(future)
            raise TimeoutError
        return future.result()

    def call_async(self, request: Any) -> Future[Any]:
        """A future of the response. Raises TypeError for what is no request of this service, InvalidHandle."""
        self._check()
        if not isinstance(request, self.srv_type.Request):
            raise TypeError(f"expected a request of {self.srv_type.__name__}, not {type(request).__name__}")
        future: Future[Any] = Future()
        asked = self._endpoint.call_async(request)
        self._pending[future] = asked
        future._wake_when_done(lambda: self._forget(future))
        self.resolve(future, asked, lambda response: response)
        return future

    def _forget(self, future: Future[Any]) -> None:
        self._pending.pop(future, None)

    def remove_pending_request(self, future: Future[Any]) -> None:
        """Wait for the response of this call no more."""
        asked = self._pending.pop(future, None)
        if asked is not None:
            asked.set_exception(_GivenUp())

    def service_is_ready(self) -> bool:
        """Whether there is a server, and both ways are matched."""
        self._check()
        return self._endpoint.ready()

    def wait_for_service(self, timeout_sec: float | None = None) -> bool:
        """Until there is a server, for at most `timeout_sec` seconds, or the context ends; whether there is one."""
        self._check()
        self._endpoint._network.reactor.run_until(
            lambda: self._endpoint.ready() or self._destroyed or not self.context.ok(),
            None if timeout_sec is None or timeout_sec < 0 else timeout_sec,
            user=False,
        )
        return not self._destroyed and self._endpoint.ready()

    @property
    def service_name(self) -> str:
        """The service's full name, remappings applied."""
        self._check()
        return self._endpoint.name

    @property
    def logger_name(self) -> str:
        """The name of its node's logger."""
        return self._logger_name

    def destroy(self) -> None:
        if not self._destroyed:
            super().destroy()
            self._endpoint.close()


__all__ = ["Client", "Inbox", "wait_done"]
