"""What a node is on the ROS 1 network: an engine, its sockets, and the master that it asks."""

from __future__ import annotations

import itertools
import os
import threading
import time

from roslet.engine.ros1.engine import Engine
from roslet.errors import Fault, RosletError
from roslet.io.ros1 import Ros1Shell, own_host
from roslet.names import (
    Arguments,
    check_base_name,
    check_name,
    join,
    parse_host_port,
    parse_network,
    resolve,
)
from roslet.node.future import Future
from roslet.node.network import Network, own_classes
from roslet.node.qos import QoS
from roslet.node.ros1.master import MasterApi, into
from roslet.node.ros1.services import Ros1Client, Ros1Service
from roslet.node.ros1.topics import Ros1Publisher, Ros1Subscription
from roslet.node.values import parse_value

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from typing import Any

    from roslet.engine.ros1 import graph
    from roslet.node.node import Node

# Seconds that making a publisher, subscription or service waits for the master; after that it goes on in the background.
REGISTER_TIMEOUT = 2.0
# Seconds that closing a node gives the master to hear of it.
CLOSE_TIMEOUT = 0.5

_serial = itertools.count()


class Ros1Network(MasterApi, Network):
    """`url` is "ros1://host:port", or "ros1://" for $ROS_MASTER_URI."""

    title = "ROS 1"
    dialect = "ros1"

    def __init__(
        self,
        node: Node,
        name: str,
        url: str,
        namespace: str,
        arguments: Sequence[str],
        anonymous: bool,
        environment: Mapping[str, str],
    ) -> None:
        super().__init__(node)
        self.arguments: Arguments = Arguments(list(arguments))
        specials = self.arguments.specials
        name = specials.get("name", name)
        if anonymous and "name" not in specials:
            name = f"{name}_{os.getpid()}_{time.time_ns() // 1_000_000 + next(_serial)}"
        check_base_name(name)
        namespace = specials.get("ns") or namespace or environment.get("ROS_NAMESPACE", "")
        self.name = join("/", join(namespace.lstrip("/"), name)) if namespace.strip("/") else "/" + name
        check_name(self.name)
        self.url, master_uri = parse_network(url, specials.get("master") or environment.get("ROS_MASTER_URI"))
        self._remappings = self.arguments.resolved(self.name)
        host = specials.get("hostname") or specials.get("ip")
        self._host = host or own_host(dict(environment), parse_host_port(master_uri)[0])
        self._publishers: dict[str, Ros1Publisher] = {}
        self._subscriptions: list[Ros1Subscription] = []
        self._parameter_callbacks: dict[str, list[Callable[[Any], object]]] = {}
        self._unset = {key: parse_value(text) for key, text in self.arguments.parameters.items()}
        self._counting = threading.Lock()  # publishing threads count too
        self.engine = engine = Engine(self.name, master_uri, self._host, os.getpid())
        engine.on_note = node._note
        engine.on_parameter = self._parameter_changed
        engine.on_master = self._set_own_parameters
        engine.on_shutdown = node._shut_down

    def open(self) -> None:
        with self.reactor.lock:
            self.shell = Ros1Shell(
                self.engine, self.reactor, "127.0.0.1" if self._host in ("127.0.0.1", "localhost") else ""
            )

    def begin(self) -> None:
        rosout = Ros1Publisher(
            self, self.node, "/rosout", own_classes("ros1", "rosgraph_msgs/Log"), QoS(depth=100)
        )
        self.node.log._publisher = self._publishers["/rosout"] = rosout
        known = []

        def done(value: object, error: Exception | None, now: float) -> None:
            known.append(True)
            self._sim_time_known(value, error, now)

        with self.reactor.lock:
            self.engine.watch_parameter("/use_sim_time", done, self.reactor.now())
            self._set_own_parameters()
            self.update()
        # What the node does next may depend on the clock and on its parameters.
        registrations = self.engine.registrations
        self.reactor.run_until(
            lambda: registrations.master_lost or (known and not self._unset), REGISTER_TIMEOUT, user=False
        )

    def _set_own_parameters(self) -> None:
        """Set the private parameters of the arguments that are not set yet: now, or when there is a master."""
        for key, value in list(self._unset.items()):

            def done(_: object, error: Exception | None, now: float, key: str = key) -> None:
                if error is None or isinstance(error, Fault):
                    self._unset.pop(key, None)

            arguments = [self.name, self.resolve("~" + key), value]
            self.engine.call_master("setParam", arguments, done, self.reactor.now())

    def resolve(self, name: str) -> str:
        return resolve(name, self.name, self._remappings)

    # -- endpoints

    def publisher(self, topic: str, message_type: Any, qos: QoS) -> Ros1Publisher:
        message_type = own_classes("ros1", message_type)
        self._check(qos)
        known = self._publishers.get(topic)
        if known is not None:
            if known.type is not message_type:
                raise RosletError(f"{self.name} publishes {topic} already, as {known.type._type}")
            return known
        publisher = Ros1Publisher(self, self.node, topic, message_type, qos)
        self._publishers[topic] = publisher
        for subscription in self._subscriptions:
            self._pair(publisher, subscription)
        self.settle()
        return publisher

    def subscription(
        self,
        topic: str,
        message_type: Any,
        callback: Callable[..., object] | None,
        qos: QoS,
        max_message: int,
        with_link: bool,
    ) -> Ros1Subscription:
        self._check(qos)
        kind = None if message_type in (None, "*") else own_classes("ros1", message_type)
        subscription = Ros1Subscription(self, self.node, topic, kind, callback, qos, max_message, with_link)
        self._subscriptions.append(subscription)
        own = self._publishers.get(topic)
        if own is not None:
            self._pair(own, subscription)
        self.settle()
        return subscription

    def _check(self, qos: QoS) -> None:
        if qos.of_ros2:
            self.lacks(f"QoS {', '.join(qos.of_ros2)}")

    def _pair(self, publisher: Ros1Publisher, subscription: Ros1Subscription) -> None:
        if publisher.topic == subscription.topic and subscription._publisher is None:
            if subscription.type in (None, publisher.type):
                subscription._publisher = publisher
                publisher._attach(subscription)
            else:
                self.node.log.error(f"{publisher.topic}: published and subscribed here with different types")

    def service(self, name: str, service_type: Any, handler: Callable[[Any], Any]) -> Ros1Service:
        service = Ros1Service(self, self.node, name, own_classes("ros1", service_type, "service"), handler)
        self.settle()
        return service

    def client(self, name: str, service_type: Any, persistent: bool) -> Ros1Client:
        kind = own_classes("ros1", service_type, "service")
        return Ros1Client(self, self.node, name, kind, persistent)

    # -- time and log

    def _parameter_changed(self, key: str, value: object) -> None:
        if key == "/use_sim_time":
            self._sim_time_known(value, None, 0.0)
        for callback in self._parameter_callbacks.get(key, ()):
            self.node._call_back(callback, value)

    def _sim_time_known(self, value: object, error: Exception | None, now: float) -> None:
        clock = self.node.clock
        if error is not None or value is not True or clock.simulated:
            return
        clock.simulate()
        clock_type = own_classes("ros1", "rosgraph_msgs/Clock")

        def sink(view: memoryview, start: int, end: int, link: object) -> None:
            try:
                message: Any = clock_type.deserialize_from(view, start, end)
            except RosletError:
                self.count("malformed-message")
                return
            clock.advance(message.clock.secs, message.clock.nsecs)

        entry = self.engine.subscribe(
            "/clock",
            clock_type._type,
            clock_type._md5sum,
            clock_type._full_text,
            sink,
            self.reactor.now(),
            background=True,
        )
        entry.on_link = None
        self.reactor.call_soon(self.update)

    def fill_log_entry(self, entry: Any, level: int, text: str) -> None:
        entry.header.stamp = self.node.now()
        entry.level = level
        entry.name = self.name
        entry.msg = text
        entry.topics = list(self.engine.publications)

    @property
    def counters(self) -> dict[str, int]:
        return dict(self.engine.counters)

    def count(self, reason: str) -> None:
        with self._counting:
            self.engine.count(reason)

    # -- the end

    def shut(self) -> None:
        self.shell.close()
        # Whoever publishes is told; whoever waits for a message goes on.
        for publisher in list(self._publishers.values()):
            publisher.close()
        for subscription in list(self._subscriptions):
            subscription.close()

    def say_goodbye(self) -> None:
        """The master is told, and a subscriber that reads gets the last message whole."""
        engine = self.engine
        left: list[tuple[str, list[object], Future[Any]]] = []
        with self.reactor.lock:
            calls = engine.begin_close(self.reactor.now())
            for method, arguments in calls:
                future: Future[Any] = Future(self.reactor, method)
                engine.call_master(method, arguments, into(future), self.reactor.now())
                left.append((method, arguments, future))
            self.update()

        def said() -> bool:
            return not self.shell.unsent and all(future.done() for _, _, future in left)

        if self.reactor.run_until(said, CLOSE_TIMEOUT / 2, user=False):
            return
        # A Ctrl-C may have come in the midst of a call of the master, which is never answered then; the connection is stuck.
        with self.reactor.lock:
            for method, arguments, future in left:
                if not future.done():
                    engine.call_slave(engine.master_uri, method, arguments, into(future), self.reactor.now())
            self.update()
        self.reactor.run_until(said, CLOSE_TIMEOUT / 2, user=False)

    def abandon(self) -> None:
        self.shell.abandon()

    # -- what publishers and their like use

    def settle(self) -> None:
        """Wait a moment for the master, so that what was just made is known when the call returns."""
        registrations = self.engine.registrations
        self.reactor.run_until(
            lambda: registrations.settled or registrations.master_lost, REGISTER_TIMEOUT, user=False
        )

    def update(self) -> None:
        """Do what the engine has pending; with the reactor's lock held."""
        self.shell.update()

    def send_datagram(self, datagram: bytes, address: tuple[str, int]) -> bool:
        return self.shell._datagrams.send(datagram, address)

    def advertise(self, publisher: Ros1Publisher) -> graph.Publication:
        kind, qos = publisher.type, publisher.qos
        with self.reactor.lock:  # until it is left, no subscriber can come
            entry = self.engine.advertise(
                publisher.topic,
                kind._type,
                kind._md5sum,
                kind._full_text,
                qos.durability == "transient_local",
                0 if qos.history == "keep_all" else qos.depth,
                self.reactor.now(),
            )
            entry.lock = publisher._lock
            entry.on_link = publisher._link_changed
            self.update()
        return entry

    def unadvertise(self, publisher: Ros1Publisher, entry: graph.Publication) -> None:
        self._publishers.pop(publisher.topic, None)
        with self.reactor.lock:
            for subscription in publisher._local:
                if isinstance(subscription, Ros1Subscription):
                    subscription._publisher = None
            if not self.node.is_shutdown:
                self.engine.unadvertise(entry, self.reactor.now())
                self.update()

    def subscribe(self, subscription: Ros1Subscription, sink: Any, max_frame: int) -> graph.Subscription:
        kind = subscription.type
        with self.reactor.lock:
            entry = self.engine.subscribe(
                subscription.topic,
                "*" if kind is None else kind._type,
                "*" if kind is None else kind._md5sum,
                "" if kind is None else kind._full_text,
                sink,
                self.reactor.now(),
                max_frame,
                "udp" if subscription.qos.reliability == "best_effort" else "tcp",
                copies=kind is not None and kind._views,
            )
            entry.on_link = subscription._link_changed
            self.update()
        return entry

    def unsubscribe(self, subscription: Ros1Subscription, entry: graph.Subscription) -> None:
        if subscription in self._subscriptions:
            self._subscriptions.remove(subscription)
        if subscription._publisher is not None:
            subscription._publisher._detach(subscription)
        with self.reactor.lock:
            if not self.node.is_shutdown:
                self.engine.unsubscribe(entry, self.reactor.now())
                self.update()

    def offer(self, service: Any, serve: Any) -> graph.ServiceOffer:
        """`service` has a `name` and a `type`."""
        kind = service.type
        with self.reactor.lock:
            entry = self.engine.offer_service(
                service.name,
                kind._type,
                kind._md5sum,
                (kind.Request._type, kind.Response._type),
                serve,
                self.reactor.now(),
            )
            self.update()
        return entry

    def withdraw(self, entry: graph.ServiceOffer) -> None:
        with self.reactor.lock:
            if not self.node.is_shutdown:
                self.engine.withdraw_service(entry, self.reactor.now())
                self.update()
