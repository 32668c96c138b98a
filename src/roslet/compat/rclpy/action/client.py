"""`rclpy.action.client`: goals sent, followed, cancelled.

Responses and feedback reach the program in the order in which they came: one inbox has both.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from roslet.compat.interfaces import message_class
from roslet.compat.rclpy._entity import Entity
from roslet.compat.rclpy.action._qos import FEEDBACK, action_qos
from roslet.compat.rclpy.client import Inbox, wait_done
from roslet.compat.rclpy.qos import (
    QoSProfile,
    qos_profile_action_status_default,
    qos_profile_services_default,
)
from roslet.compat.rclpy.task import Future
from roslet.compat.rclpy.type_support import check_is_valid_action_type
from roslet.engine.ros2.actions import UNKNOWN
from roslet.node.ros2 import actions as roslet

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.compat.rclpy.callback_groups import CallbackGroup
    from roslet.engine.ros2.actions import ClientGoal


class ClientGoalHandle:
    """A goal that the server answered for."""

    def __init__(self, action_client: ActionClient, goal: ClientGoal, response: Any) -> None:
        self._client = action_client
        self._goal = goal
        self._response = response
        self._uuid = message_class("unique_identifier_msgs/msg/UUID")(uuid=goal.uuid)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ClientGoalHandle) and self._goal.uuid == other._goal.uuid

    def __hash__(self) -> int:
        return hash(self._goal.uuid)

    def __repr__(self) -> str:
        return (
            f"ClientGoalHandle <id={self._goal.uuid.hex()}, accepted={self.accepted}, status={self.status}>"
        )

    @property
    def goal_id(self) -> Any:
        """The id, a unique_identifier_msgs/msg/UUID."""
        return self._uuid

    @property
    def stamp(self) -> Any:
        """When it was accepted, a builtin_interfaces/msg/Time."""
        return self._response.stamp

    @property
    def accepted(self) -> bool:
        """Whether the server accepted it."""
        return bool(self._response.accepted)

    @property
    def status(self) -> int:
        """As the server last said, numbered as action_msgs/msg/GoalStatus does."""
        return self._goal.status if self.accepted else UNKNOWN

    def cancel_goal(self) -> Any:
        """The response to a request to cancel it. Somebody else must spin meanwhile."""
        return _waited(self.cancel_goal_async())

    def cancel_goal_async(self) -> Future[Any]:
        """A future of the response to a request to cancel it, an action_msgs/srv/CancelGoal.Response."""
        request = self._client._endpoint._cancel_goal.type.Request()
        request.goal_info.goal_id.uuid = self._goal.uuid
        return self._client._call(self._client._endpoint._cancel_goal, request, lambda response: response)

    def get_result(self) -> Any:
        """The response with status and result. Somebody else must spin meanwhile."""
        return _waited(self.get_result_async())

    def get_result_async(self) -> Future[Any]:
        """A future of the response that has `status` and `result`."""
        client = self._client
        request = client._action_type.GetResult.Request()
        request.goal_id.uuid = self._goal.uuid

        def ended(response: Any) -> Any:
            client._endpoint._goals.result(self._goal.uuid, response.status)
            self._goal.status = response.status or self._goal.status
            return response

        return client._call(client._endpoint._get_result, request, ended)


class _Endpoint(roslet.ActionClient):
    """roslet's action client, whose callbacks get the whole feedback message."""

    def _feedback_came(self, message: Any) -> Any:
        goal = self._goals.get(bytes(message.goal_id.uuid))
        return None if goal is None or goal.owner is None else goal.owner(message)


class ActionClient:
    """Sends goals. The profiles are the qualities of service of its channels."""

    def __init__(
        self,
        node: Any,
        action_type: Any,
        action_name: str,
        *,
        callback_group: CallbackGroup | None = None,
        goal_service_qos_profile: QoSProfile = qos_profile_services_default,
        result_service_qos_profile: QoSProfile = qos_profile_services_default,
        cancel_service_qos_profile: QoSProfile = qos_profile_services_default,
        feedback_sub_qos_profile: QoSProfile = FEEDBACK,
        status_sub_qos_profile: QoSProfile = qos_profile_action_status_default,
    ) -> None:
        check_is_valid_action_type(action_type)
        self._node = node
        self._action_type = action_type
        self._action_name = action_name
        full = node.resolve_service_name(action_name)
        qos = action_qos(
            goal_service_qos_profile,
            cancel_service_qos_profile,
            result_service_qos_profile,
            feedback_sub_qos_profile,
            status_sub_qos_profile,
        )
        self._endpoint = _Endpoint(node._node_network, full, action_type, qos)
        self._inbox: Inbox = node._node_adopt(Entity, Inbox(callback_group or node.default_callback_group))
        for subscription in self._endpoint._subscriptions:
            self._follow(subscription)

    def _follow(self, subscription: Any) -> None:
        def deliver() -> Any:
            found = subscription.take_one()
            return None if found is None else subscription._callback(found[0])

        with self._endpoint._network.reactor.lock:
            subscription.arrived = lambda: self._inbox.put(deliver)
            for _ in range(len(subscription._arrived)):
                subscription.arrived()

    def _call(self, endpoint: Any, request: Any, convert: Callable[[Any], Any]) -> Future[Any]:
        future: Future[Any] = Future()
        self._inbox.resolve(future, endpoint.call_async(request), convert)
        return future

    def send_goal(self, goal: Any, **kwargs: Any) -> Any:
        """Send a goal and wait for its result: the response with status and result; a rejected goal has status unknown.
        Somebody else must spin meanwhile. Takes what `send_goal_async` takes."""
        handle = _waited(self.send_goal_async(goal, **kwargs))
        return handle.get_result()

    def send_goal_async(
        self,
        goal: Any,
        feedback_callback: Callable[[Any], Any] | None = None,
        goal_uuid: Any = None,
    ) -> Future[ClientGoalHandle]:
        """A future of a ClientGoalHandle, accepted or not. `feedback_callback(message)` gets the whole feedback message; it
        may be a coroutine function. Raises TypeError for what is no goal message, RuntimeError where the id is in use or
        1024 goals have not ended."""
        if not isinstance(goal, self._action_type.Goal):
            raise TypeError(f"expected a goal message, not {type(goal).__name__}")
        uuid = os.urandom(16) if goal_uuid is None else bytes(goal_uuid.uuid)
        request = self._action_type.SendGoal.Request(goal=goal)
        request.goal_id.uuid = uuid
        goals = self._endpoint._goals
        with self._endpoint._network.reactor.lock:
            try:
                sent = goals.send(uuid, feedback_callback)
            except ValueError as error:
                raise RuntimeError(f"{self._action_name}: {error}") from None

        def answered(response: Any) -> ClientGoalHandle:
            stamp = response.stamp.sec * 1_000_000_000 + response.stamp.nanosec
            goals.answered(uuid, bool(response.accepted), stamp)
            return ClientGoalHandle(self, sent, response)

        return self._call(self._endpoint._send, request, answered)

    def server_is_ready(self) -> bool:
        """Whether there is a server, and all its channels are matched."""
        return self._endpoint.ready()

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Until there is a server, for at most `timeout_sec` seconds, or the context ends; whether there is one."""
        context = self._node.context
        self._endpoint._network.reactor.run_until(
            lambda: self._endpoint._closed or self._endpoint.ready() or not context.ok(),
            None if timeout_sec is None or timeout_sec < 0 else timeout_sec,
            user=False,
        )
        return not self._endpoint._closed and self._endpoint.ready()

    def destroy(self) -> None:
        """Send no more. Twice is allowed."""
        self._node._node_disown(Entity, self._inbox)
        self._endpoint.close()

    def __enter__(self) -> ActionClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.destroy()


def _waited(future: Future[Any]) -> Any:
    wait_done(future)
    return future.result()


__all__ = ["ActionClient", "ClientGoalHandle"]
