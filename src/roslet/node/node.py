"""The node."""

from __future__ import annotations

import atexit
import itertools
import os
import sys
import threading
import time
import weakref

from roslet.engine.ros1.engine import Engine
from roslet.errors import (
    CallTimeout,
    Fault,
    NodeClosed,
    RosletError,
    Unsupported,
)
from roslet.io.ros1 import Ros1Shell, own_host
from roslet.io.select import Reactor, reactor
from roslet.names import (
    Arguments,
    check_base_name,
    check_name,
    join,
    parse_host_port,
    parse_network,
    resolve,
)
from roslet.node.clock import Clock, Rate, Timer
from roslet.node.future import Future
from roslet.node.log import Log
from roslet.node.master import MasterApi, into
from roslet.node.qos import QoS
from roslet.node.services import Client, Service
from roslet.node.topics import Publisher, Subscription
from roslet.node.values import parse_value
from roslet.wire.tcpros import MAX_FRAME

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from typing import Any

    from roslet.engine.ros1 import graph
    from roslet.wire.time import Time

# Seconds that making a publisher, subscription or service waits for the master; after that it goes on in the background.
REGISTER_TIMEOUT = 2.0
# Seconds that closing a node gives the master to hear of it.
CLOSE_TIMEOUT = 0.5
# Callbacks that wait for somebody to spin, other than those of topics, which have queues of their own.
MAX_CALLBACKS = 1000

_serial = itertools.count()
_open_nodes: weakref.WeakSet[Node] = weakref.WeakSet()


class Node(MasterApi):
    """A node on a ROS network.

    name       a base name; `__name:=x` among the arguments overrides it
    network    "ros1://host:port", "ros1://" for $ROS_MASTER_URI. Without one: "ros2://", which is not there yet
    namespace  what relative names are in; $ROS_NAMESPACE where empty
    arguments  as in sys.argv[1:]: remappings `a:=b`, private parameters `_p:=v`, `__name __ns __master __ip __hostname`
    anonymous  append something to the name that no other node has

    Callbacks run inside `spin()` and its like, in that thread; `start()` makes a thread that spins. What a callback
    raises comes out of spin. Close the node, or use it as a context manager; at exit what is open is closed.

    Raises InvalidName, Unsupported, OSError where no port can be had.
    """

    def __init__(
        self,
        name: str,
        *,
        network: str | None = None,
        namespace: str = "",
        arguments: Sequence[str] = (),
        anonymous: bool = False,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        env = os.environ if environment is None else environment
        self.arguments = given = Arguments(list(arguments))
        name = given.specials.get("name", name)
        if anonymous and "name" not in given.specials:
            name = f"{name}_{os.getpid()}_{time.time_ns() // 1_000_000 + next(_serial)}"
        check_base_name(name)
        namespace = given.specials.get("ns") or namespace or env.get("ROS_NAMESPACE", "")
        self.name = join("/", join(namespace.lstrip("/"), name)) if namespace.strip("/") else "/" + name
        check_name(self.name)
        self.namespace = self.name[: self.name.rfind("/")] or "/"
        self.network, master_uri = parse_network(
            network, given.specials.get("master") or env.get("ROS_MASTER_URI")
        )
        self._remappings = given.resolved(self.name)
        host = given.specials.get("hostname") or given.specials.get("ip")
        host = host or own_host(dict(env), parse_host_port(master_uri)[0])
        self.reactor: Reactor = reactor()
        self.clock = Clock(self.reactor)
        self.log = Log(self)
        self.is_shutdown = False
        self._on_shutdown: list[Callable[[], object]] = []
        self._parameter_callbacks: dict[str, list[Callable[[Any], object]]] = {}
        self._publishers: dict[str, Publisher] = {}
        self._subscriptions: list[Subscription] = []
        self._spinner: threading.Thread | None = None
        self._closing = threading.Lock()
        self._close_begun = False
        self._callbacks_waiting = 0
        self._futures: weakref.WeakSet[Future[Any]] = weakref.WeakSet()  # those that somebody may wait for
        self._unset = {key: parse_value(text) for key, text in given.parameters.items()}
        self._engine = Engine(self.name, master_uri, host, os.getpid())
        self._engine.on_note = self._note
        self._engine.on_parameter = self._parameter_changed
        self._engine.on_master = self._set_own_parameters
        self._engine.on_shutdown = self._shut_down
        with self.reactor.lock:
            self._shell = Ros1Shell(
                self._engine, self.reactor, "127.0.0.1" if host in ("127.0.0.1", "localhost") else ""
            )
        _open_nodes.add(self)
        try:
            self._begin()
        except BaseException:
            self.close()
            raise

    def _begin(self) -> None:
        """Log to /rosout, follow /clock where it is asked for, set the private parameters of the arguments."""
        rosout = Publisher(self, "/rosout", _message_class("rosgraph_msgs/Log"), QoS(depth=100))
        self.log._publisher = self._publishers["/rosout"] = rosout
        known = []

        def done(value: object, error: Exception | None, now: float) -> None:
            known.append(True)
            self._sim_time_known(value, error, now)

        with self.reactor.lock:
            self._engine.watch_parameter("/use_sim_time", done, self.reactor.now())
            self._set_own_parameters()
            self._update()
        # What the node does next may depend on the clock and on its parameters.
        registrations = self._engine.registrations
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
            self._engine.call_master("setParam", arguments, done, self.reactor.now())

    # -- topics

    def publisher(self, topic: str, type: Any, *, qos: QoS | int | None = None) -> Publisher:  # noqa: A002
        """A publisher of `topic`. `type` is a name such as "std_msgs/String" or a message class.

        A node publishes a topic once: a second call with the same type gives the same publisher.
        Raises InvalidName, UnknownType, NodeClosed, RosletError where the topic has another type here.
        """
        self._check_open()
        full = self.resolve(topic)
        message_type = _message_class(type)
        known = self._publishers.get(full)
        if known is not None:
            if known.type is not message_type:
                raise RosletError(f"{self.name} publishes {full} already, as {known.type._type}")
            return known
        publisher = Publisher(self, full, message_type, _qos(qos))
        self._publishers[full] = publisher
        for subscription in self._subscriptions:
            self._pair(publisher, subscription)
        self._settle()
        return publisher

    def subscribe(
        self,
        topic: str,
        type: Any = "*",  # noqa: A002
        callback: Callable[[Any], object] | None = None,
        *,
        qos: QoS | int | None = None,
        max_message: int = MAX_FRAME,
        with_link: bool = False,
    ) -> Subscription:
        """A subscription of `topic`. `type` as for `publisher`, or "*": any type, delivered as RawMessage.

        `max_message` bounds one message's bytes; a publisher that sends a longer one is disconnected, and the log says so.
        With `with_link` the callback gets (message, link): `link.peer_header` is the publisher's connection header; None
        where the publisher is this node.
        """
        self._check_open()
        full = self.resolve(topic)
        message_type = None if type in (None, "*") else _message_class(type)
        subscription = Subscription(self, full, message_type, callback, _qos(qos), max_message, with_link)
        self._subscriptions.append(subscription)
        own = self._publishers.get(full)
        if own is not None:
            self._pair(own, subscription)
        self._settle()
        return subscription

    def _pair(self, publisher: Publisher, subscription: Subscription) -> None:
        if publisher.topic == subscription.topic and subscription._publisher is None:
            if subscription.type in (None, publisher.type):
                subscription._publisher = publisher
                publisher._attach(subscription)
            else:
                self.log.error(f"{publisher.topic}: published and subscribed here with different types")

    # -- services

    def service(self, name: str, type: Any, handler: Callable[[Any], Any]) -> Service:  # noqa: A002
        """Offer the service `name`; see `Service` for the handler."""
        self._check_open()
        service = Service(self, self.resolve(name), _service_class(type), handler)
        self._settle()
        return service

    def client(self, name: str, type: Any, *, persistent: bool = False) -> Client:  # noqa: A002
        """A client of the service `name`, which need not be there yet."""
        self._check_open()
        return Client(self, self.resolve(name), _service_class(type), persistent)

    # -- time

    def now(self) -> Time:
        """The time: simulated where `/use_sim_time` is true."""
        return self.clock.now()

    def timer(self, period: float, callback: Callable[[], object], *, once: bool = False) -> Timer:
        """Call `callback()` every `period` seconds inside spin."""
        self._check_open()
        return Timer(self.clock, period, callback, once)

    def rate(self, hz: float) -> Rate:
        """Keeps a loop at `hz` turns a second: call its `sleep()` once a turn. Raises ValueError unless `hz` is positive."""
        return Rate(self.clock, self.sleep, hz)

    def sleep(self, seconds: float) -> None:
        """Serve callbacks for `seconds` of the node's time; returns early when the node shuts down."""
        if not self.clock.simulated:
            self.reactor.run_until(lambda: self.is_shutdown, seconds)
            return
        self.reactor.run_until(lambda: self.is_shutdown or self.clock.nanoseconds())
        begin = self.clock.seconds()
        end = begin + seconds
        self.reactor.run_until(lambda: self.is_shutdown or not begin <= self.clock.seconds() < end)

    def _parameter_changed(self, key: str, value: object) -> None:
        if key == "/use_sim_time":
            self._sim_time_known(value, None, 0.0)
        for callback in self._parameter_callbacks.get(key, ()):
            self._call_back(callback, value)

    def _sim_time_known(self, value: object, error: Exception | None, now: float) -> None:
        if error is not None or value is not True or self.clock.simulated:
            return
        self.clock.simulate()
        clock_type = _message_class("rosgraph_msgs/Clock")

        def sink(view: memoryview, start: int, end: int, link: object) -> None:
            try:
                message: Any = clock_type.deserialize_from(view, start, end)
            except RosletError:
                self._count("malformed-message")
                return
            self.clock.advance(message.clock.secs, message.clock.nsecs)

        entry = self._engine.subscribe(
            "/clock",
            clock_type._type,
            clock_type._md5sum,
            clock_type._full_text,
            sink,
            self.reactor.now(),
            background=True,
        )
        entry.on_link = None
        self.reactor.call_soon(self._update)

    # -- names

    def resolve(self, name: str) -> str:
        """The full name that `name` has here, remappings applied. Raises InvalidName."""
        return resolve(name, self.name, self._remappings)

    @property
    def uri(self) -> str:
        """Where this node's slave API is."""
        return self._engine.uri

    @property
    def master_uri(self) -> str:
        """The master, as http://host:port."""
        return self._engine.master_uri

    @property
    def counters(self) -> dict[str, int]:
        """What was dropped or refused, by its named reason."""
        return dict(self._engine.counters)

    # -- running

    def spin(self, timeout: float | None = None) -> None:
        """Serve callbacks until the node shuts down, or for `timeout` seconds."""
        self.reactor.run_until(lambda: self.is_shutdown, timeout)

    def spin_once(self, timeout: float = 0.0) -> None:
        """Serve what is ready; wait at most `timeout` seconds for something."""
        turned: list[bool] = []
        if timeout <= 0:
            self.reactor.call_soon(lambda: turned.append(True), user=True)
            self.reactor.run_until(lambda: turned, 1.0)
        else:
            self.reactor.run_turn(timeout)

    def spin_until(self, predicate: Callable[[], object], timeout: float | None = None) -> bool:
        """Serve callbacks until `predicate()` is true; false after `timeout` seconds or when the node shuts down."""
        self.reactor.run_until(lambda: predicate() or self.is_shutdown, timeout)
        return bool(predicate())

    def start(self) -> None:
        """Spin in a thread of its own from now on; callbacks run there. A callback that raises is logged."""
        if self._spinner is None:
            self._spinner = threading.Thread(target=self._spin_on, name=f"roslet {self.name}", daemon=True)
            self._spinner.start()

    def _spin_on(self) -> None:
        while not self.is_shutdown:
            try:
                self.spin()
            except Exception as error:
                self.log.error(f"a callback raised {type(error).__name__}: {error}")
                sys.excepthook(type(error), error, error.__traceback__)

    def on_shutdown(self, function: Callable[[], object]) -> None:
        """Call `function()` when the node closes, whoever asks for it."""
        self._on_shutdown.append(function)

    def _shut_down(self, reason: str) -> None:
        """Somebody asks this node to end: the master where a node of the same name has come, or `rosnode kill`."""
        self.log.warning(f"shutting down: {reason}")
        threading.Thread(target=self.close, name="roslet-close").start()

    def close(self) -> None:
        """Unregister everything and close every connection. Closing twice is allowed, from on_shutdown functions too."""
        with self._closing:
            if self._close_begun:
                return
            self._close_begun = True
        for function in self._on_shutdown:
            try:
                function()
            except Exception as error:
                self.log.error(f"an on_shutdown function raised {type(error).__name__}: {error}")
        self.log._publisher = None
        self.is_shutdown = True
        _open_nodes.discard(self)
        self._say_goodbye()
        self.clock.close()
        for future in list(self._futures):
            future.set_exception(NodeClosed(f"{self.name} is closed"))
        self._shell.close()
        # Whoever publishes is told; whoever waits for a message goes on.
        for publisher in list(self._publishers.values()):
            publisher.close()
        for subscription in list(self._subscriptions):
            subscription.close()
        self.reactor.wake()

    def _say_goodbye(self) -> None:
        """Tell the master, and let out what has been published: a subscriber that reads gets the last message whole."""
        engine = self._engine
        left: list[tuple[str, list[object], Future[Any]]] = []
        with self.reactor.lock:
            calls = [] if engine.registrations.master_lost else engine.closing_calls()
            engine.registrations.forget()
            for method, arguments in calls:
                future: Future[Any] = Future(self.reactor, method)
                engine.call_master(method, arguments, into(future), self.reactor.now())
                left.append((method, arguments, future))
            self._update()

        def said() -> bool:
            return not self._shell.unsent and all(future.done() for _, _, future in left)

        if self.reactor.run_until(said, CLOSE_TIMEOUT / 2, user=False):
            return
        # A Ctrl-C may have come in the midst of a call of the master, which is never answered then; the connection is stuck.
        with self.reactor.lock:
            for method, arguments, future in left:
                if not future.done():
                    engine.call_slave(engine.master_uri, method, arguments, into(future), self.reactor.now())
            self._update()
        self.reactor.run_until(said, CLOSE_TIMEOUT / 2, user=False)

    def __enter__(self) -> Node:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Node({self.name!r}, network={self.network!r})"

    # -- what publishers and their like use

    def _check_open(self) -> None:
        if self.is_shutdown:
            raise NodeClosed(f"{self.name} is closed")

    def _future(self, what: str) -> Future[Any]:
        """The answer to something that is asked now; closing the node ends the wait for it."""
        future: Future[Any] = Future(self.reactor, what)
        self._futures.add(future)
        return future

    def _settle(self) -> None:
        """Wait a moment for the master, so that what was just made is known when the call returns."""
        registrations = self._engine.registrations
        self.reactor.run_until(
            lambda: registrations.settled or registrations.master_lost, REGISTER_TIMEOUT, user=False
        )

    def _update(self) -> None:
        self._shell.update()

    def _count(self, reason: str) -> None:
        with self._closing:  # publishing threads count too
            self._engine.count(reason)

    def _call_back(self, function: Callable[..., object], *arguments: object) -> None:
        """Call `function` inside spin. Peers cause these calls, so there is a bound to how many may wait."""
        if self._callbacks_waiting >= MAX_CALLBACKS:
            self._count("too-many-callbacks")
            return
        self._callbacks_waiting += 1

        def call() -> None:
            self._callbacks_waiting -= 1
            if not self.is_shutdown:
                function(*arguments)

        self.reactor.call_soon(call, user=True)

    def _note(self, text: str) -> None:
        self.reactor.call_soon(lambda: self.log.warning(text))

    def _published_topics(self) -> list[str]:
        return list(self._engine.publications)

    def _send_datagram(self, datagram: bytes, address: tuple[str, int]) -> bool:
        return self._shell._datagrams.send(datagram, address)

    def _advertise(self, publisher: Publisher) -> graph.Publication:
        kind, qos = publisher.type, publisher.qos
        with self.reactor.lock:  # until it is left, no subscriber can come
            entry = self._engine.advertise(
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
            self._update()
        return entry

    def _unadvertise(self, publisher: Publisher, entry: graph.Publication) -> None:
        self._publishers.pop(publisher.topic, None)
        with self.reactor.lock:
            for subscription in publisher._local:
                subscription._publisher = None
            if not self.is_shutdown:
                self._engine.unadvertise(entry, self.reactor.now())
                self._update()

    def _subscribe(self, subscription: Subscription, sink: Any, max_frame: int) -> graph.Subscription:
        kind = subscription.type
        with self.reactor.lock:
            entry = self._engine.subscribe(
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
            self._update()
        return entry

    def _unsubscribe(self, subscription: Subscription, entry: graph.Subscription) -> None:
        if subscription in self._subscriptions:
            self._subscriptions.remove(subscription)
        if subscription._publisher is not None:
            subscription._publisher._detach(subscription)
        with self.reactor.lock:
            if not self.is_shutdown:
                self._engine.unsubscribe(entry, self.reactor.now())
                self._update()

    def _offer(self, service: Service, serve: Any) -> graph.ServiceOffer:
        kind = service.type
        with self.reactor.lock:
            entry = self._engine.offer_service(
                service.name,
                kind._type,
                kind._md5sum,
                (kind.Request._type, kind.Response._type),
                serve,
                self.reactor.now(),
            )
            self._update()
        return entry

    def _withdraw(self, entry: graph.ServiceOffer) -> None:
        with self.reactor.lock:
            if not self.is_shutdown:
                self._engine.withdraw_service(entry, self.reactor.now())
                self._update()


def _qos(qos: QoS | int | None) -> QoS:
    return qos if isinstance(qos, QoS) else QoS() if qos is None else QoS(depth=qos)


def _message_class(kind: Any) -> Any:
    """The ROS 1 class of a message type given by name or class; of a ROS 2 class it is that of the same name."""
    if isinstance(kind, str):
        from roslet.gen.runtime import message_class

        return message_class("ros1", kind)
    if not hasattr(kind, "_spec") and not hasattr(kind, "_md5sum"):
        raise Unsupported(f"{kind!r} is no message class")
    return _of_ros1(kind)


def _service_class(kind: Any) -> Any:
    if isinstance(kind, str):
        from roslet.gen.runtime import service_class

        return service_class("ros1", kind)
    if not hasattr(kind, "_md5sum") or not hasattr(kind, "Request"):
        raise Unsupported(f"{kind!r} is no service class")
    return _of_ros1(kind)


def _of_ros1(kind: Any) -> Any:
    if kind._md5sum:
        return kind
    from roslet.gen.runtime import for_dialect

    return for_dialect("ros1", kind)


@atexit.register
def _close_all() -> None:
    for node in list(_open_nodes):
        node.close()


def _forked() -> None:
    """In the child: the nodes are the parent's. Their sockets are given back, nothing is told to anybody."""
    for node in list(_open_nodes):
        node.is_shutdown = node._close_begun = True
        node._shell.abandon()
    _open_nodes.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)


__all__ = ["CallTimeout", "Node"]
