"""Which matched writers are alive? DDS 1.4, 2.2.3.11; RTPS 2.3, 8.4.13.

AUTOMATIC               alive while anything of its participant is heard
MANUAL_BY_PARTICIPANT   alive while its participant says so, or any manual writer of it writes
MANUAL_BY_TOPIC         alive while it writes, or asserts itself by a heartbeat
"""

from roslet.engine.rtps.events import LivelinessLost, LivelinessRegained
from roslet.wire.rtps.qos import AUTOMATIC, MANUAL_BY_PARTICIPANT
from roslet.wire.rtps.times import INFINITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.wire.rtps.endpoint_data import EndpointData


class _Watch:
    __slots__ = ("alive", "asserted", "kind", "lease", "local", "writer")

    def __init__(self, local: bytes, remote: "EndpointData", now: float) -> None:
        self.local = local
        self.writer = remote.guid
        self.kind = remote.qos.liveliness[0]
        self.lease = remote.qos.liveliness[1] / 1e9
        self.asserted = now
        self.alive = True


class Liveliness:
    """Watches the writers that have a lease. `heard(prefix)` says when anything last came from a participant."""

    def __init__(self, deliver: "Callable[[Any], None]", heard: "Callable[[bytes], float]") -> None:
        self._watches: dict[bytes, _Watch] = {}
        self._deliver = deliver
        self._heard = heard
        self._at: float | None = None
        self.manual = False  # whether anything but AUTOMATIC is watched: else samples need not be looked at

    def watch(self, local: bytes, remote: "EndpointData", now: float) -> None:
        """Our reader `local` has matched this writer."""
        if remote.qos.liveliness[1] >= INFINITE:
            return
        watch = self._watches[local + remote.guid] = _Watch(local, remote, now)
        self._at = min(self._at or now + watch.lease, now + watch.lease)
        self._refresh()

    def forget(self, local: bytes, writer: bytes) -> None:
        """They no longer match."""
        if self._watches.pop(local + writer, None) is not None:
            self._refresh()

    def _refresh(self) -> None:
        self.manual = bool([one for one in self._watches.values() if one.kind != AUTOMATIC])
        if not self._watches:
            self._at = None

    def writer_asserted(self, writer: bytes, now: float) -> None:
        """A sample of this writer, or a heartbeat with the liveliness flag."""
        by_participant = False
        for watch in self._watches.values():
            if watch.writer == writer:
                self._assert(watch, now)
                by_participant = by_participant or watch.kind == MANUAL_BY_PARTICIPANT
        if by_participant:
            self.participant_asserted(writer[:12], now)

    def participant_asserted(self, prefix: bytes, now: float) -> None:
        """A manual participant message."""
        for watch in self._watches.values():
            if watch.kind == MANUAL_BY_PARTICIPANT and watch.writer[:12] == prefix:
                self._assert(watch, now)

    def _assert(self, watch: _Watch, now: float) -> None:
        watch.asserted = now
        if not watch.alive:
            watch.alive = True
            self._at = min(self._at or now + watch.lease, now + watch.lease)
            self._deliver(LivelinessRegained(watch.local, watch.writer))

    def deadline(self) -> "float | None":
        """When `handle_deadline` has something to do."""
        return self._at

    def handle_deadline(self, now: float) -> None:
        """Find out who has fallen silent; an AUTOMATIC writer may have come back too."""
        if self._at is None or now < self._at:
            return
        soonest: float | None = None
        for watch in self._watches.values():
            if watch.kind == AUTOMATIC:
                heard = self._heard(watch.writer[:12])
                if heard > watch.asserted:
                    self._assert(watch, heard)
            at = watch.asserted + watch.lease
            if now >= at:
                if watch.alive:
                    watch.alive = False
                    self._deliver(LivelinessLost(watch.local, watch.writer))
                if watch.kind != AUTOMATIC:
                    continue
                at = now + watch.lease  # only looking tells whether it has come back
            if soonest is None or at < soonest:
                soonest = at
        self._at = soonest
