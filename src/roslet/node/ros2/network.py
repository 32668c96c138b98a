"""What a node is on the ROS 2 network: a share in a participant, its sockets, and what discovery has told."""

from __future__ import annotations

import itertools
import os
import threading
import time

from roslet.errors import InvalidName, Unsupported
from roslet.names import REQUEST, TOPIC, Ros2Arguments, dds_topic, dds_type, parse_ros2_network, resolve_ros2
from roslet.node.log import LEVEL_NAMES
from roslet.node.network import Network, own_classes
from roslet.node.ros2 import descriptions
from roslet.node.ros2 import qos as presets
from roslet.node.ros2.parameter_files import overrides_of
from roslet.node.ros2.parameters import NodeParameters
from roslet.node.ros2.process import join
from roslet.node.ros2.services import Ros2Client, Ros2Service
from roslet.node.ros2.topics import Ros2Publisher, Ros2Subscription, pair, unpair
from roslet.wire.tcpros import MAX_FRAME

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from typing import Any

    from roslet.engine.ros2.graph import EndpointInfo, Graph
    from roslet.engine.rtps.reader import Reader, Sink
    from roslet.engine.rtps.writer import Writer
    from roslet.io.ros2 import Ros2Shell
    from roslet.node.node import Node
    from roslet.node.qos import QoS
    from roslet.node.ros2.actions import ActionClient, ActionServer, ServerGoal

# Seconds that closing a node gives reliable subscribers to acknowledge what was published.
CLOSE_TIMEOUT = 0.25
# rcl_interfaces/msg/Log numbers the levels otherwise.
_LEVELS = {1: 10, 2: 20, 4: 30, 8: 40, 16: 50}

_serial = itertools.count()


class Ros2Network(Network):
    """`url` is "ros2://" and what `names.parse_ros2_network` reads."""

    title = "ROS 2"
    dialect = "ros2"

    # What endpoints are made of: another API on these nodes has its own ways of delivering.
    publisher_kind: type[Ros2Publisher] = Ros2Publisher
    subscription_kind: type[Ros2Subscription] = Ros2Subscription
    service_kind: type[Ros2Service] = Ros2Service

    def __init__(
        self,
        node: Node,
        name: str,
        url: str | None,
        namespace: str,
        arguments: Sequence[str] | Ros2Arguments,
        anonymous: bool,
        environment: Mapping[str, str],
    ) -> None:
        super().__init__(node)
        if not isinstance(arguments, Ros2Arguments):
            arguments = Ros2Arguments(list(arguments))
        self.arguments: Ros2Arguments = arguments
        if anonymous:
            name = f"{name}_{os.getpid()}_{time.time_ns() // 1_000_000 + next(_serial)}"
        self.base_name = self.arguments.node_name(name)
        self.namespace = self.arguments.namespace(self.base_name, namespace)
        self.name = f"{'' if self.namespace == '/' else self.namespace}/{self.base_name}"
        self._settings = parse_ros2_network(url, dict(environment))
        self.url = self._settings.url
        self.handle = 0
        self._counting = threading.Lock()
        self._counters: dict[str, int] = {}
        self._publishers: list[Ros2Publisher] = []
        self._subscriptions: list[Ros2Subscription] = []
        self.services_made: list[Ros2Service] = []
        self.clients: list[Ros2Client] = []
        self._clock: Ros2Subscription | None = None

    def open(self) -> None:
        self.process = join(self.reactor, self._settings, self.arguments.enclave or "/", self.node._note)
        shell = self.shell
        try:
            with self.reactor.lock:
                self.handle = shell.context.add_node(self.base_name, self.namespace, self.reactor.now())
                shell.flush()
        except ValueError:
            self.process.leave()
            raise

    @property
    def shell(self) -> Ros2Shell:
        """The sockets, the participant and its context."""
        return self.process.shell

    @property
    def graph(self) -> Graph:
        """What discovery has told. Look at it with the reactor's lock held."""
        return self.process.shell.context.graph

    def begin(self) -> None:
        overrides = overrides_of(self.arguments.overrides, self.base_name, self.name)
        self._begin_log()
        if self.node._seen and self.arguments.switches.get("rosout-logs", True):
            self.node.log._publisher = self.publisher("/rosout", "rcl_interfaces/msg/Log", presets.ROSOUT)
        self.parameters = NodeParameters(self, overrides)
        described = self.parameters.declare("start_type_description_service", True, read_only=True)
        if described and self.node._seen:
            descriptions.offer(self)

    def _begin_log(self) -> None:
        """What `--log-level` and `--disable-stdout-logs` say."""
        log, arguments = self.node.log, self.arguments
        named = arguments.log_levels.get(self.logger, arguments.log_levels.get("", "info")).lower()
        if named not in LEVEL_NAMES:
            raise InvalidName(f"--log-level {named}: expected one of {', '.join(LEVEL_NAMES)}")
        log.level = LEVEL_NAMES[named]
        log.quiet = not arguments.switches.get("stdout-logs", True)

    @property
    def logger(self) -> str:
        """The name of the node's logger."""
        return self.name[1:].replace("/", ".")

    def say_goodbye(self) -> None:
        waiting = [one for one in self._publishers if one._writer is not None and one._writer.proxies]
        if waiting:
            self.reactor.run_until(lambda: all(one._flushed() for one in waiting), CLOSE_TIMEOUT, user=False)

    def shut(self) -> None:
        for publisher in list(self._publishers):
            publisher.close()
        for subscription in list(self._subscriptions):
            subscription.close()
        for service in list(self.services_made):
            service.close()
        for client in list(self.clients):
            client.close()
        shell = self.shell
        with self.reactor.lock:
            now = self.reactor.now()
            shell.context.remove_node(self.handle, now)
            shell.context.flush(now)
            shell.flush()
        self.process.leave()

    def abandon(self) -> None:
        self.process.abandon()

    # -- names, time, log

    def resolve(self, name: str) -> str:
        return resolve_ros2(name, self.base_name, self.namespace, self.arguments.remappings, TOPIC)

    def resolve_service(self, name: str) -> str:
        return resolve_ros2(name, self.base_name, self.namespace, self.arguments.remappings, REQUEST)

    def own_service(self, name: str) -> str:
        """The full name of a service of the node itself."""
        return self.resolve_service("~/" + name)

    def follow_clock(self, simulated: bool) -> None:
        """Go by /clock, or by the wall clock again."""
        clock = self.node.clock
        if simulated and self._clock is None:
            clock.simulate()
            self._clock = self.subscription(
                self.resolve("/clock"), "rosgraph_msgs/msg/Clock", None, presets.CLOCK, MAX_FRAME, False
            )
            self._clock.in_loop(lambda message: clock.advance(message.clock.sec, message.clock.nanosec))
        elif not simulated and self._clock is not None:
            self._clock.close()
            self._clock = None
            clock.wall()

    def now(self) -> int:
        """The wall clock, nanoseconds of the Unix epoch."""
        return time.time_ns()

    def fill_log_entry(self, entry: Any, level: int, text: str) -> None:
        stamp = self.node.now()
        entry.stamp.sec, entry.stamp.nanosec = stamp.secs, stamp.nsecs
        entry.level = _LEVELS[level]
        entry.name = self.logger
        entry.msg = text

    @property
    def counters(self) -> dict[str, int]:
        """This node's own, and those of the participant that it shares."""
        found = dict(self._counters)
        for reason, number in self.shell.participant.counters.items():
            found[reason] = found.get(reason, 0) + number
        return found

    def count(self, reason: str) -> None:
        with self._counting:  # publishing threads count too
            self._counters[reason] = self._counters.get(reason, 0) + 1

    # -- topics

    def publisher(self, topic: str, message_type: Any, qos: QoS) -> Ros2Publisher:
        publisher = self.publisher_kind(self, self.node, topic, own_classes("ros2", message_type), qos)
        self._publishers.append(publisher)
        with self.reactor.lock:
            self.process.publishers.setdefault(topic, []).append(publisher)
            for subscription in self.process.subscriptions.get(topic, ()):
                pair(publisher, subscription)
        return publisher

    def subscription(
        self,
        topic: str,
        message_type: Any,
        callback: Callable[..., object] | None,
        qos: QoS,
        max_message: int = MAX_FRAME,
        with_link: bool = False,
    ) -> Ros2Subscription:
        if message_type in (None, "*"):
            kind, type_name = None, self._type_of(topic)
        else:
            kind = own_classes("ros2", message_type)
            type_name = kind._type
        subscription = self.subscription_kind(
            self, self.node, topic, kind, type_name, callback, qos, max_message, with_link
        )
        self._subscriptions.append(subscription)
        with self.reactor.lock:
            self.process.subscriptions.setdefault(topic, []).append(subscription)
            for publisher in self.process.publishers.get(topic, ()):
                pair(publisher, subscription)
        return subscription

    def _type_of(self, topic: str) -> str:
        types = self.graph_types(topic)
        if len(types) != 1:
            found = f"its publishers have several: {', '.join(types)}" if types else "nobody publishes it yet"
            raise Unsupported(f"{topic}: a subscription of any type needs the topic's type, but {found}")
        return types[0]

    def graph_types(self, topic: str) -> list[str]:
        """The types of a topic's endpoints, sorted."""
        with self.reactor.lock:
            return self.graph.topics().get(topic, [])

    def create_writer(self, publisher: Ros2Publisher) -> Writer:
        kind = publisher.type
        with self.reactor.lock:
            writer = self.shell.context.create_writer(
                self.handle,
                dds_topic(TOPIC, publisher.topic),
                dds_type(kind._type),
                publisher._policies,
                kind._type_hash,
                self.reactor.now(),
            )
            self.shell.handle(writer.entity_id, publisher._happened)
            self.shell.flush()
        return writer

    def create_reader(self, subscription: Ros2Subscription, sink: Sink) -> Reader:
        kind = subscription.type
        with self.reactor.lock:
            reader = self.shell.context.create_reader(
                self.handle,
                dds_topic(TOPIC, subscription.topic),
                dds_type(subscription.type_name),
                subscription._policies,
                "" if kind is None else kind._type_hash,
                self.reactor.now(),
                sink=sink,
            )
            self.shell.handle(reader.entity_id, subscription._happened)
            self.shell.flush()
        return reader

    def delete_publisher(self, publisher: Ros2Publisher, writer: Writer) -> None:
        if publisher in self._publishers:
            self._publishers.remove(publisher)
        with self.reactor.lock:
            self.process.publishers[publisher.topic].remove(publisher)
            for subscription in self.process.subscriptions.get(publisher.topic, ()):
                unpair(publisher, subscription)
            self.shell.context.delete_writer(self.handle, writer, self.reactor.now())
            self.shell.handle(writer.entity_id, None)
            self.shell.flush()

    def delete_subscription(self, subscription: Ros2Subscription, reader: Reader) -> None:
        if subscription in self._subscriptions:
            self._subscriptions.remove(subscription)
        with self.reactor.lock:
            self.process.subscriptions[subscription.topic].remove(subscription)
            for publisher in self.process.publishers.get(subscription.topic, ()):
                unpair(publisher, subscription)
            self.shell.context.delete_reader(self.handle, reader, self.reactor.now())
            self.shell.handle(reader.entity_id, None)
            self.shell.flush()

    # -- services

    def service(
        self,
        name: str,
        service_type: Any,
        handler: Callable[[Any], Any],
        qos: QoS = presets.SERVICES,
        background: bool = False,
    ) -> Ros2Service:
        kind = own_classes("ros2", service_type, "service")
        service = self.service_kind(self, self.node, name, kind, handler, qos, background)
        self.services_made.append(service)
        return service

    def client(
        self, name: str, service_type: Any, persistent: bool = False, qos: QoS = presets.SERVICES
    ) -> Ros2Client:
        client = Ros2Client(self, self.node, name, own_classes("ros2", service_type, "service"), qos)
        self.clients.append(client)
        return client

    # -- actions

    def action_server(
        self,
        name: str,
        action_type: Any,
        handler: Callable[[ServerGoal], Any] | None,
        accepted: Callable[[ServerGoal], object] | None,
        on_goal: Callable[[Any], object] | None,
        on_cancel: Callable[[ServerGoal], object] | None,
        result_timeout: float | None,
    ) -> ActionServer:
        """`name` is full."""
        from roslet.node.ros2.actions import ActionServer  # few nodes have actions

        kind = own_classes("ros2", action_type, "action")
        return ActionServer(self, name, kind, handler, accepted, on_goal, on_cancel, result_timeout)

    def action_client(self, name: str, action_type: Any) -> ActionClient:
        """`name` is full."""
        from roslet.node.ros2.actions import ActionClient

        return ActionClient(self, name, own_classes("ros2", action_type, "action"))

    def stamp(self, nanoseconds: int) -> Any:
        """A builtin_interfaces/Time."""
        sec, nanosec = divmod(nanoseconds, 1_000_000_000)
        return own_classes("ros2", "builtin_interfaces/msg/Time")(sec=sec, nanosec=nanosec)

    def goal_info(self, uuid: bytes, stamp: int) -> Any:
        """An action_msgs/GoalInfo."""
        made = own_classes("ros2", "action_msgs/msg/GoalInfo")(stamp=self.stamp(stamp))
        made.goal_id.uuid = uuid
        return made

    def goal_status(self, uuid: bytes, stamp: int, status: int) -> Any:
        """An action_msgs/GoalStatus."""
        kind = own_classes("ros2", "action_msgs/msg/GoalStatus")
        return kind(goal_info=self.goal_info(uuid, stamp), status=status)

    # -- the graph

    def node_of(self, gid: bytes) -> str:
        """The full name of an endpoint's node, or what stands for it where it is not known."""
        name, namespace = self.graph.node_of(gid)
        return f"{'' if namespace == '/' else namespace}/{name}"

    def topics(self) -> dict[str, str]:
        with self.reactor.lock:
            return {topic: types[0] for topic, types in self.graph.topics().items()}

    def nodes(self) -> list[str]:
        with self.reactor.lock:
            return sorted(one.full_name for one in self.graph.nodes())

    def services(self) -> list[str]:
        with self.reactor.lock:
            return list(self.graph.services())

    def endpoints(self, topic: str | None, node: str | None) -> list[EndpointInfo]:
        full = None if topic is None else self.resolve(topic)
        owner = None
        if node is not None:
            namespace, found, name = node.rpartition("/")
            if not found:
                raise InvalidName(f"{node!r} is no full name of a node")
            owner = (name, namespace or "/")
        with self.reactor.lock:
            return self.graph.endpoints(full, owner)

    # -- parameters

    def declare_parameter(self, name: str, default: Any, **description: Any) -> Any:
        return self.parameters.declare(name, default, **description)

    def get_parameter(self, name: str) -> Any:
        return self.parameters.get(name)

    def set_parameter(self, name: str, value: Any) -> None:
        self.parameters.set(name, value)

    def delete_parameter(self, name: str) -> None:
        self.parameters.undeclare(name)

    def has_parameter(self, name: str) -> bool:
        return self.parameters.store.has(name)

    def parameter_names(self) -> list[str]:
        return self.parameters.store.names()

    def on_parameter(self, name: str, callback: Callable[[Any], object]) -> Any:
        return self.parameters.on(name, callback)

    def off_parameter(self, name: str, callback: Callable[[Any], object]) -> None:
        self.parameters.off(name, callback)
