"""`rclpy.parameter_client`: the parameters of another node."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from roslet.compat.interfaces import message_class
from roslet.compat.rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from roslet.compat.rclpy.qos import QoSProfile, qos_profile_parameter_events, qos_profile_services_default

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from roslet.compat.rclpy.callback_groups import CallbackGroup
    from roslet.compat.rclpy.subscription import Subscription
    from roslet.compat.rclpy.task import Future

_SERVICES = (
    ("list_parameters", "ListParameters"),
    ("set_parameters", "SetParameters"),
    ("get_parameters", "GetParameters"),
    ("set_parameters_atomically", "SetParametersAtomically"),
    ("describe_parameters", "DescribeParameters"),
    ("get_parameter_types", "GetParameterTypes"),
)


class AsyncParameterClient:
    """Asks for and sets the parameters of the node `remote_node_name`. Each call gives a future of the service's response,
    and calls `callback(future)` when it is there."""

    def __init__(
        self,
        node: Any,
        remote_node_name: str,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> None:
        self.remote_node_name = remote_node_name
        self.node = node
        self._clients = {
            name: node.create_client(
                message_class(f"rcl_interfaces/srv/{kind}"),
                f"{remote_node_name}/{name}",
                qos_profile=qos_profile,
                callback_group=callback_group,
            )
            for name, kind in _SERVICES
        }

    def services_are_ready(self) -> bool:
        """Whether the node is there, with all services."""
        return all(client.service_is_ready() for client in self._clients.values())

    def wait_for_services(self, timeout_sec: float | None = None) -> bool:
        """Until it is, for at most `timeout_sec` seconds; whether it is."""
        end = None if timeout_sec is None else time.monotonic() + timeout_sec
        for client in self._clients.values():
            if not client.wait_for_service(None if end is None else max(0.0, end - time.monotonic())):
                return False
        return True

    def _call(self, name: str, callback: Callable[[Future[Any]], Any] | None, **fields: Any) -> Future[Any]:
        client = self._clients[name]
        future: Future[Any] = client.call_async(client.srv_type.Request(**fields))
        if callback is not None:
            future.add_done_callback(callback)
        return future

    def list_parameters(
        self,
        prefixes: list[str] | None = None,
        depth: int | None = None,
        callback: Callable[[Future[Any]], Any] | None = None,
    ) -> Future[Any]:
        """Those below the prefixes, all where there are none, `depth` levels deep, 0 or None for all."""
        return self._call("list_parameters", callback, prefixes=prefixes or [], depth=depth or 0)

    def get_parameters(
        self, names: list[str], callback: Callable[[Future[Any]], Any] | None = None
    ) -> Future[Any]:
        """Their values; none at all where one is not declared."""
        return self._call("get_parameters", callback, names=names)

    def get_parameter_types(
        self, names: list[str], callback: Callable[[Future[Any]], Any] | None = None
    ) -> Future[Any]:
        """Their types."""
        return self._call("get_parameter_types", callback, names=names)

    def describe_parameters(
        self, names: list[str], callback: Callable[[Future[Any]], Any] | None = None
    ) -> Future[Any]:
        """Their descriptors."""
        return self._call("describe_parameters", callback, names=names)

    def set_parameters(
        self, parameters: Sequence[Any], callback: Callable[[Future[Any]], Any] | None = None
    ) -> Future[Any]:
        """Set each by itself. Parameters, or messages of them."""
        return self._call("set_parameters", callback, parameters=_messages(parameters))

    def set_parameters_atomically(
        self, parameters: Sequence[Any], callback: Callable[[Future[Any]], Any] | None = None
    ) -> Future[Any]:
        """Set all or none."""
        return self._call("set_parameters_atomically", callback, parameters=_messages(parameters))

    def delete_parameters(
        self, names: list[str], callback: Callable[[Future[Any]], Any] | None = None
    ) -> Future[Any]:
        """Undeclare them, where their type is dynamic."""
        return self.set_parameters([Parameter(name) for name in names], callback)

    def load_parameter_file(
        self,
        parameter_file: str,
        use_wildcard: bool = False,
        callback: Callable[[Future[Any]], Any] | None = None,
    ) -> Future[Any]:
        """Set what a file says of the node, each by itself."""
        return self.set_parameters(self._of_file(parameter_file, use_wildcard), callback)

    def load_parameter_file_atomically(
        self,
        parameter_file: str,
        use_wildcard: bool = False,
        callback: Callable[[Future[Any]], Any] | None = None,
    ) -> Future[Any]:
        """Set what a file says of the node, all or none."""
        return self.set_parameters_atomically(self._of_file(parameter_file, use_wildcard), callback)

    def _of_file(self, parameter_file: str, use_wildcard: bool) -> list[Any]:
        found = parameter_dict_from_yaml_file(
            parameter_file, use_wildcard, target_nodes=[self.remote_node_name]
        )
        return list(found.values())

    @staticmethod
    def on_parameter_event(
        node: Any,
        callback: Callable[[Any], Any],
        qos_profile: QoSProfile = qos_profile_parameter_events,
        **options: Any,
    ) -> Subscription:
        """A subscription of /parameter_events; the options are those of `Node.create_subscription`."""
        kind = message_class("rcl_interfaces/msg/ParameterEvent")
        made: Subscription = node.create_subscription(
            kind, "/parameter_events", callback, qos_profile, **options
        )
        return made


def _messages(parameters: Sequence[Any]) -> list[Any]:
    return [one.to_parameter_msg() if isinstance(one, Parameter) else one for one in parameters]


__all__ = ["AsyncParameterClient"]
