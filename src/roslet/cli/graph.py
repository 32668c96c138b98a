"""What commands ask about a network, whichever it is. `open_graph` gives one that answers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

from roslet.cli.options import USAGE, CommandError

if TYPE_CHECKING:
    from types import TracebackType

    from typing_extensions import Self

    from roslet.cli.parameters import ParameterStore
    from roslet.cli.ros1.graph import Ros1Graph
    from roslet.cli.ros2.graph import Ros2Graph
    from roslet.idl import Dialect


class Graph(ABC):
    """The contract, and a context manager. What is asked first is asked anew by a new object only.

    publishers, subscribers   topic to the names of the nodes of its endpoints; a node with two has its name there twice
    services                  service to the names of the nodes that offer it
    types                     topic to its type; "*" where nobody has said, several with commas where they disagree

    The methods that raise raise CommandError, for a person to read.
    """

    dialect: Dialect

    @property
    @abstractmethod
    def publishers(self) -> dict[str, list[str]]: ...

    @property
    @abstractmethod
    def subscribers(self) -> dict[str, list[str]]: ...

    @property
    @abstractmethod
    def services(self) -> dict[str, list[str]]: ...

    @property
    @abstractmethod
    def types(self) -> dict[str, str]: ...

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @abstractmethod
    def close(self) -> None:
        """Ask nothing more."""

    def topics(self) -> list[str]:
        """Every topic that is published or subscribed, sorted."""
        return sorted({*self.publishers, *self.subscribers})

    @abstractmethod
    def nodes(self) -> list[str]:
        """Every node, sorted."""

    def hidden(self, name: str) -> bool:
        """Whether a list leaves out the name where nobody asks for all."""
        return False

    @abstractmethod
    def endpoints_info(self, topic: str) -> dict[str, list[dict[str, Any]]]:
        """`publishers` and `subscribers` of a topic, each with what this network knows of it, as JSON data."""

    @abstractmethod
    def endpoint_rows(self, endpoints: list[dict[str, Any]], verbose: bool) -> list[tuple[str, ...]]:
        """The same for a person: a row, or several, for each."""

    @abstractmethod
    def service_type(self, name: str) -> str:
        """The type of a service; "*" where its server does not say it. Raises where there is no such service."""

    @abstractmethod
    def service_info(self, name: str) -> dict[str, Any]:
        """What this network knows of a service, as JSON data: `type`, `nodes` and more, and a title for each in
        `service_titles`. Raises where there is no such service."""

    service_titles: tuple[tuple[str, str], ...] = ()

    @abstractmethod
    def has_service(self, name: str) -> bool:
        """Whether the service is there now."""

    @abstractmethod
    def node_info(self, name: str) -> tuple[dict[str, Any], str]:
        """What is known of a node, as JSON data, and what could not be learnt ("" where all could). Raises where there is no
        such node."""

    @abstractmethod
    def print_node(self, described: dict[str, Any]) -> None:
        """Print what `node_info` found."""

    @abstractmethod
    def parameters(self) -> ParameterStore:
        """Where parameters are."""


def only_type(name: str, kind: str, remedy: str) -> str:
    """`kind`, what a graph says of the type of `name`, where that is one. Raises CommandError (wrong usage)."""
    if ", " in kind:
        raise CommandError(f"{name} has several types, {kind}; {remedy}", USAGE)
    return kind


def open_graph(network: str) -> Graph:
    """The graph of the network that a command was given; on ROS 2, after discovery had its time.

    Raises CommandError where a master is needed and does not answer, as soon as it is asked.
    """
    return _ros1(network) if is_ros1(network) else _ros2(network)


def _ros1(network: str) -> Ros1Graph:
    from roslet.cli.ros1.graph import Ros1Graph

    return Ros1Graph(network)


def _ros2(network: str) -> Ros2Graph:
    from roslet.cli.ros2.graph import Ros2Graph

    return Ros2Graph(network)


def is_ros1(network: str) -> bool:
    """Whether a network's URL is one of ROS 1. Raises InvalidName where it is none of either."""
    from roslet.errors import InvalidName

    scheme, found, _ = network.partition("://")
    if not found or scheme not in ("ros1", "ros2"):
        raise InvalidName(f"{network!r} is no network; write ros2://DOMAIN or ros1://host:port")
    return scheme == "ros1"


def open_ros1(network: str, what: str) -> Ros1Graph:
    """The graph of a network that must be one of ROS 1: on ROS 2 there is no `what`. Raises Unsupported."""
    from roslet.errors import Unsupported

    if not is_ros1(network):
        raise Unsupported(f"{what}: the ROS 2 network has no such call")
    return _ros1(network)


def open_ros2(network: str, what: str) -> Ros2Graph:
    """The contrary."""
    from roslet.errors import Unsupported

    if is_ros1(network):
        raise Unsupported(f"{what}: the ROS 1 network has no such thing")
    return _ros2(network)
