"""What a node is made of on one kind of network. `Node` holds one of these and turns to it for all that touches the wire."""

from __future__ import annotations

from roslet.errors import Unsupported

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from typing import Any, NoReturn

    from roslet.node.node import Node
    from roslet.node.qos import QoS
    from roslet.node.services import Client, Service
    from roslet.node.topics import Publisher, Subscription


class Network:
    """The contract. What only one of the networks has is no part of it: `Node` asks for that network by `_ros1` or `_ros2`,
    which raise Unsupported on the other.

    Making one settles names and looks at arguments and environment, and touches nothing outside; it raises InvalidName,
    Unsupported. `open` gets sockets; `begin` makes what every node of this network has; then come all the others, in any
    order, by any thread; `say_goodbye` and `shut` end it, after `open` whether or not `begin` went well. `Node` calls
    nothing else behind `shut`, except that it may `resolve` names and look at `counters`.
    """

    title = "a"
    """As in "the ROS 2 network"."""
    dialect: Any = ""
    """As `roslet.gen.runtime` names it: "ros1" or "ros2"."""
    name: str
    """The node's full name."""
    url: str
    """What `Node.network` says, with what the environment told filled in."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.reactor = node.reactor
        self.arguments: Any = None
        """What the arguments said, and `rest`: those that are not ROS's."""

    def open(self) -> None:
        """Get sockets. Raises OSError, Unreachable, and then holds none."""
        raise NotImplementedError

    def begin(self) -> None:
        """Log to /rosout, follow /clock where it is asked for, set the parameters of the arguments. Waits for peers a
        moment at most, and raises for none that is not there."""
        raise NotImplementedError

    def say_goodbye(self) -> None:
        """Tell the others that this node goes, and let out what has been published; waits a moment for both. Never
        raises."""
        raise NotImplementedError

    def shut(self) -> None:
        """Close every endpoint that is left, and the sockets. Never raises."""
        raise NotImplementedError

    def abandon(self) -> None:
        """In a forked child: give back the parent's sockets, and touch nothing else."""
        raise NotImplementedError

    def resolve(self, name: str) -> str:
        """The full name that `name` has for this node, remappings applied. Raises InvalidName."""
        raise NotImplementedError

    def resolve_service(self, name: str) -> str:
        """The same for the name of a service or action, where that makes a difference."""
        return self.resolve(name)

    @property
    def counters(self) -> dict[str, int]:
        """What was dropped or refused, by its named reason: see the tables in `engine.*.reasons`. A copy."""
        raise NotImplementedError

    def count(self, reason: str) -> None:
        """One more of them. Any thread, with or without the reactor's lock."""
        raise NotImplementedError

    def fill_log_entry(self, entry: Any, level: int, text: str) -> None:
        """Put into a message of /rosout what this network's message has; file, function and line are there already."""
        raise NotImplementedError

    # -- endpoints. Names are full; a type is what `own_classes` takes, and raises what that raises. What is returned is
    # announced to others, or will be when they can be reached, and is closed by `shut` at the latest.

    def publisher(self, topic: str, message_type: Any, qos: QoS) -> Publisher:
        """Subscriptions of this process find it as others' do. Raises RosletError where the node may not have another of
        the topic, Unsupported for a policy that the network lacks."""
        raise NotImplementedError

    def subscription(
        self,
        topic: str,
        message_type: Any,
        callback: Callable[..., object] | None,
        qos: QoS,
        max_message: int,
        with_link: bool,
    ) -> Subscription:
        """Type "*" or None: any, delivered as RawMessage. A longer message than `max_message` bytes is dropped and counted.
        Raises Unsupported for a policy that the network lacks, or where it must know the type and does not."""
        raise NotImplementedError

    def service(self, name: str, service_type: Any, handler: Callable[[Any], Any]) -> Service:
        """See `Service` for the handler."""
        raise NotImplementedError

    def client(self, name: str, service_type: Any, persistent: bool) -> Client:
        """The service need not be there. `persistent` is a wish: a network may always, or never, keep a connection."""
        raise NotImplementedError

    # -- parameters: see `GraphApi` for what they mean. Names are as the user gives them. A network that has to ask others
    # serves the loop meanwhile, and raises Unreachable or CallTimeout, NodeClosed after `shut`.

    def get_parameter(self, name: str) -> Any:
        """Raises ParameterNotSet."""
        raise NotImplementedError

    def set_parameter(self, name: str, value: Any) -> None:
        """Whoever has asked by `on_parameter` is told. Raises ParameterRefused, InvalidMessage."""
        raise NotImplementedError

    def delete_parameter(self, name: str) -> None:
        """Whoever has asked by `on_parameter` is told. Raises ParameterNotSet."""
        raise NotImplementedError

    def has_parameter(self, name: str) -> bool:
        """Whether `get_parameter` would find it."""
        raise NotImplementedError

    def parameter_names(self) -> list[str]:
        """In no particular order."""
        raise NotImplementedError

    def on_parameter(self, name: str, callback: Callable[[Any], object]) -> Any:
        """Have `callback(value)` called by `Node._call_back` at each change; the present value, or what stands for none."""
        raise NotImplementedError

    def off_parameter(self, name: str, callback: Callable[[Any], object]) -> None:
        """Undo one of them; one that is not there is no error."""
        raise NotImplementedError

    # -- the graph: raises as parameters do

    def topics(self) -> dict[str, str]:
        """Full names and types."""
        raise NotImplementedError

    def nodes(self) -> list[str]:
        """Full names, sorted."""
        raise NotImplementedError

    def services(self) -> list[str]:
        """Full names, sorted."""
        raise NotImplementedError

    def lacks(self, what: str, why: str = "") -> NoReturn:
        """Raises Unsupported."""
        raise Unsupported(f"the {self.title} network has no {what}{why and ': '}{why}")


def make(
    node: Node,
    name: str,
    network: str | None,
    namespace: str,
    arguments: Sequence[str],
    anonymous: bool,
    environment: Mapping[str, str],
) -> Network:
    """The network that a URL names: its scheme decides; ROS 2 where there is none."""
    if network is not None and network.startswith("ros1"):
        from roslet.node.ros1.network import Ros1Network

        return Ros1Network(node, name, network, namespace, arguments, anonymous, environment)
    from roslet.node.ros2.network import Ros2Network

    return Ros2Network(node, name, network, namespace, arguments, anonymous, environment)


def own_classes(dialect: Any, kind: Any, what: str = "message") -> Any:
    """The class of a type given by name or class; of a class of the other dialect the one of the same name. `what` is
    "message", "service" or "action". Raises Unsupported where `kind` is no such class, UnknownType."""
    from roslet.gen import runtime

    if isinstance(kind, str):
        find: Any = getattr(runtime, what + "_class")
        return find(dialect, kind)
    marks = {"message": ("_spec", "_md5sum"), "service": ("Request",), "action": ("Goal",)}[what]
    if not any(hasattr(kind, mark) for mark in marks) or not hasattr(kind, "_md5sum"):
        raise Unsupported(f"{kind!r} is no {what} class")
    if dialect == "ros1" and kind._md5sum:
        return kind
    return runtime.for_dialect(dialect, kind)
