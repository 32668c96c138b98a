"""What a node on MicroPython is on the ROS 2 network: a participant of its own."""

from roslet.engine.ros2.services import ServiceClient, ServiceServer
from roslet.engine.rtps.events import EndpointMatched, QosIncompatible, SamplesLost
from roslet.engine.rtps.history import HistoryFull
from roslet.engine.rtps.limits import Limits
from roslet.errors import NodeClosed, RosletError, UnknownType
from roslet.io.micropython.udp import Domain
from roslet.names.networks import parse_ros2_network
from roslet.names.ros2 import (
    REPLY,
    REQUEST,
    TOPIC,
    check_namespace,
    check_node_name,
    dds_topic,
    dds_type,
    expand,
)
from roslet.node.micropython import bounds, endpoints
from roslet.node.micropython.endpoints import Future
from roslet.node.micropython.node import environment
from roslet.node.micropython.types import message_class, service_class
from roslet.node.qos import QoS
from roslet.node.ros2.qos import to_dds
from roslet.wire.rtps.data import FLAG_D

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.node.micropython.node import Node

_VARIABLES = ("ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_STATIC_PEERS", "ROS_LOCALHOST_ONLY")
# rcl_interfaces/msg/Log numbers the levels otherwise.
_LEVELS = {1: 10, 2: 20, 4: 30, 8: 40, 16: 50}
# Seconds that closing a node gives reliable subscribers to acknowledge what was published.
CLOSE_TIMEOUT = 0.25
# Log entries that are kept for whoever comes late.
ROSOUT_DEPTH = 4


class Ros2Network:
    """`url` as for `roslet.Node`, but that `interface=` takes addresses only."""

    def __init__(self, node: "Node", name: str, url: "str | None", namespace: str) -> None:
        self.node = node
        self.base_name = check_node_name(name)
        if namespace and not namespace.startswith("/"):
            namespace = "/" + namespace
        self.namespace = check_namespace(namespace or "/")
        self.name = ("" if self.namespace == "/" else self.namespace) + "/" + name
        said = {}
        for variable in _VARIABLES:
            said[variable] = environment(variable) or ""
        self._settings = parse_ros2_network(url, said)
        self.domain = Domain(node.loop, self._settings, bounds.DATAGRAM, bounds.FRAGMENT, _limits())
        self.participant = self.domain.participant
        self.context = self.domain.context
        self.counters = self.participant.counters
        self.handle = self.context.add_node(name, self.namespace, node.loop.now())
        self.topics = endpoints.Topics()
        self._parameters: Any = None
        self.domain.flush()

    @property
    def url(self) -> str:
        """In full."""
        return self._settings.url

    def begin(self) -> None:
        """Log to /rosout, where the bundle has its type."""
        try:
            message_class("ros2", "rcl_interfaces/msg/Log")
        except UnknownType:
            return
        self.node.log._publisher = self.publisher(
            "/rosout",
            "rcl_interfaces/msg/Log",
            QoS(ROSOUT_DEPTH, durability="transient_local", lifespan=10.0),
        )

    def resolve(self, name: str) -> str:
        return expand(name, self.base_name, self.namespace)

    def own_service(self, name: str) -> str:
        """The full name of a service of the node itself."""
        return self.resolve("~/" + name)

    def publisher(self, topic: str, kind: "Any", qos: QoS) -> "Publisher":
        publisher = Publisher(self, topic, message_class("ros2", kind), qos)
        self.topics.add_publisher(publisher)
        return publisher

    def subscription(
        self, topic: str, kind: "Any", callback: "Callable[[Any], object] | None", qos: QoS, most: int
    ) -> "Subscription":
        subscription = Subscription(self, topic, message_class("ros2", kind), callback, qos, most)
        self.topics.add_subscription(subscription)
        return subscription

    def service(
        self,
        name: str,
        kind: "Any",
        handler: "Callable[[Any], Any]",
        qos: "QoS | None" = None,
        background: bool = False,
    ) -> "Service":
        return Service(self, name, service_class("ros2", kind), handler, qos or QoS(bounds.DEPTH))

    def client(self, name: str, kind: "Any") -> "Client":
        return Client(self, name, service_class("ros2", kind))

    def fill_log_entry(self, entry: "Any", level: int, text: str) -> None:
        stamp = self.node.now()
        entry.stamp.sec, entry.stamp.nanosec = stamp.secs, stamp.nsecs
        entry.level = _LEVELS[level]
        entry.name = self.name[1:].replace("/", ".")
        entry.msg = text

    # -- parameters

    def parameter_api(self) -> "Any":
        """The node's parameters, made when they are first asked for: from then on others find them."""
        if self._parameters is None:
            from roslet.node.micropython.parameters import BoardParameters

            self._parameters = BoardParameters(self, {})
        return self._parameters

    def follow_clock(self, simulated: bool) -> None:
        """Simulated time is not followed; whoever sets it is told in the log."""
        if simulated:
            self.node.log.warning("use_sim_time: this node goes by its own clock")

    # -- what endpoints use

    def happened(self, topic: str, event: "Any") -> None:
        """An event of an endpoint that nobody else looks at."""
        if isinstance(event, QosIncompatible):
            self.node.log.warning("%s: no messages: QoS %s" % (topic, ", ".join(event.policies)))
        elif isinstance(event, SamplesLost):
            self.node._count("messages-lost")

    def close(self) -> None:
        waiting = [one for one in self.topics.publishers if one._writer.proxies]
        if waiting:
            self.node.loop.run_until(
                lambda: not [one for one in waiting if not one._flushed()], CLOSE_TIMEOUT
            )
        self.domain.close()


class Publisher(endpoints.Publisher):
    """A publisher with a writer of its own."""

    def __init__(self, network: Ros2Network, topic: str, kind: "Any", qos: QoS) -> None:
        endpoints.Publisher.__init__(self, network.node, topic, kind, qos)
        self._network = network
        dds = dds_topic(TOPIC, topic)
        network.domain.expect(dds, True)
        self._writer = network.context.create_writer(
            network.handle,
            dds,
            dds_type(kind._type),
            to_dds(qos),
            kind._type_hash,
            network.node.loop.now(),
        )
        network.domain.handle(self._writer.entity_id, self._happened)
        network.domain.flush()

    def _happened(self, event: "Any") -> None:
        self._network.happened(self.topic, event)

    @property
    def subscriber_count(self) -> int:
        return len(self._writer.proxies) + len(self._local)

    def _send(self, message: "Any") -> None:
        network = self._network
        if self not in network.topics.publishers or network.node.is_shutdown:
            raise NodeClosed("the publisher of %s is closed" % self.topic)
        payload = self._part(message.serialize_into(self._buffer, 0))
        writer = self._writer
        if writer.full(len(payload)):  # "keep_all"
            self._wait(len(payload))
        writer.write(payload, network.node.loop.now(), network.node.loop.stamp())
        network.domain.flush()

    def _wait(self, size: int) -> None:
        self.node.loop.run_until(lambda: not self._writer.full(size), 10.0)

    def _flushed(self) -> bool:
        return self._writer.acknowledged(self._writer.last)

    def close(self) -> None:
        network = self._network
        if self in network.topics.publishers:
            network.topics.publishers.remove(self)
            network.domain.handle(self._writer.entity_id, None)
            network.context.delete_writer(network.handle, self._writer, network.node.loop.now())
            network.domain.flush()


class Subscription(endpoints.Subscription):
    """A subscription with a reader of its own."""

    def __init__(
        self,
        network: Ros2Network,
        topic: str,
        kind: "Any",
        callback: "Callable[[Any], object] | None",
        qos: QoS,
        max_message: int,
    ) -> None:
        endpoints.Subscription.__init__(self, network.node, topic, kind, callback, qos)
        self._network = network
        self._most = max_message
        network.domain.take_in(kind)
        dds = dds_topic(TOPIC, topic)
        network.domain.expect(dds, False)
        self._reader = network.context.create_reader(
            network.handle,
            dds,
            dds_type(kind._type),
            to_dds(qos),
            kind._type_hash,
            network.node.loop.now(),
            sink=self._sample,
        )
        network.domain.handle(self._reader.entity_id, self._happened)
        network.domain.flush()

    def _happened(self, event: "Any") -> None:
        self._network.happened(self.topic, event)

    def _sample(self, proxy: "Any", value: "Any", time: "int | None") -> None:
        if not value.flags & FLAG_D:
            return
        payload = value.payload
        if len(payload) > self._most:
            self.node._count("message-too-large")
            return
        self._take_in(payload if isinstance(payload, memoryview) else memoryview(payload), 0, len(payload))

    @property
    def publisher_count(self) -> int:
        return len(self._reader.proxies) + self._network.topics.publishers_of(self)

    def _disconnect(self) -> None:
        network = self._network
        network.topics.remove_subscription(self)
        network.domain.handle(self._reader.entity_id, None)
        network.context.delete_reader(network.handle, self._reader, network.node.loop.now())
        network.domain.flush()


class Service(endpoints.Service):
    """A service with its two endpoints."""

    def __init__(
        self, network: Ros2Network, name: str, kind: "Any", handler: "Callable[[Any], Any]", qos: QoS
    ) -> None:
        endpoints.Service.__init__(self, network.node, name, kind, handler)
        self._network = network
        self.background = False
        network.domain.take_in(kind.Request)
        network.domain.expect(dds_topic(REQUEST, name), False)
        network.domain.expect(dds_topic(REPLY, name), True)
        self._server: ServiceServer | None = ServiceServer(
            network.context,
            network.handle,
            name,
            kind._type,
            to_dds(qos),
            network.node.loop.now(),
            (kind.Request._type_hash, kind.Response._type_hash),
            self._sample,
        )
        network.domain.flush()

    def _sample(self, proxy: "Any", value: "Any", time: "int | None") -> None:
        server = self._server
        request = None if server is None else server.request(proxy, value, time)
        if request is not None:
            body = bytes(request.payload)
            request.payload = b""
            if not self.node.loop.later(self._now, (body, request)):
                self.node._count("requests-full")

    def _now(self, waiting: "Any") -> None:
        body, request = waiting

        def answer(response: "bytes | None", failure: str) -> None:
            server = self._server
            if response is None or server is None:
                return  # ROS 2 has no answer for a failure
            try:
                server.reply(request, response, self.node.loop.now())
            except HistoryFull:
                self.node._count("reply-history-full")
            self._network.domain.flush()

        self._serve(body, answer)

    def close(self) -> None:
        server, self._server = self._server, None
        if server is not None:
            server.close(self.node.loop.now())
            self._network.domain.flush()


class Client(endpoints.Client):
    """A call that is made before a server is there waits for one."""

    def __init__(self, network: Ros2Network, name: str, kind: "Any") -> None:
        endpoints.Client.__init__(self, network.node, name, kind)
        self._network = network
        self._waiting: list[tuple[bytes, Future]] = []
        self._calls: dict[int, Future] = {}
        network.domain.take_in(kind.Response)
        network.domain.expect(dds_topic(REPLY, name), False)
        network.domain.expect(dds_topic(REQUEST, name), True)
        self._client = ServiceClient(
            network.context,
            network.handle,
            name,
            kind._type,
            to_dds(QoS(bounds.DEPTH)),
            network.node.loop.now(),
            (kind.Request._type_hash, kind.Response._type_hash),
            self._sample,
        )
        for endpoint in (self._client.reader, self._client.writer):
            network.domain.handle(endpoint.entity_id, self._matched)
        network.domain.flush()

    def ready(self) -> bool:
        return self._client.ready()

    def _send(self, body: bytes, future: Future) -> None:
        if not self._client.ready():
            if len(self._waiting) >= bounds.DEPTH:
                future.set_exception(RosletError("%s: too many calls wait for a server" % self.name))
            else:
                self._waiting.append((body, future))
            return
        try:
            number = self._client.call(body, self.node.loop.now())
        except RosletError as error:
            future.set_exception(error)
            return
        self._calls[number] = future
        future.add_done_callback(lambda _: self._forget(number))
        self._network.domain.flush()

    def _forget(self, number: int) -> None:
        if self._calls.pop(number, None) is not None:
            self._client.forget(number)

    def _matched(self, event: "Any") -> None:
        if not isinstance(event, EndpointMatched):
            return
        while self._waiting and self._client.ready():
            body, future = self._waiting.pop(0)
            if not future.done():
                self._send(body, future)

    def _sample(self, proxy: "Any", value: "Any", time: "int | None") -> None:
        found = self._client.response(proxy, value)
        if found is not None:
            future = self._calls.pop(found[0], None)
            if future is not None:
                self._end(future, bytes(found[1]))

    def close(self) -> None:
        if not self.closed:
            self.closed = True
            for endpoint in (self._client.reader, self._client.writer):
                self._network.domain.handle(endpoint.entity_id, None)
            self._client.close(self.node.loop.now())
            self._network.domain.flush()


def _limits() -> Limits:
    """Of a machine that has kilobytes where others have gigabytes."""
    return Limits(
        participants=bounds.PARTICIPANTS,
        endpoints=bounds.ENDPOINTS,
        held_samples=bounds.HELD_SAMPLES,
        held_bytes=bounds.HELD_BYTES,
        assemblies=1,
        sample_bytes=bounds.MAX_MESSAGE,
        assembly_bytes=2 * bounds.MAX_MESSAGE,
        events=64,
        all_held_bytes=2 * bounds.HELD_BYTES,
        peer_bytes=bounds.MAX_MESSAGE,
        history_bytes=bounds.HISTORY,
        backlog_bytes=bounds.HISTORY,
        instances=64,
        discovery_bytes=bounds.DISCOVERY,
        discovery_share=bounds.DISCOVERY,
    )
