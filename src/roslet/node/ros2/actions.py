"""Actions on the ROS 2 network: a server and its goals, a client and its goals."""

from __future__ import annotations

import os
import threading

from roslet.engine.ros2 import actions as engine
from roslet.engine.ros2.actions import (
    ABORT,
    CANCEL_GOAL,
    CANCELED_EVENT,
    CANCELING,
    EXECUTE,
    STATES,
    SUCCEED,
    UNKNOWN,
    ClientGoals,
    InvalidTransition,
    ServerGoals,
    action_names,
    cancel_code,
)
from roslet.errors import CallTimeout, NodeClosed, RosletError
from roslet.node.convert import message_of
from roslet.node.future import Future
from roslet.node.qos import QoS
from roslet.node.ros2 import qos as presets

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from typing_extensions import Self

    from roslet.io.select import Timer
    from roslet.node.ros2.network import Ros2Network
    from roslet.node.services import Client


class ActionQoS:
    """The quality of service of an action's channels; give one what is to be otherwise."""

    send_goal = cancel_goal = get_result = presets.SERVICES
    feedback = QoS(10)
    status = QoS(1, durability="transient_local")


DEFAULT = ActionQoS()


class GoalRejected(RosletError):
    """The server did not accept the goal."""


class ServerGoal:
    """A goal that a server accepted. Made by `ActionServer`; any thread may use it.

    id       16 octets
    request  the goal's message
    """

    def __init__(self, server: ActionServer, goal: engine.ServerGoal) -> None:
        self.id = goal.uuid
        self.request = goal.request
        self._server = server
        self._goal = goal

    @property
    def status(self) -> str:
        """ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED or ABORTED."""
        return STATES[self._goal.status]

    @property
    def active(self) -> bool:
        """Whether it has not ended."""
        return self._goal.active

    @property
    def cancel_requested(self) -> bool:
        """Whether its client wants it canceled, and the server agreed: end it by `canceled`, soon."""
        return self._goal.status == CANCELING

    def execute(self) -> None:
        """Say that it is being worked on. Raises InvalidTransition."""
        self._server._apply(self._goal, EXECUTE)

    def feedback(self, message: Any = None, /, **fields: Any) -> None:
        """Tell its client how far it is: a feedback message, or its fields as keywords."""
        self._server._send_feedback(self._goal, message, fields)

    def succeed(self, result: Any = None, /, **fields: Any) -> None:
        """It is done; `result` is a result message, a dict, or given as keywords. Raises InvalidTransition."""
        self._server._finish(self._goal, SUCCEED, result, fields)

    def abort(self, result: Any = None, /, **fields: Any) -> None:
        """It has failed; the rest as with `succeed`."""
        self._server._finish(self._goal, ABORT, result, fields)

    def canceled(self, result: Any = None, /, **fields: Any) -> None:
        """It has ended because its client wanted so; the rest as with `succeed`."""
        self._server._finish(self._goal, CANCELED_EVENT, result, fields)


class ActionServer:
    """Serves an action. Made by `Node.action_server`.

    `handler(goal)` runs in a thread of its own for each goal, as it may take long; what it returns is the result and
    the goal has succeeded, unless it ended the goal itself; what it raises is logged, and the goal is aborted. Without a
    handler `accepted(goal)` is called inside spin, and whoever likes drives the goal by its methods.

    `on_goal(request)` and `on_cancel(goal)` are called inside spin and say whether; without them every goal is accepted and
    every cancel request granted. A result is kept for `result_timeout` seconds.
    """

    def __init__(
        self,
        network: Ros2Network,
        name: str,
        action_type: Any,
        handler: Callable[[ServerGoal], Any] | None,
        accepted: Callable[[ServerGoal], object] | None,
        on_goal: Callable[[Any], object] | None,
        on_cancel: Callable[[ServerGoal], object] | None,
        result_timeout: float | None,
        qos: ActionQoS = DEFAULT,
    ) -> None:
        if (handler is None) == (accepted is None):
            raise TypeError(f"the action server of {name} needs either a handler or `accepted`")
        self.name = name
        self.type = action_type
        self.node = network.node
        self._network = network
        self._handler = handler
        self._accepted = accepted
        self._on_goal = on_goal
        self._on_cancel = on_cancel
        self._goals = ServerGoals(result_timeout, counters=network.shell.context.counters)
        self._alarm: Timer | None = None
        self._closed = False
        names = action_names(name, action_type._type)
        self._feedback = network.publisher(names.feedback[0], action_type.FeedbackMessage, qos.feedback)
        self._status = network.publisher(names.status[0], names.status[1], qos.status)
        self._services = [
            network.service(names.send_goal[0], action_type.SendGoal, self._send_goal, qos.send_goal),
            network.service(names.cancel_goal[0], names.cancel_goal[1], self._cancel, qos.cancel_goal),
            network.service(names.get_result[0], action_type.GetResult, self._get_result, qos.get_result),
        ]
        self._publish_status()

    # -- what clients ask; inside spin

    def _send_goal(self, request: Any) -> dict[str, Any]:
        uuid = bytes(request.goal_id.uuid)
        stamp = self.node.now()
        accepted = self._takes(uuid)
        if accepted and self._on_goal is not None:
            accepted = bool(self._on_goal(request.goal))
        if accepted:
            handle = self._accept(uuid, stamp.to_nsec(), request.goal, ServerGoal)
            # Behind the response: what follows from here, its client must be able to place.
            self._network.reactor.call_soon(lambda: self._begin(handle), user=True)
        response: dict[str, Any] = {"accepted": accepted, "stamp": self._network.stamp(stamp.to_nsec())}
        return response

    def _takes(self, uuid: bytes) -> bool:
        """Whether a goal of this id may come; otherwise it is counted why not."""
        with self._network.reactor.lock:
            return not self._goals.refusal(uuid)

    def _accept(self, uuid: bytes, stamp: int, request: Any, handle: Callable[[Any, Any], Any]) -> Any:
        """A goal that nothing speaks against; `handle(self, goal)` makes what callbacks get, which is returned."""
        with self._network.reactor.lock:
            goal = self._goals.accept(uuid, stamp, request)
            goal.owner = handle(self, goal)
        self._publish_status()
        return goal.owner

    def _begin(self, handle: ServerGoal) -> None:
        if self._handler is None:
            if self._accepted is not None:
                self._accepted(handle)
            return
        name = f"roslet goal of {self.name}"
        threading.Thread(target=self._work, args=(handle, self._handler), name=name, daemon=True).start()

    def _work(self, handle: ServerGoal, handler: Callable[[ServerGoal], Any]) -> None:
        try:
            if handle.status == "ACCEPTED":
                handle.execute()
            result = handler(handle)
            if handle.active:
                handle.succeed(result)
        except NodeClosed:
            return
        except Exception as error:
            self.node._count("handler-raised")
            self.node.log.error(f"{self.name}: the handler raised {type(error).__name__}: {error}")
            if handle.active:
                handle.abort()

    def _cancel(self, request: Any) -> dict[str, Any]:
        info = request.goal_info
        stamp = info.stamp.sec * 1_000_000_000 + info.stamp.nanosec
        with self._network.reactor.lock:
            code, found = self._goals.cancel(bytes(info.goal_id.uuid), stamp)
        canceling = []
        for goal in found:
            if self._on_cancel is None or self._on_cancel(goal.owner):
                try:
                    self._apply(goal, CANCEL_GOAL)
                except InvalidTransition:
                    continue  # it has ended meanwhile
                canceling.append(self._network.goal_info(goal.uuid, goal.stamp))
        return {
            "return_code": cancel_code(code, len(found), len(canceling)),
            "goals_canceling": canceling,
        }

    def _get_result(self, request: Any) -> Any:
        waiting: Future[Any] = Future(self._network.reactor, f"the result of {self.name}")
        with self._network.reactor.lock:
            found = self._goals.ask_result(bytes(request.goal_id.uuid), waiting)
        return waiting if found is None else self._result_of(*found)

    def _result_of(self, status: int, result: Any) -> dict[str, Any]:
        return {"status": status} if result is None else {"status": status, "result": result}

    # -- what happens to goals; any thread

    def _apply(self, goal: engine.ServerGoal, event: int) -> None:
        if self._closed:
            raise NodeClosed(f"the action server of {self.name} is closed")
        with self._network.reactor.lock:
            self._goals.apply(goal, event, self._network.reactor.now())
        self._publish_status()

    def _finish(self, goal: engine.ServerGoal, event: int, result: Any, fields: dict[str, Any]) -> None:
        made = self._made(self.type.Result, result, fields)
        self._apply(goal, event)
        self._settle(goal, made)

    def _settle(self, goal: engine.ServerGoal, made: Any) -> None:
        """The result of a goal that has ended goes to whoever asks."""
        with self._network.reactor.lock:
            waiting = self._goals.finish(goal, made)
            self._watch()
        for request in waiting:
            request.set_result(self._result_of(goal.status, made))

    def _send_feedback(self, goal: engine.ServerGoal, message: Any, fields: dict[str, Any]) -> None:
        made = self.type.FeedbackMessage(feedback=self._made(self.type.Feedback, message, fields))
        made.goal_id.uuid = goal.uuid
        self._feedback.publish(made)

    @staticmethod
    def _made(kind: Any, message: Any, fields: dict[str, Any]) -> Any:
        if message is None:
            return kind(**fields)
        return message_of(kind, message, "expected")

    def _publish_status(self) -> None:
        message: Any = self._status.type()
        # Published with the lock held, too: of two threads, the one that knows less must not be the last.
        with self._network.reactor.lock:
            for uuid, stamp, status in self._goals.statuses():
                message.status_list.append(self._network.goal_status(uuid, stamp, status))
            self._status.publish(message)

    def _watch(self) -> None:
        at = self._goals.deadline()
        if at is not None and self._alarm is None:
            self._alarm = self._network.reactor.call_at(at, self._expire)

    def _expire(self) -> None:
        self._alarm = None
        for goal in self._goals.handle_deadline(self._network.reactor.now()):
            for request in goal.waiting:
                request.set_result(self._result_of(UNKNOWN, None))
        self._watch()

    @property
    def goals(self) -> list[ServerGoal]:
        """Those that have not ended, or whose result is still kept, in the order of acceptance."""
        with self._network.reactor.lock:
            return [goal.owner for goal in self._goals.all()]

    def close(self) -> None:
        """Withdraw the action. Goals are left as they are. Closing twice is allowed."""
        if self._closed:
            return
        self._closed = True
        if self._alarm is not None:
            self._alarm.cancel()
        for service in self._services:
            service.close()
        self._feedback.close()
        self._status.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()


class ClientGoal:
    """A goal that a server accepted. `id` are 16 octets."""

    def __init__(self, client: ActionClient, goal: engine.ClientGoal) -> None:
        self.id = goal.uuid
        self.client = client
        self._goal = goal
        self._asked: Future[tuple[str, Any]] | None = None

    @property
    def status(self) -> str:
        """As the server last said: ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED."""
        return STATES[self._goal.status]

    @property
    def stamp(self) -> int:
        """When the server accepted it, nanoseconds of the Unix epoch."""
        return self._goal.stamp

    def result_async(self) -> Future[tuple[str, Any]]:
        """A Future of (status, result message)."""
        if self._asked is None:
            self._asked = self.client._ask_result(self._goal)
        return self._asked

    def result(self, timeout: float | None = None) -> tuple[str, Any]:
        """(status, result message); spins meanwhile. Raises CallTimeout after `timeout` seconds (None: waits for ever)."""
        try:
            found: tuple[str, Any] = self.client._wait(self.result_async(), timeout)
        except CallTimeout:
            self._asked = None  # whoever asks again, asks the server
            raise
        return found

    def cancel_async(self) -> Future[bool]:
        """A Future of whether the server agreed to cancel it."""
        return self.client._cancel(self._goal)

    def cancel(self, timeout: float | None = None) -> bool:
        """Whether the server agreed to cancel it; the goal ends a little later. Raises CallTimeout."""
        return bool(self.client._wait(self.cancel_async(), timeout))


class ActionClient:
    """Sends goals. Made by `Node.action_client`. Many may be under way."""

    def __init__(self, network: Ros2Network, name: str, action_type: Any, qos: ActionQoS = DEFAULT) -> None:
        self.name = name
        self.type = action_type
        self.node = network.node
        self._network = network
        self._goals = ClientGoals()
        self._closed = False
        names = action_names(name, action_type._type)
        self._send = network.client(names.send_goal[0], action_type.SendGoal, qos=qos.send_goal)
        self._cancel_goal = network.client(names.cancel_goal[0], names.cancel_goal[1], qos=qos.cancel_goal)
        self._get_result = network.client(names.get_result[0], action_type.GetResult, qos=qos.get_result)
        self._subscriptions = [
            network.subscription(
                names.feedback[0], action_type.FeedbackMessage, self._feedback_came, qos.feedback
            ),
            network.subscription(names.status[0], names.status[1], self._status_came, qos.status),
        ]

    def ready(self) -> bool:
        """Whether a server is there, and all its channels are matched."""
        services = (self._send, self._cancel_goal, self._get_result)
        return all(one.ready() for one in services) and all(
            one.publisher_count for one in self._subscriptions
        )

    def wait(self, timeout: float | None = None) -> bool:
        """Serve until a server is there; false after `timeout` seconds, or when the node closes."""
        node = self.node
        node.reactor.run_until(lambda: self.ready() or node.is_shutdown, timeout, user=False)
        return self.ready()

    def send_goal_async(
        self,
        goal: Any = None,
        /,
        feedback: Callable[[Any], object] | None = None,
        goal_id: bytes | None = None,
        **fields: Any,
    ) -> Future[ClientGoal]:
        """A Future of the accepted goal, or of GoalRejected. `goal` is a goal message, a dict, or given as keywords;
        `feedback(message)` is called inside spin. `goal_id`: 16 octets, by chance where None."""
        if self._closed:
            raise NodeClosed(f"the action client of {self.name} is closed")
        uuid = os.urandom(16) if goal_id is None else goal_id
        request = self.type.SendGoal.Request(goal=ActionServer._made(self.type.Goal, goal, fields))
        request.goal_id.uuid = uuid
        answer: Future[ClientGoal] = self.node._future(f"a goal of {self.name}")
        with self._network.reactor.lock:
            try:
                sent = self._goals.send(uuid, feedback)
            except ValueError as error:
                raise RosletError(f"{self.name}: {error}") from None

        def answered(response: Any) -> None:
            stamp = response.stamp.sec * 1_000_000_000 + response.stamp.nanosec
            self._goals.answered(uuid, bool(response.accepted), stamp)
            if response.accepted:
                answer.set_result(ClientGoal(self, sent))
            else:
                answer.set_exception(GoalRejected(f"{self.name}: the server did not accept the goal"))

        def ended(_: Any) -> None:
            if sent.accepted is None:
                self._goals.forget(uuid)

        answer.add_done_callback(ended)
        self._ask(self._send, request, answer, answered)
        return answer

    def send_goal(
        self,
        goal: Any = None,
        /,
        feedback: Callable[[Any], object] | None = None,
        timeout: float | None = None,
        **fields: Any,
    ) -> ClientGoal:
        """The accepted goal; waits for a server and its answer, and spins meanwhile. Raises GoalRejected, CallTimeout."""
        accepted: ClientGoal = self._wait(self.send_goal_async(goal, feedback, **fields), timeout)
        return accepted

    def _wait(self, future: Future[Any], timeout: float | None) -> Any:
        if not self.node.spin_until(future.done, timeout):
            future.set_exception(CallTimeout("given up"))
            self.node._check_open()
            raise CallTimeout(f"action {self.name}: no answer within {timeout:g} s")
        return future.result(0)

    def _ask(
        self, client: Client, request: Any, answer: Future[Any], answered: Callable[[Any], None]
    ) -> None:
        """Call a service: `answered(response)` is to end `answer`, which an error ends as well. Whoever gives up `answer`
        gives up the call."""

        def done(call: Future[Any]) -> None:
            error = call.exception()
            if error is not None:
                answer.set_exception(error)
            else:
                answered(call.result(0))

        try:
            call = client.call_async(request)
        except RosletError as error:
            answer.set_exception(error)
            raise
        answer.add_done_callback(lambda _: call.set_exception(CallTimeout("given up")))
        call.add_done_callback(done)

    def _ask_result(self, goal: engine.ClientGoal) -> Future[tuple[str, Any]]:
        request = self.type.GetResult.Request()
        request.goal_id.uuid = goal.uuid
        answer: Future[tuple[str, Any]] = self.node._future(f"the result of a goal of {self.name}")

        def answered(response: Any) -> None:
            goal.status = response.status
            # Feedback that came before the result may still wait for spin to deliver it.
            self._network.reactor.call_soon(lambda: self._goals.forget(goal.uuid), user=True)
            answer.set_result((STATES[response.status], response.result))

        self._ask(self._get_result, request, answer, answered)
        return answer

    def _cancel(self, goal: engine.ClientGoal) -> Future[bool]:
        request = self._cancel_goal.type.Request()
        request.goal_info.goal_id.uuid = goal.uuid
        answer: Future[bool] = self.node._future(f"the canceling of a goal of {self.name}")

        def answered(response: Any) -> None:
            canceling = response.goals_canceling
            answer.set_result(any(bytes(one.goal_id.uuid) == goal.uuid for one in canceling))

        self._ask(self._cancel_goal, request, answer, answered)
        return answer

    def _feedback_came(self, message: Any) -> None:
        goal = self._goals.get(bytes(message.goal_id.uuid))
        if goal is not None and goal.owner is not None:
            goal.owner(message.feedback)

    def _status_came(self, message: Any) -> None:
        self._goals.told([(bytes(one.goal_info.goal_id.uuid), one.status) for one in message.status_list])

    def close(self) -> None:
        """Send no more. Goals go on without us. Closing twice is allowed."""
        if self._closed:
            return
        self._closed = True
        for client in (self._send, self._cancel_goal, self._get_result):
            client.close()
        for subscription in self._subscriptions:
            subscription.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()
