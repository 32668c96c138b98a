"""The part of a node that is questions and answers: parameters and the graph."""

from __future__ import annotations

from roslet.errors import ParameterNotSet, Unsupported

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.ros2.graph import EndpointInfo
    from roslet.node.future import Future
    from roslet.node.network import Network
    from roslet.node.ros1.network import Ros1Network
    from roslet.node.ros2.network import Ros2Network

# Seconds for one question to the master or to another node.
CALL_TIMEOUT = 10.0
_MISSING: Any = object()


class GraphApi:
    """On ROS 1 every method asks the master, waits for the answer and serves the loop meanwhile; each raises Unreachable
    or CallTimeout where there is none, NodeClosed after `close()`. On ROS 2 parameters are the node's own, and the graph is
    what discovery has told so far: what has just started may be missing for a moment."""

    _network: Network

    def _ros1(self, what: str) -> Ros1Network:
        if self._network.dialect != "ros1":
            raise Unsupported(f"{what}: the ROS 2 network has no master")
        return self._network  # type: ignore[return-value]

    def _ros2(self, what: str) -> Ros2Network:
        if self._network.dialect != "ros2":
            raise Unsupported(f"{what}: the ROS 1 network has no such thing")
        return self._network  # type: ignore[return-value]

    # -- parameters

    def declare_parameter(self, name: str, default: Any = None, **description: Any) -> Any:
        """ROS 2: let the node have a parameter; returns its value, which is that of the arguments where they give one.

        `description`: `read_only`, `dynamic_typing`, `text`, `constraints`, `range` as (from, to) or (from, to, step).
        """
        return self._ros2("declare_parameter").declare_parameter(name, default, **description)

    def get_parameter(self, name: str, default: Any = _MISSING) -> Any:
        """A parameter; on ROS 1 also the dict of all below a namespace. Raises ParameterNotSet where there is none and no
        default."""
        try:
            return self._network.get_parameter(name)
        except ParameterNotSet:
            if default is _MISSING:
                raise
            return default

    def set_parameter(self, name: str, value: Any) -> None:
        """Set a parameter to bool, int, float, str, bytes or a list; on ROS 1 also to a dict, and integers have 32 bits
        there. On ROS 2 one that is not declared is declared.

        Raises ParameterRefused where a callback or the parameter's description refuses the value, on ROS 1 InvalidMessage.
        """
        self._network.set_parameter(name, value)

    def delete_parameter(self, name: str) -> None:
        """Raises ParameterNotSet."""
        self._network.delete_parameter(name)

    def has_parameter(self, name: str) -> bool:
        """Whether there is a parameter, or on ROS 1 a namespace of parameters, of this name."""
        return self._network.has_parameter(name)

    def search_parameter(self, name: str) -> str | None:
        """ROS 1: the full name of the nearest parameter `name`, from this node's namespace upwards."""
        return self._ros1("search_parameter").search_parameter(name)

    def parameter_names(self) -> list[str]:
        """The names of all parameters: of the master on ROS 1 (full names), of this node on ROS 2."""
        return self._network.parameter_names()

    def on_parameter(self, name: str, callback: Callable[[Any], object]) -> Any:
        """Call `callback(value)` inside spin whenever the parameter changes, whoever changed it; returns its present value.

        On ROS 1 the value of a namespace is the dict of all below it, and {} stands for unset; on ROS 2 None does.
        """
        return self._network.on_parameter(name, callback)

    def off_parameter(self, name: str, callback: Callable[[Any], object]) -> None:
        """Undo one `on_parameter` of this callback; on ROS 1, without any left, the master is asked to tell no more.

        A change that is already on its way to spin is still told. Nothing happens where the callback was not set.
        """
        self._network.off_parameter(name, callback)

    # -- the graph

    def topics(self) -> dict[str, str]:
        """Every topic known, with its type."""
        return self._network.topics()

    def nodes(self) -> list[str]:
        """The full names of all nodes, sorted; on ROS 1 of those that have something registered."""
        return self._network.nodes()

    def services(self) -> list[str]:
        """Every service known, sorted."""
        return self._network.services()

    def topic_type(self, topic: str) -> str | None:
        """The type of a topic; None where it is not known."""
        return self.topics().get(self._network.resolve(topic))

    def endpoints(self, topic: str | None = None, node: str | None = None) -> list[EndpointInfo]:
        """ROS 2: the publishers and subscriptions of a topic, or of a node, or all: node, type, hash, QoS, gid."""
        return self._ros2("endpoints").endpoints(topic, node)

    # -- ROS 1 only

    @property
    def uri(self) -> str:
        """ROS 1: where this node's slave API is."""
        return self._ros1("uri").engine.uri

    @property
    def master_uri(self) -> str:
        """ROS 1: the master, as http://host:port."""
        return self._ros1("master_uri").engine.master_uri

    def call_master(self, method: str, *arguments: Any, timeout: float = CALL_TIMEOUT) -> Any:
        """ROS 1: call the master's API; the node's name is put first. Returns the value; raises Fault, Unreachable,
        CallTimeout."""
        return self._ros1("call_master").call_master(method, *arguments, timeout=timeout)

    def call_master_async(self, method: str, *arguments: Any) -> Future[Any]:
        """`call_master` without waiting: a Future of the value."""
        return self._ros1("call_master_async").call_master_async(method, *arguments)

    def call_node(self, uri: str, method: str, *arguments: Any, timeout: float = CALL_TIMEOUT) -> Any:
        """ROS 1: call the slave API of the node at `uri`; this node's name is put first."""
        return self._ros1("call_node").call_node(uri, method, *arguments, timeout=timeout)

    def system_state(self) -> tuple[dict[str, list[str]], dict[str, list[str]], dict[str, list[str]]]:
        """ROS 1: three dicts: topic -> publishers, topic -> subscribers, service -> providers."""
        return self._ros1("system_state").system_state()

    def lookup_node(self, name: str) -> str | None:
        """ROS 1: the URI of a node's slave API; None where the master does not know it."""
        return self._ros1("lookup_node").lookup_node(name)

    def lookup_service(self, name: str) -> str | None:
        """ROS 1: the rosrpc:// URI of a service; None where there is none."""
        return self._ros1("lookup_service").lookup_service(name)
