"""What a node on MicroPython is on the ROS 1 network."""

from struct import pack_into

from roslet.engine.ros1 import answers
from roslet.engine.ros1.engine import Engine
from roslet.engine.ros1.links import OPEN
from roslet.errors import (
    Fault,
    NodeClosed,
    ParameterNotSet,
    RosletError,
    ServiceFailed,
    UnknownType,
    Unsupported,
)
from roslet.io.micropython import sockets
from roslet.io.micropython.ros1 import Ros1Shell
from roslet.names.networks import parse_host_port, parse_network
from roslet.names.ros1 import check_base_name, check_name, join, resolve
from roslet.node.micropython import bounds, endpoints
from roslet.node.micropython.endpoints import Future
from roslet.node.micropython.node import environment
from roslet.node.micropython.types import message_class, service_class
from roslet.node.qos import QoS

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.node.micropython.node import Node

# Seconds that making something waits for the master; after that it goes on while the node is served.
REGISTER_TIMEOUT = 2.0
CLOSE_TIMEOUT = 0.5
CALL_TIMEOUT = 10.0


class Ros1Network:
    """`url` as for `roslet.Node`."""

    def __init__(self, node: "Node", name: str, url: str, namespace: str) -> None:
        self.node = node
        check_base_name(name)
        namespace = namespace or environment("ROS_NAMESPACE") or ""
        self.name = join("/", join(namespace.lstrip("/"), name)) if namespace.strip("/") else "/" + name
        check_name(self.name)
        self.url, master = parse_network(url, environment("ROS_MASTER_URI"))
        host = environment("ROS_HOSTNAME") or environment("ROS_IP") or _own_host(parse_host_port(master)[0])
        self.engine = engine = Engine(self.name, master, host)
        engine.chunk = bounds.CHUNK
        engine.room = bounds.ROOM
        engine.max_body = bounds.CALL
        engine.lends = True
        engine.on_note = node._note
        engine.on_parameter = self._parameter_changed
        engine.on_shutdown = node._shut_down
        self.counters = engine.counters
        self.shell = Ros1Shell(engine, node.loop, bounds.CONNECTIONS, bounds.ROOM)
        self._parameters: MasterParameters | None = None
        self.topics = endpoints.Topics()
        self._services: list[Service] = []

    def begin(self) -> None:
        """Log to /rosout, where the bundle has its type."""
        try:
            message_class("ros1", "rosgraph_msgs/Log")
        except UnknownType:
            return
        self.node.log._publisher = self.publisher("/rosout", "rosgraph_msgs/Log", QoS(bounds.DEPTH))

    def resolve(self, name: str) -> str:
        return resolve(name, self.name, {})

    def settle(self) -> None:
        """Wait a moment for the master, so that what was just made is known when the call returns."""
        self.shell.update()
        registrations = self.engine.registrations
        self.node.loop.run_until(lambda: registrations.settled or registrations.master_lost, REGISTER_TIMEOUT)

    def publisher(self, topic: str, kind: "Any", qos: QoS) -> "Publisher":
        kind = message_class("ros1", kind)
        _check(qos)
        for one in self.topics.publishers:
            if one.topic == topic:
                if one.type is not kind:
                    raise RosletError("%s is published already, as %s" % (topic, one.type._type))
                return one  # type: ignore[no-any-return]
        publisher = Publisher(self, topic, kind, qos)
        self.topics.add_publisher(publisher)
        self.settle()
        return publisher

    def subscription(
        self, topic: str, kind: "Any", callback: "Callable[[Any], object] | None", qos: QoS, most: int
    ) -> "Subscription":
        _check(qos)
        subscription = Subscription(self, topic, message_class("ros1", kind), callback, qos, most)
        self.topics.add_subscription(subscription)
        self.settle()
        return subscription

    def service(self, name: str, kind: "Any", handler: "Callable[[Any], Any]") -> "Service":
        service = Service(self, name, service_class("ros1", kind), handler)
        self._services.append(service)
        self.settle()
        return service

    def client(self, name: str, kind: "Any") -> "Client":
        return Client(self, name, service_class("ros1", kind))

    def fill_log_entry(self, entry: "Any", level: int, text: str) -> None:
        entry.header.stamp = self.node.now()
        entry.level = level
        entry.name = self.name
        entry.msg = text
        entry.topics = list(self.engine.publications)

    # -- the master

    def parameter_api(self) -> "MasterParameters":
        if self._parameters is None:
            self._parameters = MasterParameters(self)
        return self._parameters

    def _parameter_changed(self, key: str, value: object) -> None:
        if self._parameters is not None:
            for callback in self._parameters.callbacks.get(key, ()):
                self.node._call_back(callback, value)

    def call_master(self, method: str, arguments: "list[Any]") -> "Any":
        """Call and wait for the answer. Raises Fault, Unreachable, CallTimeout."""
        self.node._check_open()
        future = Future(self.node, method)
        self.engine.call_master(method, arguments, _into(future), self.node.loop.now())
        self.shell.update()
        return future.result(CALL_TIMEOUT)

    def close(self) -> None:
        """Tell the master, then close."""
        engine = self.engine
        left: list[Future] = []
        calls = engine.begin_close(self.node.loop.now())
        for method, arguments in calls:
            future = Future(self.node, method)
            engine.call_master(method, arguments, _into(future), self.node.loop.now())
            left.append(future)
        self.shell.update()
        self.node.loop.run_until(
            lambda: not self.shell.unsent and not [one for one in left if not one.done()], CLOSE_TIMEOUT
        )
        self.shell.close()


class MasterParameters:
    """Parameters of the master. `declare` sets what is not set."""

    def __init__(self, network: Ros1Network) -> None:
        self._network = network
        self.callbacks: dict[str, list[Callable[[Any], object]]] = {}

    def _ask(self, method: str, name: str, *value: "Any") -> "Any":
        network = self._network
        return network.call_master(method, [network.name, network.resolve(name)] + list(value))  # noqa: RUF005

    def declare(self, name: str, default: "Any", **description: "Any") -> "Any":
        if not self.has(name):
            self.set(name, default)
        return self.get(name)

    def get(self, name: str) -> "Any":
        try:
            return self._ask("getParam", name)
        except Fault:
            raise ParameterNotSet("parameter %s is not set" % name) from None

    def set(self, name: str, value: "Any") -> None:
        self._ask("setParam", name, value)
        self._told(name, value)

    def undeclare(self, name: str) -> None:
        try:
            self._ask("deleteParam", name)
        except Fault as error:
            raise ParameterNotSet(error.message) from None
        self._told(name, {})

    def _told(self, name: str, value: "Any") -> None:
        """The master tells everybody of a change but the node that made it."""
        network = self._network
        if network.engine.watches(network.resolve(name)):
            network.engine.parameter_changed(network.resolve(name), value)

    def has(self, name: str) -> bool:
        return bool(self._ask("hasParam", name))

    def names(self) -> "list[str]":
        return answers.parameter_names(self._network.call_master("getParamNames", [self._network.name]))

    def on(self, name: str, callback: "Callable[[Any], object]") -> "Any":
        network = self._network
        full = network.resolve(name)
        self.callbacks.setdefault(full, []).append(callback)
        future = Future(network.node, full)
        network.engine.watch_parameter(full, _into(future), network.node.loop.now())
        network.shell.update()
        return future.result(CALL_TIMEOUT)


class Publisher(endpoints.Publisher):
    """A publisher over TCPROS. What a slow subscriber does not take waits, `qos.depth` messages at most."""

    def __init__(self, network: Ros1Network, topic: str, kind: "Any", qos: QoS) -> None:
        endpoints.Publisher.__init__(self, network.node, topic, kind, qos)
        self._network = network
        self._latched: bytes | None = None
        self._entry = network.engine.advertise(
            topic,
            kind._type,
            kind._md5sum,
            kind._full_text,
            qos.durability == "transient_local",
            qos.depth,
            network.node.loop.now(),
        )
        self._entry.on_link = self._link_changed

    @property
    def subscriber_count(self) -> int:
        return len(self._entry.links) + len(self._local)

    def _send(self, message: "Any") -> None:
        if self.node.is_shutdown or self not in self._network.topics.publishers:
            raise NodeClosed("the publisher of %s is closed" % self.topic)
        if self.type._has_header:
            message.header.seq = self.messages
        buffer = self._buffer
        end = message.serialize_into(buffer, 4)
        pack_into("<I", buffer, 0, end - 4)
        frame = self._part(end)
        for link in self._entry.links:
            channel: Any = link.channel
            if link.queue.bytes == 0:
                sent = channel.send(frame)
                if sent == end:
                    continue
                if channel.closed:
                    continue
                if sent:
                    link.queue.push_rest(bytes(frame[sent:]))
                else:
                    link.queue.push(bytes(frame))
                channel.want_write()
            elif link.queue.push(bytes(frame)):
                self.node._count("send-queue-full")
        if self.qos.durability == "transient_local":
            self._latched = bytes(frame)

    def _link_changed(self, link: "Any", opened: bool) -> None:
        if opened and self._latched is not None:
            link.queue.push(self._latched)
            link.channel.want_write()

    def _flushed(self) -> bool:
        return not [link for link in self._entry.links if link.queue.bytes]

    def close(self) -> None:
        network = self._network
        if self in network.topics.publishers:
            network.topics.publishers.remove(self)
            network.engine.unadvertise(self._entry, network.node.loop.now())
            network.shell.update()


class Subscription(endpoints.Subscription):
    """A subscription over TCPROS."""

    def __init__(
        self,
        network: Ros1Network,
        topic: str,
        kind: "Any",
        callback: "Callable[[Any], object] | None",
        qos: QoS,
        max_message: int,
    ) -> None:
        endpoints.Subscription.__init__(self, network.node, topic, kind, callback, qos)
        self._network = network
        self._entry = network.engine.subscribe(
            topic,
            kind._type,
            kind._md5sum,
            kind._full_text,
            self._sink,
            network.node.loop.now(),
            max_message,
        )

    def _sink(self, view: memoryview, start: int, end: int, link: object) -> None:
        self._take_in(view, start, end)

    @property
    def publisher_count(self) -> int:
        links = [link for link in self._entry.links.values() if link.state == OPEN]
        return len(links) + self._network.topics.publishers_of(self)

    def _disconnect(self) -> None:
        network = self._network
        network.topics.remove_subscription(self)
        network.engine.unsubscribe(self._entry, network.node.loop.now())
        network.shell.update()


class Service(endpoints.Service):
    """A service that is registered with the master."""

    def __init__(self, network: Ros1Network, name: str, kind: "Any", handler: "Callable[[Any], Any]") -> None:
        endpoints.Service.__init__(self, network.node, name, kind, handler)
        self._network = network
        types = (kind.Request._type, kind.Response._type)
        self._entry = network.engine.offer_service(
            name, kind._type, kind._md5sum, types, self._requested, network.node.loop.now()
        )

    def _requested(self, view: memoryview, start: int, end: int, link: "Any") -> None:
        # Answered when no callback runs, which may be at once: the link takes its answer later either way.
        if not self.node.loop.later(self._now, (bytes(view[start:end]), link)):
            raise ServiceFailed("%s: too many requests wait" % self.name)

    def _now(self, request: "Any") -> None:
        body, link = request

        def answer(response: "bytes | None", failure: str) -> None:
            if response is None:
                link.answer(False, failure.encode())
            else:
                link.answer(True, response)
            self._network.engine.touch(link)
            self._network.shell.update()

        self._serve(body, answer)

    def close(self) -> None:
        network = self._network
        if self in network._services:
            network._services.remove(self)
            network.engine.withdraw_service(self._entry, network.node.loop.now())
            network.shell.update()


class Client(endpoints.Client):
    """Each call looks the service up and connects anew, as ROS does by default."""

    def __init__(self, network: Ros1Network, name: str, kind: "Any") -> None:
        endpoints.Client.__init__(self, network.node, name, kind)
        self._network = network

    def _send(self, body: bytes, future: Future) -> None:
        network = self._network
        engine = network.engine

        def found(value: "Any", error: "Exception | None", now: float) -> None:
            if error is not None:
                future.set_exception(error)
                return
            kind = self.type
            header = {
                "callerid": network.name,
                "md5sum": kind._md5sum,
                "service": self.name,
                "type": kind._type,
            }
            try:
                link = engine.service_link(value, header, now)
            except RosletError as bad:
                future.set_exception(bad)
                return
            link.call(body, done)

        def done(answer: "bytes | None", error: "RosletError | None") -> None:
            if answer is None:
                future.set_exception(error or ServiceFailed(self.name))
            else:
                self._end(future, answer)

        engine.call_master("lookupService", [network.name, self.name], found, network.node.loop.now())
        network.shell.update()

    def ready(self) -> bool:
        network = self._network
        try:
            network.call_master("lookupService", [network.name, self.name])
        except RosletError:
            network.node.loop.run_until(lambda: network.node.is_shutdown, 0.1)
            return False
        return True


def _check(qos: QoS) -> None:
    if qos.of_ros2:
        raise Unsupported("the ROS 1 network has no QoS " + ", ".join(qos.of_ros2))


def _own_host(master: str) -> str:
    """What others reach us by."""
    if master in ("localhost", sockets.LOOPBACK):
        return sockets.LOOPBACK
    found = sockets.own_addresses()
    return found[0] if found else sockets.LOOPBACK


def _into(future: Future) -> "Callable[[object, Exception | None, float], None]":
    def done(value: object, error: "Exception | None", now: float) -> None:
        if error is None:
            future.set_result(value)
        else:
            future.set_exception(error)

    return done
