"""The part of `rclpy.node.Node` that asks who is there."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy.exceptions import NodeNameNonExistentError
from roslet.compat.rclpy.topic_endpoint_info import TopicEndpointInfo
from roslet.names import REPLY, REQUEST, TOPIC, dds_topic

if TYPE_CHECKING:
    from roslet.compat.rclpy._network import RclpyNetwork
    from roslet.compat.rclpy.context import Context
    from roslet.engine.ros2.graph import Graph

    Named = list[tuple[str, list[str]]]


class GraphOfNode:
    """Answers are what discovery has told so far."""

    _node_network: RclpyNetwork
    context: Context

    def _node_check(self) -> None:
        raise NotImplementedError

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        raise NotImplementedError

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        raise NotImplementedError

    def _node_ask(self, question: Any) -> Any:
        """`question(graph)`, with the loop's lock held. Raises InvalidHandle."""
        self._node_check()
        network = self._node_network
        with network.reactor.lock:
            return question(network.graph)

    # -- nodes

    def _node_others(self) -> list[Any]:
        found: list[Any] = self._node_ask(lambda graph: graph.nodes())
        return found

    def get_node_names(self) -> list[str]:
        """The names of all nodes, without their namespaces."""
        return [one.name for one in self._node_others()]

    def get_fully_qualified_node_names(self) -> list[str]:
        """The full names of all nodes."""
        return [one.full_name for one in self._node_others()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """(name, namespace) of all nodes."""
        return [(one.name, one.namespace) for one in self._node_others()]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """(name, namespace, enclave) of all nodes."""
        return [(one.name, one.namespace, one.enclave) for one in self._node_others()]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Until there is a node of this name, for at most `timeout` seconds; whether there is one."""
        if not fully_qualified_node_name.startswith("/"):
            fully_qualified_node_name = "/" + fully_qualified_node_name

        def there() -> bool:
            return fully_qualified_node_name in self.get_fully_qualified_node_names()

        self._node_network.reactor.run_until(lambda: not self.context.ok() or there(), timeout, user=False)
        return self.context.ok() and there()

    # -- topics and services

    def get_topic_names_and_types(self, no_demangle: bool = False) -> Named:
        """(topic, types); with `no_demangle` every topic of DDS by its name there."""
        return list(self._node_ask(lambda graph: graph.topics(mangled=no_demangle)).items())

    def get_service_names_and_types(self) -> Named:
        """(service, types) of all services that somebody serves or calls."""
        return _united(self._node_ask(lambda graph: (graph.services(), graph.clients())))

    def _node_names_of(self, name: str, namespace: str, question: Any) -> Named:
        """Raises NodeNameNonExistentError."""

        def ask(graph: Graph) -> Any:
            if not any((one.name, one.namespace) == (name, namespace) for one in graph.nodes()):
                raise NodeNameNonExistentError(
                    f"cannot get node names for nonexistent node: {namespace} {name}"
                )
            return question(graph)

        return list(self._node_ask(ask).items())

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> Named:
        """(topic, types) that a node publishes. Raises NodeNameNonExistentError."""
        node = (node_name, node_namespace)
        return self._node_names_of(*node, lambda graph: graph.topics(node, True, no_demangle))

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> Named:
        """(topic, types) that a node subscribes. Raises NodeNameNonExistentError."""
        node = (node_name, node_namespace)
        return self._node_names_of(*node, lambda graph: graph.topics(node, False, no_demangle))

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> Named:
        """(service, types) that a node serves. Raises NodeNameNonExistentError."""
        return self._node_names_of(
            node_name, node_namespace, lambda graph: graph.services((node_name, node_namespace))
        )

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> Named:
        """(service, types) that a node calls. Raises NodeNameNonExistentError."""
        return self._node_names_of(
            node_name, node_namespace, lambda graph: graph.clients((node_name, node_namespace))
        )

    # -- endpoints

    def count_publishers(self, topic_name: str) -> int:
        """How many publishers a topic has."""
        topic = dds_topic(TOPIC, self.resolve_topic_name(topic_name))
        return int(self._node_ask(lambda graph: graph.count(topic, True)))

    def count_subscribers(self, topic_name: str) -> int:
        """How many subscriptions a topic has."""
        topic = dds_topic(TOPIC, self.resolve_topic_name(topic_name))
        return int(self._node_ask(lambda graph: graph.count(topic, False)))

    def count_services(self, service_name: str) -> int:
        """How many servers a service has."""
        topic = dds_topic(REQUEST, self.resolve_service_name(service_name))
        return int(self._node_ask(lambda graph: graph.count(topic, False)))

    def count_clients(self, service_name: str) -> int:
        """How many clients a service has."""
        topic = dds_topic(REPLY, self.resolve_service_name(service_name))
        return int(self._node_ask(lambda graph: graph.count(topic, False)))

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """What is known of the publishers of a topic; with `no_mangle` of a topic of DDS by its name there."""
        return self._node_endpoints(topic_name, no_mangle, True)

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """What is known of the subscriptions of a topic."""
        return self._node_endpoints(topic_name, no_mangle, False)

    def _node_endpoints(self, topic: str, no_mangle: bool, writers: bool) -> list[TopicEndpointInfo]:
        if no_mangle:
            found = [
                one
                for one in self._node_ask(lambda graph: graph.endpoints(writers=writers, channel=None))
                if (dds_topic(one.channel, one.name) if one.channel else one.name) == topic
            ]
        else:
            full = self.resolve_topic_name(topic)
            found = self._node_ask(lambda graph: graph.endpoints(full, writers=writers))
        return [TopicEndpointInfo(one) for one in found]


def _united(tables: tuple[dict[str, list[str]], ...]) -> Named:
    found: dict[str, set[str]] = {}
    for table in tables:
        for name, types in table.items():
            found.setdefault(name, set()).update(types)
    return [(name, sorted(found[name])) for name in sorted(found)]


__all__ = ["GraphOfNode"]
