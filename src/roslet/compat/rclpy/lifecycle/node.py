"""`rclpy.lifecycle.node`: the managed node."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from roslet.compat.interfaces import message_class
from roslet.compat.rclpy.lifecycle import _machine
from roslet.compat.rclpy.lifecycle._machine import STATES, TRANSITIONS, TransitionCallbackReturn
from roslet.compat.rclpy.lifecycle.managed_entity import ManagedEntity
from roslet.compat.rclpy.lifecycle.publisher import LifecyclePublisher
from roslet.compat.rclpy.node import Node

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from roslet.compat.rclpy.callback_groups import CallbackGroup
    from roslet.compat.rclpy.lifecycle._machine import Transition

# What is called in a state that is passed through.
_CALLBACKS = {
    _machine.CONFIGURING: "on_configure",
    _machine.CLEANINGUP: "on_cleanup",
    _machine.SHUTTINGDOWN: "on_shutdown",
    _machine.ACTIVATING: "on_activate",
    _machine.DEACTIVATING: "on_deactivate",
    _machine.ERRORPROCESSING: "on_error",
}


class LifecycleState(NamedTuple):
    """The state that a transition began in."""

    label: str
    state_id: int


class LifecycleNodeMixin(ManagedEntity):
    """What makes a Node a managed one: derive from this and from Node."""

    _node_machine: _machine.Machine

    def __init__(
        self, *, enable_communication_interface: bool = True, callback_group: CallbackGroup | None = None
    ) -> None:
        node: Any = self
        if not isinstance(self, Node):
            raise RuntimeError("LifecycleNodeMixin is for classes that derive from Node too")
        self._node_machine = _machine.Machine()
        self._node_managed: list[ManagedEntity] = []
        self._node_transition_event: Any = None
        if not enable_communication_interface:
            return
        self._node_transition_event = node.create_publisher(
            message_class("lifecycle_msgs/msg/TransitionEvent"), "~/transition_event", 1
        )
        for name, kind, callback in (
            ("change_state", "ChangeState", self._node_on_change_state),
            ("get_state", "GetState", self._node_on_get_state),
            ("get_available_states", "GetAvailableStates", self._node_on_get_states),
            ("get_available_transitions", "GetAvailableTransitions", self._node_on_get_transitions),
            ("get_transition_graph", "GetAvailableTransitions", self._node_on_get_graph),
        ):
            service = message_class(f"lifecycle_msgs/srv/{kind}")
            node.create_service(service, f"~/{name}", callback, callback_group=callback_group)

    # -- transitions

    def trigger_configure(self) -> TransitionCallbackReturn:
        """Configure the node; how that ended. Likewise the following."""
        return self._node_change("configure")

    def trigger_cleanup(self) -> TransitionCallbackReturn:
        return self._node_change("cleanup")

    def trigger_activate(self) -> TransitionCallbackReturn:
        return self._node_change("activate")

    def trigger_deactivate(self) -> TransitionCallbackReturn:
        return self._node_change("deactivate")

    def trigger_shutdown(self) -> TransitionCallbackReturn:
        if self._node_machine.state == _machine.FINALIZED:
            return TransitionCallbackReturn.SUCCESS
        return self._node_change("shutdown")

    def _node_change(self, which: int | str) -> TransitionCallbackReturn:
        node: Any = self
        before = LifecycleState(STATES[self._node_machine.state], self._node_machine.state)
        begins = self._node_machine.find(which)
        if begins is None or begins.goal not in _CALLBACKS:
            node.get_logger().error(f"Unable to start transition {which} from current state {before.label}")
            return TransitionCallbackReturn.ERROR
        self._node_go(begins)
        ended = self._node_call_for(before)
        self._node_conclude(ended)
        if ended is TransitionCallbackReturn.ERROR and self._node_machine.state == _machine.ERRORPROCESSING:
            self._node_conclude(self._node_call_for(before))
        return ended

    def _node_call_for(self, before: LifecycleState) -> TransitionCallbackReturn:
        node: Any = self
        callback: Callable[[LifecycleState], Any] = getattr(self, _CALLBACKS[self._node_machine.state])
        try:
            found: TransitionCallbackReturn = TransitionCallbackReturn(callback(before))
        except Exception as error:
            node.get_logger().error(
                f"{_CALLBACKS[self._node_machine.state]} raised {type(error).__name__}: {error}"
            )
            return TransitionCallbackReturn.ERROR
        return found

    def _node_conclude(self, ended: TransitionCallbackReturn) -> None:
        found = self._node_machine.find(ended.to_label())
        assert found is not None
        self._node_go(found)

    def _node_go(self, transition: Transition) -> None:
        self._node_machine.state = transition.goal
        if self._node_transition_event is None:
            return
        node: Any = self
        event = self._node_transition_event.msg_type(timestamp=node.get_clock().now().nanoseconds)
        described = _described(transition)
        event.transition, event.start_state = described.transition, described.start_state
        event.goal_state = described.goal_state
        self._node_transition_event.publish(event)

    # -- what others ask

    def _node_on_change_state(self, request: Any, response: Any) -> Any:
        which = request.transition.label or request.transition.id
        response.success = self._node_change(which) is TransitionCallbackReturn.SUCCESS
        return response

    def _node_on_get_state(self, request: Any, response: Any) -> Any:
        response.current_state = _state(self._node_machine.state)
        return response

    def _node_on_get_states(self, request: Any, response: Any) -> Any:
        response.available_states = [_state(number) for number in STATES]
        return response

    def _node_on_get_transitions(self, request: Any, response: Any) -> Any:
        response.available_transitions = _all_described(self._node_machine.available())
        return response

    def _node_on_get_graph(self, request: Any, response: Any) -> Any:
        response.available_transitions = _all_described(TRANSITIONS)
        return response

    # -- managed entities; a subclass that overrides these calls them too

    def add_managed_entity(self, entity: ManagedEntity) -> None:
        """Tell it of every transition. Raises TypeError for what is no ManagedEntity."""
        if not isinstance(entity, ManagedEntity):
            raise TypeError("Expected a rclpy.lifecycle.ManagedEntity instance.")
        self._node_managed.append(entity)

    def _node_tell(self, name: str, state: Any) -> TransitionCallbackReturn:
        for entity in list(self._node_managed):
            ended = getattr(entity, name)(state)
            if not isinstance(ended, TransitionCallbackReturn):
                raise TypeError(f"{name}() of {entity!r} should return a TransitionCallbackReturn")
            if ended is not TransitionCallbackReturn.SUCCESS:
                return ended
        return TransitionCallbackReturn.SUCCESS

    def on_configure(self, state: Any) -> TransitionCallbackReturn:
        return self._node_tell("on_configure", state)

    def on_cleanup(self, state: Any) -> TransitionCallbackReturn:
        return self._node_tell("on_cleanup", state)

    def on_shutdown(self, state: Any) -> TransitionCallbackReturn:
        return self._node_tell("on_shutdown", state)

    def on_activate(self, state: Any) -> TransitionCallbackReturn:
        return self._node_tell("on_activate", state)

    def on_deactivate(self, state: Any) -> TransitionCallbackReturn:
        return self._node_tell("on_deactivate", state)

    def on_error(self, state: Any) -> TransitionCallbackReturn:
        return self._node_tell("on_error", state)

    # -- publishers

    def create_lifecycle_publisher(self, *args: Any, **kwargs: Any) -> LifecyclePublisher:
        """A publisher that publishes while the node is active; takes what `create_publisher` takes."""
        node: Any = self
        made: LifecyclePublisher = node.create_publisher(*args, **kwargs, publisher_class=LifecyclePublisher)
        self._node_managed.append(made)
        return made

    def destroy_lifecycle_publisher(self, publisher: LifecyclePublisher) -> bool:
        """Withdraw such a publisher; False where it is none of this node."""
        if publisher in self._node_managed:
            self._node_managed.remove(publisher)
        node: Any = self
        destroyed: bool = node.destroy_publisher(publisher)
        return destroyed


def _state(number: int) -> Any:
    return message_class("lifecycle_msgs/msg/State")(id=number, label=STATES[number])


def _described(one: Transition) -> Any:
    made = message_class("lifecycle_msgs/msg/TransitionDescription")()
    made.transition.id, made.transition.label = one.number, one.label
    made.start_state, made.goal_state = _state(one.start), _state(one.goal)
    return made


def _all_described(transitions: Iterable[Transition]) -> list[Any]:
    return [_described(one) for one in transitions]


class LifecycleNode(LifecycleNodeMixin, Node):
    """A managed node; takes what Node takes. Override its `on_` methods."""

    def __init__(self, node_name: str, *, enable_communication_interface: bool = True, **kwargs: Any) -> None:
        Node.__init__(self, node_name, **kwargs)
        LifecycleNodeMixin.__init__(self, enable_communication_interface=enable_communication_interface)


__all__ = ["LifecycleNode", "LifecycleNodeMixin", "LifecycleState", "TransitionCallbackReturn"]
