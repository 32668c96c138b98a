"""`rclpy.parameter_event_handler`: callbacks for changes of parameters of any node."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat.interfaces import message_class
from roslet.compat.rclpy.qos import QoSProfile, qos_profile_parameter_events

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


class ParameterCallbackHandle:
    """What removes a callback for one parameter."""

    def __init__(self, parameter_name: str, node_name: str, callback: Callable[[Any], Any]) -> None:
        self.parameter_name = parameter_name
        self.node_name = node_name
        self.callback = callback


class ParameterEventCallbackHandle:
    """What removes a callback for all events."""

    def __init__(self, callback: Callable[[Any], Any]) -> None:
        self.callback = callback


class ParameterEventHandler:
    """Follows /parameter_events. The newest callback is called first; names of nodes may be relative to the node's."""

    def __init__(
        self, node: Any, qos_profile: QoSProfile = qos_profile_parameter_events, **options: Any
    ) -> None:
        self.node = node
        self._qos_profile = qos_profile
        self._of_one: list[ParameterCallbackHandle] = []
        self._of_all: list[ParameterEventCallbackHandle] = []
        kind = message_class("rcl_interfaces/msg/ParameterEvent")
        self._subscription = node.create_subscription(
            kind, "/parameter_events", self._came, qos_profile, **options
        )

    def _came(self, event: Any) -> None:
        for one in list(self._of_one):
            found = self.get_parameter_from_event(event, one.parameter_name, one.node_name)
            if found is not None:
                one.callback(found)
        for every in list(self._of_all):
            every.callback(event)

    def destroy(self) -> None:
        """Follow no more."""
        self.node.destroy_subscription(self._subscription)

    @staticmethod
    def get_parameter_from_event(event: Any, parameter_name: str, node_name: str) -> Any:
        """The parameter's message where the event is of this node and has it new or changed, else None."""
        if event.node != node_name:
            return None
        for one in ParameterEventHandler.get_parameters_from_event(event):
            if one.name == parameter_name:
                return one
        return None

    @staticmethod
    def get_parameters_from_event(event: Any) -> Iterator[Any]:
        """The messages of the parameters that are new or changed."""
        yield from event.new_parameters
        yield from event.changed_parameters

    def add_parameter_callback(
        self, parameter_name: str, node_name: str, callback: Callable[[Any], Any]
    ) -> ParameterCallbackHandle:
        """Call `callback(message)` when this parameter of this node is new or changed."""
        made = ParameterCallbackHandle(parameter_name, self._resolve(node_name), callback)
        self._of_one.insert(0, made)
        return made

    def remove_parameter_callback(self, handle: ParameterCallbackHandle) -> None:
        """Raises ValueError where it is not there any more."""
        self._of_one.remove(handle)

    def add_parameter_event_callback(self, callback: Callable[[Any], Any]) -> ParameterEventCallbackHandle:
        """Call `callback(event)` for every event."""
        made = ParameterEventCallbackHandle(callback)
        self._of_all.insert(0, made)
        return made

    def remove_parameter_event_callback(self, handle: ParameterEventCallbackHandle) -> None:
        """Raises ValueError where it is not there any more."""
        self._of_all.remove(handle)

    def _resolve(self, node_name: str) -> str:
        if not node_name:
            own: str = self.node.get_fully_qualified_name()
            return own
        if node_name.startswith("/"):
            return node_name
        namespace = self.node.get_namespace()
        return f"{'' if namespace == '/' else namespace}/{node_name}"


__all__ = ["ParameterCallbackHandle", "ParameterEventCallbackHandle", "ParameterEventHandler"]
