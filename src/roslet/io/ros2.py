"""The shell of one participant with its ROS 2 context, which the nodes of a process on one network share."""

from __future__ import annotations

from roslet.engine.ros2 import user_data
from roslet.engine.ros2.context import Context

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.io.domain import ParticipantShell
    from roslet.io.select import Reactor, Timer
    from roslet.io.slip import SlipDomain
    from roslet.io.udp import Domain
    from roslet.names import Ros2Network


def _kind(network: Ros2Network) -> type[Domain] | type[SlipDomain]:
    """What carries the datagrams of a network; of serial lines only who has one need know."""
    if network.line is None:
        from roslet.io.udp import Domain

        return Domain
    from roslet.io.slip import SlipDomain

    return SlipDomain


class Ros2Shell:
    """Sockets, participant and context. Methods are to be called with the reactor's lock held, but for the last two.

    `warn` hears what goes wrong behind the scenes. Raises Unreachable.
    """

    def __init__(
        self, reactor: Reactor, network: Ros2Network, enclave: str, warn: Callable[[str], None]
    ) -> None:
        self.reactor = reactor
        self.network = network
        self.enclave = enclave
        self._handlers: dict[bytes, Callable[[Any], None]] = {}
        self._timer: Timer | None = None
        self._armed = 0.0
        self._closed = False
        # Samples of our own writers for our own readers take a shorter way: see roslet.node.ros2.topics.
        self.domain: ParticipantShell = _kind(network)(
            reactor,
            self._event,
            network,
            warn=warn,
            user_data=user_data.pair("enclave", enclave),
            name=enclave,
            match_own=False,
        )
        self.participant = self.domain.participant
        self.context = Context(self.participant, enclave)
        with reactor.lock:
            self.context.start(reactor.now())
            self.flush()

    def handle(self, entity_id: bytes, handler: Callable[[Any], None] | None) -> None:
        """Who gets the events of an endpoint of ours, in the loop, with the lock held; None: nobody any more."""
        if handler is None:
            self._handlers.pop(entity_id, None)
        else:
            self._handlers[entity_id] = handler

    def _event(self, event: Any) -> None:
        if not self.context.handle_event(event, self.reactor.now()):
            handler = self._handlers.get(getattr(event, "local", b""))
            if handler is not None:
                handler(event)
        self._arm()

    def flush(self) -> None:
        """Send what is pending, and look after what is due. To be called after every call of participant or context."""
        if not self._closed:
            self.domain.flush()
            self._arm()

    def _arm(self) -> None:
        at = self.context.deadline()
        if at is None or self._closed:
            return
        if self._timer is not None:
            if self._armed <= at:
                return
            self._timer.cancel()
        self._armed = at
        self._timer = self.reactor.call_at(at, self._due)

    def _due(self) -> None:
        self._timer = None
        if not self._closed:
            self.context.handle_deadline(self.reactor.now())
            self.flush()

    def close(self) -> None:
        """Say that the nodes are gone, and depart. Closing twice is allowed."""
        self._closed = True
        with self.reactor.lock:
            self.context.close(self.reactor.now())
            if self._timer is not None:
                self._timer.cancel()
        self.domain.close()

    def abandon(self) -> None:
        """In a forked child: give back the parent's sockets, and say nothing to anybody."""
        self._closed = True
        self.domain.abandon()
