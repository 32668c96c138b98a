"""The node on MicroPython: the names of `roslet.Node`, one thread, blocking (`spin`) or beside other tasks (`await
node.run()`).

It does nothing while nobody serves it: a program that publishes must call `spin`, `sleep`, `spin_once`, or run as a task.
"""

import os
import time

from roslet.errors import NodeClosed, ParameterNotSet
from roslet.io.micropython.loop import MAX_LATER, Loop, epoch_offset
from roslet.node.micropython import bounds
from roslet.node.micropython.endpoints import Future, Publisher
from roslet.node.qos import QoS
from roslet.wire.time import Time

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.node.micropython.endpoints import Client, Service, Subscription

DEBUG, INFO, WARN, ERROR, FATAL = 1, 2, 4, 8, 16
_NAMES = {DEBUG: "DEBUG", INFO: "INFO", WARN: "WARN", ERROR: "ERROR", FATAL: "FATAL"}
_MISSING = object()


class Log:
    """The console, and /rosout where the bundle has its type."""

    def __init__(self, node: "Node") -> None:
        self._node = node
        self._publisher: Publisher | None = None
        self.level = INFO
        self.quiet = False

    def debug(self, text: str) -> None:
        self.write(DEBUG, text)

    def info(self, text: str) -> None:
        self.write(INFO, text)

    def warning(self, text: str) -> None:
        self.write(WARN, text)

    def error(self, text: str) -> None:
        self.write(ERROR, text)

    def fatal(self, text: str) -> None:
        self.write(FATAL, text)

    def write(self, level: int, text: str) -> None:
        """Log `text`, unless it is below `level`."""
        if level < self.level:
            return
        if not self.quiet:
            print("[%s] [%s]: %s" % (_NAMES[level], self._node.name, text))
        publisher = self._publisher
        if publisher is not None and publisher.subscriber_count:
            entry = publisher.type()
            self._node._network.fill_log_entry(entry, level, str(text))
            publisher.publish(entry)


class Timer:
    """Calls `callback()` every `period` seconds."""

    def __init__(self, node: "Node", period: float, callback: "Callable[[], object]", once: bool) -> None:
        if not period > 0:
            raise ValueError("a period must be positive")
        self.period = period
        self.calls = 0
        self._loop = node.loop
        self._callback = callback
        self._once = once
        self._next = node.loop.now() + period
        node.loop.timed.append(self)

    def deadline(self) -> "float | None":
        """When it is due; not while a callback runs."""
        return None if self._loop.busy else self._next

    def handle_deadline(self, now: float) -> None:
        """It is due."""
        if self._once:
            self.cancel()
        self._next += self.period
        if self._next < now:
            self._next = now + self.period
        self.calls += 1
        self._loop.call(self._callback)

    def cancel(self) -> None:
        """No further calls. Cancelling twice is allowed."""
        if self in self._loop.timed:
            self._loop.timed.remove(self)


class Rate:
    """Keeps a loop at `hz` turns a second: call its `sleep()` once a turn."""

    def __init__(self, node: "Node", hz: float) -> None:
        if not hz > 0:
            raise ValueError("a rate must be positive")
        self.period = 1.0 / hz
        self._node = node
        self._next = node.loop.now() + self.period

    def sleep(self) -> None:
        """Serve callbacks until this turn's end."""
        now = self._node.loop.now()
        if self._next > now:
            self._node.sleep(self._next - now)
        self._next += self.period
        if self._next < now:
            self._next = now + self.period


class Node:
    """A node on a ROS network. `name network namespace` as for `roslet.Node`; there are no command lines, so no
    remappings."""

    _seen = True

    def __init__(
        self,
        name: str,
        *,
        network: "str | None" = None,
        namespace: str = "",
        arguments: "tuple[str, ...]" = (),
        anonymous: bool = False,
    ) -> None:
        self.loop = Loop()
        self.is_shutdown = False
        self._on_shutdown: list[Callable[[], object]] = []
        self._futures: list[Future] = []
        self._epoch = epoch_offset()
        self.log = Log(self)
        self._network: Any = None
        if anonymous:
            name = "%s_%d" % (name, int.from_bytes(os.urandom(4), "big"))
        if network is not None and network.startswith("ros1"):
            from roslet.node.micropython.ros1 import Ros1Network

            self._network = Ros1Network(self, name, network, namespace)
        else:
            from roslet.node.micropython.ros2 import Ros2Network

            self._network = Ros2Network(self, name, network, namespace)
        self.name = self._network.name
        self.namespace = self.name[: self.name.rfind("/")] or "/"
        self._network.begin()

    # -- topics and services

    def publisher(self, topic: str, type: "Any", *, qos: "QoS | int | None" = None) -> "Publisher":  # noqa: A002
        """A publisher of `topic`. `type` is a name such as "std_msgs/msg/String" or a message class."""
        self._check_open()
        return self._network.publisher(self.resolve(topic), type, _qos(qos))  # type: ignore[no-any-return]

    def subscribe(
        self,
        topic: str,
        type: "Any",  # noqa: A002
        callback: "Callable[[Any], object] | None" = None,
        *,
        qos: "QoS | int | None" = None,
        max_message: int = bounds.MAX_MESSAGE,
    ) -> "Subscription":
        """A subscription of `topic`."""
        self._check_open()
        return self._network.subscription(self.resolve(topic), type, callback, _qos(qos), max_message)  # type: ignore[no-any-return]

    def service(self, name: str, type: "Any", handler: "Callable[[Any], Any]") -> "Service":  # noqa: A002
        """Offer the service `name`."""
        self._check_open()
        return self._network.service(self.resolve(name), type, handler)  # type: ignore[no-any-return]

    def client(self, name: str, type: "Any") -> "Client":  # noqa: A002
        """A client of the service `name`, which need not be there yet."""
        self._check_open()
        return self._network.client(self.resolve(name), type)  # type: ignore[no-any-return]

    def resolve(self, name: str) -> str:
        """The full name that `name` has here. Raises InvalidName."""
        return self._network.resolve(name)  # type: ignore[no-any-return]

    # -- parameters

    def declare_parameter(self, name: str, default: "Any" = None, **description: "Any") -> "Any":
        """As `roslet.Node.declare_parameter`."""
        return self._network.parameter_api().declare(name, default, **description)

    def get_parameter(self, name: str, default: "Any" = _MISSING) -> "Any":
        """The value. Raises ParameterNotSet unless there is a default."""
        try:
            return self._network.parameter_api().get(name)
        except ParameterNotSet:
            if default is _MISSING:
                raise
            return default

    def set_parameter(self, name: str, value: "Any") -> None:
        """Raises ParameterRefused."""
        self._network.parameter_api().set(name, value)

    def has_parameter(self, name: str) -> bool:
        """Whether there is a parameter of this name."""
        return bool(self._network.parameter_api().has(name))

    def delete_parameter(self, name: str) -> None:
        """Raises ParameterNotSet."""
        self._network.parameter_api().undeclare(name)

    def parameter_names(self) -> "list[str]":
        """Of the master on ROS 1, of this node on ROS 2."""
        return self._network.parameter_api().names()  # type: ignore[no-any-return]

    def on_parameter(self, name: str, callback: "Callable[[Any], object]") -> "Any":
        """Call `callback(value)` whenever the parameter changes; returns its present value."""
        return self._network.parameter_api().on(name, callback)

    # -- time

    def now(self) -> Time:
        """The board's clock. Simulated time is not followed."""
        seconds, rest = divmod(self.nanoseconds(), 1000000000)
        return Time(seconds, rest)

    def nanoseconds(self) -> int:
        """Of the Unix epoch."""
        return time.time_ns() + self._epoch

    def timer(self, period: float, callback: "Callable[[], object]", *, once: bool = False) -> Timer:
        """Call `callback()` every `period` seconds inside spin."""
        self._check_open()
        return Timer(self, period, callback, once)

    def rate(self, hz: float) -> Rate:
        """Keeps a loop at `hz` turns a second."""
        return Rate(self, hz)

    def sleep(self, seconds: float) -> None:
        """Serve callbacks for `seconds`; returns early when the node shuts down."""
        self.loop.run_until(self._ended, seconds)

    # -- running

    def _ended(self) -> bool:
        return self.is_shutdown

    def spin(self, timeout: "float | None" = None) -> None:
        """Serve callbacks until the node shuts down, or for `timeout` seconds."""
        self.loop.run_until(self._ended, timeout)

    def spin_once(self, timeout: float = 0.0) -> None:
        """Serve what is ready; wait at most `timeout` seconds for something."""
        self.loop.turn(timeout)

    def spin_until(self, predicate: "Callable[[], object]", timeout: "float | None" = None) -> bool:
        """Serve callbacks until `predicate()` is true; false after `timeout` seconds or when the node shuts down."""
        self.loop.run_until(lambda: predicate() or self.is_shutdown, timeout)
        return bool(predicate())

    async def run(self) -> None:
        """Serve callbacks as a task of asyncio until the node shuts down."""
        await self.loop.run(self._ended)

    def on_shutdown(self, function: "Callable[[], object]") -> None:
        """Call `function()` when the node closes, whoever asks for it."""
        self._on_shutdown.append(function)

    @property
    def counters(self) -> "dict[str, int]":
        """What was dropped or refused, by its named reason."""
        return self._network.counters  # type: ignore[no-any-return]

    def close(self) -> None:
        """Withdraw everything and close every connection. Closing twice is allowed."""
        if self.is_shutdown:
            return
        for function in self._on_shutdown:
            function()
        self.is_shutdown = True
        self.log._publisher = None
        self._network.close()
        for future in list(self._futures):
            future.set_exception(NodeClosed("%s is closed" % self.name))

    def __enter__(self) -> "Node":
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    # -- what the networks use

    def _check_open(self) -> None:
        if self.is_shutdown:
            raise NodeClosed("%s is closed" % self.name)

    def _count(self, reason: str) -> None:
        counters = self._network.counters
        counters[reason] = counters.get(reason, 0) + 1

    def _note(self, text: str) -> None:
        self.log.warning(text)

    def _call_back(self, function: "Callable[[Any], object]", value: "Any") -> None:
        """Call user code at the next chance."""

        def call(argument: "Any") -> None:
            self.loop.call(lambda: function(argument[0]))

        if not self.loop.later(call, (value,)):
            self._count("too-many-callbacks")

    def _shut_down(self, reason: str) -> None:
        self.log.warning("shutting down: " + reason)
        self.loop.later(_close, self, MAX_LATER + 1)  # however much waits


def _close(node: Node) -> None:
    node.close()


def _qos(qos: "QoS | int | None") -> QoS:
    found = qos if isinstance(qos, QoS) else QoS(10) if qos is None else QoS(qos)
    if found.depth > bounds.DEPTH:
        found.depth = bounds.DEPTH
    return found


def environment(name: str) -> "str | None":
    """A variable of the environment; boards have none."""
    getenv = getattr(os, "getenv", None)
    return getenv(name) if getenv is not None else None
