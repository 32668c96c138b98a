"""What an rclpy node is on the network: a roslet node whose endpoints put what arrives where the executor finds it.

No code of the program runs in roslet's loop. Arrivals stay in their endpoint's queue, as bytes; the entity that belongs to
the endpoint is told, and takes them in the executor's thread.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy.impl import rcutils_logger
from roslet.names import Ros2Arguments
from roslet.node import events
from roslet.node.log import DEBUG, ERROR, FATAL, INFO, WARN, Log
from roslet.node.node import Node as RosletNode
from roslet.node.ros2.network import Ros2Network
from roslet.node.ros2.parameter_files import overrides_of
from roslet.node.ros2.services import MAX_REQUESTS, Ros2Service
from roslet.node.ros2.topics import MessageInfo, Ros2Publisher, Ros2Subscription

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.compat.rclpy._parameters import NodeParameters
    from roslet.wire.time import Time

_LEVELS = {DEBUG: 10, INFO: 20, WARN: 30, ERROR: 40, FATAL: 50}
_NO_GID = bytes(16)


class _Told:
    """Events go to `told` at once, in the loop; those of before wait for it."""

    _told: Callable[[events.Event], object] | None = None
    _early: Any
    _network: Any

    def tell(self, function: Callable[[events.Event], object]) -> None:
        """Call `function(event)` in the loop, with its lock held: it must be quick and of ours."""
        with self._network.reactor.lock:
            self._told = function
            while self._early:
                function(self._early.popleft())

    def _tell(self, event: events.Event) -> None:
        if self._told is None:
            self._early.append(event)
        else:
            self._told(event)

    def _incompatible(self, peer: str, gid: bytes, policies: tuple[str, ...], offers: bool) -> None:
        self._tell(events.QosIncompatible(peer, gid, policies))


class QueuedPublisher(_Told, Ros2Publisher):
    """A publisher that tells subscriptions of its own process where a message came from."""

    def _local_link(self) -> MessageInfo:
        now = time.time_ns()
        writer = self._writer
        return MessageInfo(now, now, _NO_GID if writer is None else writer.data.guid, self.messages)


class QueuedSubscription(_Told, Ros2Subscription):
    """A subscription whose messages wait for `take_one`. `arrived()` is called, in any thread, when one is in the queue that
    displaced no other."""

    arrived: Callable[[], object] | None = None

    def _deliver_later(self, message: Any, link: Any = None) -> None:
        if link is None:
            now = time.time_ns()
            link = MessageInfo(now, now, _NO_GID, 0)
        before = len(self._arrived)
        self._append(self._arrived, (message, link))
        if self.arrived is not None and len(self._arrived) > before:
            self.arrived()

    def waiting(self) -> bool:
        """Whether there is a message."""
        return bool(self._arrived)

    def take_one(self, raw: bool = False) -> tuple[Any, MessageInfo] | None:
        """The oldest message, or its bytes, and where it came from. None where there is no well-formed one."""
        while not self.closed:
            try:
                message, link = self._arrived.popleft()
            except IndexError:
                return None
            if isinstance(link, MessageInfo):
                self.messages += 1
                return (bytes(message.serialize()) if raw else message), link
            gid, sequence, sent, received = link
            info = MessageInfo(sent, received, gid, sequence)
            kind: Any = self.type
            try:
                message = (
                    bytes(message) if raw else kind.deserialize_from(memoryview(message), 0, len(message))
                )
            except (
                Exception
            ) as error:  # a peer's bytes must not end the spin, whatever they do to the decoder
                self._reject(error, self._network.node_of(gid) or "a publisher")
                continue
            self.messages += 1
            return message, info
        return None


class QueuedService(Ros2Service):
    """A service whose requests wait for `take_one`. `arrived()` is called in the loop."""

    arrived: Callable[[], object] | None = None

    def receive(self, body: Any, reply: Callable[[bytes], None]) -> None:
        if len(self._requests) >= MAX_REQUESTS:
            self.node._count("requests-full")
            return
        self._requests.append((body, reply))
        if self.arrived is not None:
            self.arrived()

    def waiting(self) -> bool:
        """Whether there is a request."""
        return bool(self._requests)

    def take_one(self) -> tuple[Any, Callable[[bytes], None]] | None:
        """The oldest request and what sends bytes as its response. None as for subscriptions."""
        while self._server is not None:
            try:
                body, reply = self._requests.popleft()
            except IndexError:
                return None
            try:
                request = self.type.Request.deserialize_from(memoryview(body), 0, len(body))
            except Exception as error:  # as above
                self.node._count("malformed-request")
                self.node.log.error(f"{self.name}: malformed request: {error}")
                continue
            self.calls += 1
            return request, reply
        return None


class RclpyNetwork(Ros2Network):
    """`follow` is called when the parameter use_sim_time says whether /clock tells the time."""

    publisher_kind = QueuedPublisher
    subscription_kind = QueuedSubscription
    service_kind = QueuedService
    parameters: NodeParameters
    follow: Callable[[bool], object] | None = None

    def begin(self) -> None:
        """Nothing: an rclpy node makes what it has by itself."""

    def arguments_overrides(self) -> dict[str, Any]:
        """The parameters that the arguments give to this node."""
        return overrides_of(self.arguments.overrides, self.base_name, self.name)

    def follow_clock(self, simulated: bool) -> None:
        if self.follow is not None:
            self.follow(simulated)


class Inner(RosletNode):
    """The roslet node within an rclpy node. `arguments` are sorted already."""

    network_of: RclpyNetwork
    clock_of: Any = None

    def __init__(self, name: str, namespace: str, domain: int, arguments: Ros2Arguments) -> None:
        self._sorted = arguments
        super().__init__(name, network=f"ros2://{domain}", namespace=namespace)
        self.log = _Log(self)

    def _make(self, name: Any, network: Any, namespace: Any, *rest: Any) -> RclpyNetwork:
        self.network_of = RclpyNetwork(self, name, network, namespace, self._sorted, *rest[1:])
        return self.network_of

    def now(self) -> Time:
        if self.clock_of is None:
            return super().now()
        from roslet.wire.time import Time as WireTime

        return WireTime(*divmod(self.clock_of._nanoseconds(), 1_000_000_000))


class _Log(Log):
    """What roslet has to say goes the way of the node's own lines."""

    def write(self, level: int, text: str, depth: int = 2) -> None:
        name = logger_name(self._node.name)
        if _LEVELS[level] >= rcutils_logger.effective_level(name):
            rcutils_logger.write(_LEVELS[level], name, str(text), None)


def logger_name(full_name: str) -> str:
    """A node's logger."""
    return full_name.strip("/").replace("/", ".")


def merged(given: Ros2Arguments | None, own: list[str] | None) -> Ros2Arguments:
    """The arguments of a node: those of the program, unless None, behind its own. Raises InvalidName."""
    local = Ros2Arguments(own or [])
    if given is None:
        return local
    # The first rule that fits a name is taken, the last value of a parameter.
    local.remappings = local.remappings + given.remappings
    local.overrides = given.overrides + local.overrides
    local.switches = {**given.switches, **local.switches}
    local.enclave = local.enclave or given.enclave
    return local


__all__ = [
    "Inner",
    "QueuedPublisher",
    "QueuedService",
    "QueuedSubscription",
    "RclpyNetwork",
    "logger_name",
    "merged",
]
