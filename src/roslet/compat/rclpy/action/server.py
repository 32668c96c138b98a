"""`rclpy.action.server`: goals accepted, executed, cancelled.

A request is answered in the executor's thread; an accepted goal is executed in a task of its own, so its callback may take
long where the executor has threads, or be a coroutine.
"""

from __future__ import annotations

import traceback
from enum import Enum
from typing import TYPE_CHECKING, Any

from roslet.compat.interfaces import message_class
from roslet.compat.rclpy._entity import Entity
from roslet.compat.rclpy.action._qos import FEEDBACK, action_qos
from roslet.compat.rclpy.exceptions import RCLError
from roslet.compat.rclpy.executors import await_or_execute
from roslet.compat.rclpy.qos import (
    QoSProfile,
    qos_profile_action_status_default,
    qos_profile_services_default,
)
from roslet.compat.rclpy.service import Requests, Then
from roslet.compat.rclpy.type_support import check_is_valid_action_type
from roslet.engine.ros2.actions import (
    ABORT,
    CANCEL_GOAL,
    CANCELED_EVENT,
    CANCELING,
    EXECUTE,
    SUCCEED,
    UNKNOWN,
    InvalidTransition,
)
from roslet.errors import NodeClosed
from roslet.node.ros2 import actions as roslet

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.compat.rclpy.callback_groups import CallbackGroup
    from roslet.compat.rclpy.impl.rcutils_logger import RcutilsLogger
    from roslet.engine.ros2.actions import ServerGoal


class GoalResponse(Enum):
    """What a goal callback answers."""

    REJECT = 1
    ACCEPT = 2


class CancelResponse(Enum):
    """What a cancel callback answers."""

    REJECT = 1
    ACCEPT = 2


class ServerGoalHandle:
    """A goal that was accepted."""

    def __init__(self, action_server: ActionServer, goal: ServerGoal) -> None:
        self._server = action_server
        self._goal = goal
        self._uuid = message_class("unique_identifier_msgs/msg/UUID")(uuid=goal.uuid)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ServerGoalHandle) and self._goal.uuid == other._goal.uuid

    def __hash__(self) -> int:
        return hash(self._goal.uuid)

    @property
    def request(self) -> Any:
        """The goal message."""
        return self._goal.request

    @property
    def goal_id(self) -> Any:
        """The id, a unique_identifier_msgs/msg/UUID."""
        return self._uuid

    @property
    def is_active(self) -> bool:
        """Whether it has not ended, and its server is there."""
        return self._goal.active and not self._server._endpoint._closed

    @property
    def is_cancel_requested(self) -> bool:
        """Whether it is to be cancelled."""
        return self.status == CANCELING

    @property
    def status(self) -> int:
        """As action_msgs/msg/GoalStatus numbers it; unknown once its server is destroyed."""
        return UNKNOWN if self._server._endpoint._closed else self._goal.status

    def execute(self, execute_callback: Callable[[ServerGoalHandle], Any] | None = None) -> None:
        """Have the executor call `execute_callback(self)`, the server's where None. What it returns is the result."""
        if not self.is_cancel_requested:
            self._server._happens(self._goal, EXECUTE)
        self._server.notify_execute(self, execute_callback)

    def publish_feedback(self, feedback: Any) -> None:
        """Tell the client how far it is. Raises TypeError for what is no feedback message."""
        if not isinstance(feedback, self._server.action_type.Feedback):
            raise TypeError(f"expected a feedback message, not {type(feedback).__name__}")
        try:
            self._server._endpoint._send_feedback(self._goal, feedback, {})
        except NodeClosed:
            return

    def succeed(self) -> None:
        """It is done. Raises RCLError where it has ended, or does not run; does nothing where the server is destroyed.
        Likewise the following."""
        self._server._happens(self._goal, SUCCEED)

    def abort(self) -> None:
        """It has failed."""
        self._server._happens(self._goal, ABORT)

    def canceled(self) -> None:
        """It has ended as it was to be cancelled."""
        self._server._happens(self._goal, CANCELED_EVENT)

    def destroy(self) -> None:
        """Nothing: the server forgets it when its result has expired."""


def default_handle_accepted_callback(goal_handle: ServerGoalHandle) -> None:
    """Execute the goal."""
    goal_handle.execute()


def default_goal_callback(goal_request: Any) -> GoalResponse:
    """Accept it."""
    return GoalResponse.ACCEPT


def default_cancel_callback(goal_handle: Any) -> CancelResponse:
    """Reject it."""
    return CancelResponse.REJECT


class _Endpoint(roslet.ActionServer):
    """roslet's action server, asking rclpy's callbacks, which may be coroutines."""

    owner: ActionServer

    async def _send_goal(self, request: Any) -> Any:  # type: ignore[override]
        uuid = bytes(request.goal_id.uuid)
        if not self._takes(uuid):
            return {"accepted": False}
        answer = await await_or_execute(self.owner._goal_callback, request.goal)
        if not isinstance(answer, GoalResponse):
            self.node.log.warning(
                "Goal request callback did not return a GoalResponse type. Ignoring goal..."
            )
            answer = GoalResponse.REJECT
        stamp = self.node.now().to_nsec()
        response = {
            "accepted": answer is GoalResponse.ACCEPT and not self._closed and self._takes(uuid),
            "stamp": self._network.stamp(stamp),
        }
        if not response["accepted"]:
            return response
        handle = self._accept(
            uuid, stamp, request.goal, lambda endpoint, goal: ServerGoalHandle(self.owner, goal)
        )
        return Then(response, lambda: self.owner._accepted_callback(handle))

    async def _cancel(self, request: Any) -> Any:  # type: ignore[override]
        info = request.goal_info
        stamp = info.stamp.sec * 1_000_000_000 + info.stamp.nanosec
        with self._network.reactor.lock:
            code, found = self._goals.cancel(bytes(info.goal_id.uuid), stamp)
        canceling = []
        for goal in found:
            if self._goals.get(goal.uuid) is None:
                continue  # its result has expired while another's callback was awaited
            answer = await await_or_execute(self.owner._cancel_callback, goal.owner)
            if answer is CancelResponse.ACCEPT:
                try:
                    self._apply(goal, CANCEL_GOAL)
                except (InvalidTransition, NodeClosed):
                    continue  # it has ended meanwhile, or the server has
                canceling.append(self._network.goal_info(goal.uuid, goal.stamp))
        return {
            "return_code": code,  # rclpy says nothing of rejection but that no goal is named
            "goals_canceling": canceling,
        }


class ActionServer:
    """Serves an action.

    execute_callback(goal_handle)           does the work of a goal and returns the result message; may be a coroutine
    goal_callback(goal)                     gives a GoalResponse; every goal is accepted by default
    handle_accepted_callback(goal_handle)   begins with an accepted goal: executes it by default
    cancel_callback(goal_handle)            gives a CancelResponse; by default nothing is cancelled
    result_timeout                          seconds that a result is kept

    The profiles are the qualities of service of its channels.
    """

    def __init__(
        self,
        node: Any,
        action_type: Any,
        action_name: str,
        execute_callback: Callable[[ServerGoalHandle], Any],
        *,
        callback_group: CallbackGroup | None = None,
        goal_callback: Callable[[Any], Any] = default_goal_callback,
        handle_accepted_callback: Callable[[ServerGoalHandle], Any] = default_handle_accepted_callback,
        cancel_callback: Callable[[Any], Any] = default_cancel_callback,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_pub_qos_profile: QoSProfile = FEEDBACK,
        status_pub_qos_profile: QoSProfile = qos_profile_action_status_default,
        result_timeout: float = 10,
    ) -> None:
        check_is_valid_action_type(action_type)
        self._node = node
        self._action_type = action_type
        self.register_execute_callback(execute_callback)
        self.register_goal_callback(goal_callback)
        self.register_handle_accepted_callback(handle_accepted_callback)
        self.register_cancel_callback(cancel_callback)
        full = node.resolve_service_name(action_name)
        qos = action_qos(
            goal_service_qos_profile,
            cancel_service_qos_profile,
            result_service_qos_profile,
            feedback_pub_qos_profile,
            status_pub_qos_profile,
        )
        self._endpoint = _Endpoint(
            node._node_network, full, action_type, None, lambda goal: None, None, None, result_timeout, qos
        )
        self._endpoint.owner = self
        group = callback_group or node.default_callback_group
        self._requests = []
        for service in self._endpoint._services:
            requests = Requests(service, group, None)  # type: ignore[arg-type]
            self._requests.append(node._node_adopt(Entity, requests))

    @property
    def action_type(self) -> Any:
        """The action's class."""
        return self._action_type

    # -- callbacks

    def register_execute_callback(self, execute_callback: Callable[[ServerGoalHandle], Any] | None) -> None:
        """Raises TypeError for what cannot be called. Likewise the following, where None stands for the default."""
        if not callable(execute_callback):
            raise TypeError("Failed to register goal execution callback: not callable")
        self._execute_callback = execute_callback

    def register_goal_callback(self, goal_callback: Callable[[Any], Any] | None) -> None:
        self._goal_callback = _callable(goal_callback, default_goal_callback, "goal")

    def register_handle_accepted_callback(
        self, handle_accepted_callback: Callable[[ServerGoalHandle], Any] | None
    ) -> None:
        self._accepted_callback = _callable(
            handle_accepted_callback, default_handle_accepted_callback, "handle accepted"
        )

    def register_cancel_callback(self, cancel_callback: Callable[[Any], Any] | None) -> None:
        self._cancel_callback = _callable(cancel_callback, default_cancel_callback, "cancel")

    # -- goals

    def _happens(self, goal: ServerGoal, event: int) -> None:
        try:
            self._endpoint._apply(goal, event)
        except InvalidTransition as error:
            raise RCLError(f"Failed to update goal state: {error}") from None
        except NodeClosed:
            return

    def notify_execute(
        self, goal_handle: ServerGoalHandle, execute_callback: Callable[[ServerGoalHandle], Any] | None
    ) -> None:
        """Have the executor of the node do the work of a goal; where the node has none, nobody does it, as in rclpy."""
        executor = self._node.executor
        if executor is not None:
            executor.create_task(self._execute, execute_callback or self._execute_callback, goal_handle)

    async def _execute(self, callback: Callable[[ServerGoalHandle], Any], handle: ServerGoalHandle) -> None:
        result = None
        try:
            result = await await_or_execute(callback, handle)
        except Exception as error:
            self._log().error(f"Error raised in execute callback: {error}")
            traceback.print_exc()
        if self._endpoint._closed:
            return
        if handle.is_active:
            number = handle.goal_id.uuid
            self._log().warning(f"Goal state not set, assuming aborted. Goal ID: {number}")
            handle.abort()
        kind = self._action_type.Result
        self._endpoint._settle(handle._goal, result if isinstance(result, kind) else kind())

    def _log(self) -> RcutilsLogger:
        logger: RcutilsLogger = self._node.get_logger().get_child("action_server")
        return logger

    def destroy(self) -> None:
        """Withdraw the action. Twice is allowed."""
        for requests in self._requests:
            self._node._node_disown(Entity, requests)
        self._requests = []
        self._endpoint.close()

    def __enter__(self) -> ActionServer:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy()


def _callable(given: Any, default: Any, what: str) -> Any:
    found = default if given is None else given
    if not callable(found):
        raise TypeError(f"Failed to register {what} callback: not callable")
    return found


__all__ = [
    "ActionServer",
    "CancelResponse",
    "GoalResponse",
    "ServerGoalHandle",
    "default_cancel_callback",
    "default_goal_callback",
    "default_handle_accepted_callback",
]
