"""The shell around an RTPS participant, whatever carries its datagrams.

Sends what the participant has pending and re-arms one timer; its events go to one function, in the loop's thread, with the
reactor's lock held.
"""

from __future__ import annotations

import os
import struct
import sys
import time
from time import monotonic

from roslet.engine.rtps.limits import Limits
from roslet.engine.rtps.participant import Participant
from roslet.engine.rtps.writer import HEARTBEAT_DELAY
from roslet.names import OFF, Ros2Network
from roslet.wire.rtps import locator
from roslet.wire.rtps.guid import VENDORID_ROSLET

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

    from roslet.engine.rtps.outbox import Address
    from roslet.io.select import Reactor, Timer
    from roslet.wire.rtps.locator import Locator

GROUP = "239.255.0.1"


def new_guid_prefix() -> bytes:
    """Our vendor id, the process, and chance."""
    return VENDORID_ROSLET + struct.pack(">H", os.getpid() & 0xFFFF) + os.urandom(8)


def _warn(text: str) -> None:
    print("roslet:", text, file=sys.stderr)


class ParticipantShell:
    """One participant of a domain, on a reactor. Who inherits from this makes `participant` and sends.

    `warn(text)` hears of what goes wrong behind the caller's back; standard error if None. Call `flush()` after every call
    of the participant. `errors` counts what the system refused.
    """

    participant: Participant

    def __init__(
        self,
        reactor: Reactor,
        on_event: Callable[[Any], None],
        network: Ros2Network,
        warn: Callable[[str], None] | None,
    ) -> None:
        self.reactor = reactor
        self.network = network
        self.domain_id = network.domain_id
        self.errors: dict[str, int] = {}
        self._on_event = on_event
        self._warn = warn or _warn
        self._timer: Timer | None = None
        self._armed = 0.0
        self._closed = False

    def _make(
        self,
        metatraffic: tuple[Locator, ...],
        default: tuple[Locator, ...],
        multicast: tuple[Locator, ...],
        announce_to: tuple[Address, ...],
        networks: tuple[tuple[str, int], ...],
        fields: dict[str, Any],
    ) -> Participant:
        """The participant; with the range OFF one that takes no other."""
        if self.network.range == OFF:
            fields["limits"] = (fields.get("limits") or Limits()).replace(participants=0)
        return Participant(
            fields.pop("guid_prefix", None) or new_guid_prefix(),
            self.domain_id,
            metatraffic,
            default,
            announce_to,
            epoch=time.time_ns() - int(time.monotonic() * 1e9),
            multicast=multicast,
            networks=networks,
            **fields,
        )

    def _ports_from(self, address: str, ids: Sequence[int]) -> list[Address]:
        """Where the participants of these ids listen on a host."""
        ports = [locator.metatraffic_unicast_port(self.domain_id, one) for one in ids]
        return [(address, port) for port in ports if port < 65536]

    def _send(self, parts: Any, addresses: Sequence[Address]) -> None:
        """One datagram, in parts, to each of the addresses. What cannot be sent is counted."""
        raise NotImplementedError

    def _deadline(self) -> float | None:
        """When `flush` has something to do."""
        return self.participant.deadline()

    def _tell(self) -> None:
        for event in self.participant.take_events():
            self._on_event(event)

    def flush(self) -> None:
        """Do what is due, send what is pending, and wake up in time for the rest. Call it with the reactor's lock held."""
        if self._closed:
            return
        now = monotonic()
        participant = self.participant
        participant.handle_deadline(now)
        for parts, addresses in participant.datagrams_to_send(now):
            self._send(parts, addresses)
        if participant.pending_events:
            self._tell()
        at = self._deadline()
        if at is None:
            return
        if self._timer is not None and self._timer.function is not None:
            if self._armed <= at:
                return
            self._timer.cancel()
        self._armed = at
        self._timer = self.reactor.call_at(at, self._due)

    def send(self, now: float) -> None:
        """The short way after `Writer.write`: send what is pending, and leave what is not urgent to the timer if it goes off
        in time. `now` as given to `write`; with the reactor's lock held."""
        if self._timer is None or self._armed > now + HEARTBEAT_DELAY or self._closed:
            self.flush()
            return
        outbox = self.participant.outbox
        for parts, addresses in outbox.take(now):
            self._send(parts, addresses)
        if outbox.deadline() is not None:
            self.flush()

    def _due(self) -> None:
        self._timer = None
        self.flush()

    def _failed(self, what: str, error: OSError) -> None:
        name = f"{what}-{os.strerror(error.errno or 0).lower().replace(' ', '-')}"
        self.errors[name] = self.errors.get(name, 0) + 1

    def _count(self, reason: str) -> None:
        counters = self.participant.counters
        counters[reason] = counters.get(reason, 0) + 1

    def close(self) -> None:
        """Depart, and give back what the system lent."""
        raise NotImplementedError

    def abandon(self) -> None:
        """In a forked child: give back the parent's, and touch nothing else."""
        raise NotImplementedError
