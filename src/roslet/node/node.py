"""The node."""

from __future__ import annotations

import atexit
import os
import sys
import threading
import weakref

from roslet.errors import CallTimeout, NodeClosed
from roslet.io.select import Reactor, reactor
from roslet.node.clock import Clock, Rate, Timer
from roslet.node.future import Future
from roslet.node.graph import GraphApi
from roslet.node.log import Log
from roslet.node.network import Network, make
from roslet.node.qos import QoS
from roslet.wire.tcpros import MAX_FRAME

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from typing import Any

    from typing_extensions import Self

    from roslet.node.ros2.actions import ActionClient, ActionServer, ServerGoal
    from roslet.node.services import Client, Service
    from roslet.node.topics import Publisher, Subscription
    from roslet.wire.time import Time

# Callbacks that wait for somebody to spin, other than those of topics, which have queues of their own.
MAX_CALLBACKS = 1000

_open_nodes: weakref.WeakSet[Node] = weakref.WeakSet()


class Node(GraphApi):
    """A node on a ROS network.

    name       a base name; `__name:=x`, or `-r __node:=x` on ROS 2, among the arguments overrides it
    network    ROS 2: "ros2://" for $ROS_DOMAIN_ID or 0, "ros2://42", "ros2://?interface=eth0&peers=10.0.0.7"; without one
               "ros2://". ROS 1: "ros1://host:port", "ros1://" for $ROS_MASTER_URI
    namespace  what relative names are in; on ROS 1 $ROS_NAMESPACE where empty
    arguments  as in sys.argv[1:]. ROS 1: remappings `a:=b`, private parameters `_p:=v`, `__name __ns __master __ip
               __hostname`; ROS 2: what stands behind `--ros-args`
    anonymous  append something to the name that no other node has

    Callbacks run inside `spin()` and its like, in that thread; `start()` makes a thread that spins. What a callback
    raises comes out of spin. Close the node, or use it as a context manager; at exit what is open is closed.

    Raises InvalidName, Unsupported, OSError or Unreachable where no port can be had.
    """

    # Whether the node has on ROS 2 what every node has: its log, its parameters' services and events, descriptions of its
    # types. One that only looks, such as a command's, costs its peers less without.
    _seen = True

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
        self.reactor: Reactor = reactor()
        self.clock = Clock(self.reactor)
        self.log = Log(self)
        self.is_shutdown = False
        self._on_shutdown: list[Callable[[], object]] = []
        self._spinner: threading.Thread | None = None
        self._closing = threading.Lock()
        self._close_begun = False
        self._callbacks_waiting = 0
        self._futures: weakref.WeakSet[Future[Any]] = weakref.WeakSet()  # those that somebody may wait for
        self._network: Network = self._make(name, network, namespace, arguments, anonymous, env)
        self.name = self._network.name
        self.network = self._network.url
        self.namespace = self.name[: self.name.rfind("/")] or "/"
        self.arguments = self._network.arguments
        self._network.open()
        _open_nodes.add(self)
        try:
            self._network.begin()
        except BaseException:  # of Ctrl-C, too: what is open must not stay open behind a node that nobody has
            self.close()
            raise

    def _make(self, *given: Any) -> Network:
        return make(self, *given)

    # -- topics

    def publisher(self, topic: str, type: Any, *, qos: QoS | int | None = None) -> Publisher:  # noqa: A002
        """A publisher of `topic`. `type` is a name such as "std_msgs/msg/String" or a message class.

        On ROS 1 a node publishes a topic once: a second call with the same type gives the same publisher.
        Raises InvalidName, UnknownType, NodeClosed, RosletError where the topic has another type here.
        """
        self._check_open()
        return self._network.publisher(self.resolve(topic), type, _qos(qos))

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
        """A subscription of `topic`. `type` as for `publisher`, or "*": any type, delivered as RawMessage; on ROS 2 the
        topic's type must be known by then, from a publisher that has been discovered.

        `max_message` bounds one message's bytes; a publisher that sends a longer one is disconnected, and the log says so.
        With `with_link` the callback gets (message, link). On ROS 1 `link.peer_header` is the publisher's connection
        header; on ROS 2 it is a MessageInfo. None where the publisher is of this process.
        """
        self._check_open()
        return self._network.subscription(
            self.resolve(topic), type, callback, _qos(qos), max_message, with_link
        )

    # -- services

    def service(self, name: str, type: Any, handler: Callable[[Any], Any]) -> Service:  # noqa: A002
        """Offer the service `name`; see `Service` for the handler."""
        self._check_open()
        return self._network.service(self._network.resolve_service(name), type, handler)

    def client(self, name: str, type: Any, *, persistent: bool = False) -> Client:  # noqa: A002
        """A client of the service `name`, which need not be there yet. `persistent`: on ROS 1, keep the connection."""
        self._check_open()
        return self._network.client(self._network.resolve_service(name), type, persistent)

    # -- actions

    def action_server(
        self,
        name: str,
        type: Any,  # noqa: A002
        handler: Callable[[ServerGoal], Any] | None = None,
        *,
        accepted: Callable[[ServerGoal], object] | None = None,
        on_goal: Callable[[Any], object] | None = None,
        on_cancel: Callable[[ServerGoal], object] | None = None,
        result_timeout: float | None = 10.0,
    ) -> ActionServer:
        """ROS 2: serve the action `name`; see `ActionServer` for what is called when."""
        self._check_open()
        network = self._ros2("action_server")
        full = network.resolve_service(name)
        return network.action_server(full, type, handler, accepted, on_goal, on_cancel, result_timeout)

    def action_client(self, name: str, type: Any) -> ActionClient:  # noqa: A002
        """ROS 2: a client of the action `name`, which need not be there yet."""
        self._check_open()
        network = self._ros2("action_client")
        return network.action_client(network.resolve_service(name), type)

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

    # -- names

    def resolve(self, name: str) -> str:
        """The full name that `name` has here, remappings applied. Raises InvalidName."""
        return self._network.resolve(name)

    @property
    def counters(self) -> dict[str, int]:
        """What was dropped or refused, by its named reason."""
        return self._network.counters

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

    def _note(self, text: str) -> None:
        """Something that the user should know has happened within the network; any thread may say so."""
        self.reactor.call_soon(lambda: self.log.warning(text))

    def close(self) -> None:
        """Withdraw everything and close every connection. Closing twice is allowed, from on_shutdown functions too."""
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
        self._network.say_goodbye()
        self.clock.close()
        for future in list(self._futures):
            future.set_exception(NodeClosed(f"{self.name} is closed"))
        self._network.shut()
        self.reactor.wake()

    def __enter__(self) -> Self:
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

    def _count(self, reason: str) -> None:
        self._network.count(reason)

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


def _qos(qos: QoS | int | None) -> QoS:
    return qos if isinstance(qos, QoS) else QoS() if qos is None else QoS(depth=qos)


@atexit.register
def _close_all() -> None:
    for node in list(_open_nodes):
        node.close()


def _forked() -> None:
    """In the child: the nodes are the parent's. Their sockets are given back, nothing is told to anybody."""
    for node in list(_open_nodes):
        node.is_shutdown = node._close_begun = True
        node._network.abandon()
    _open_nodes.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)


__all__ = ["CallTimeout", "Node"]
