"""Which matched writers are alive? DDS 1.4, 2.2.3.11; RTPS 2.3, 8.4.13.

AUTOMATIC               alive while anything of its participant is heard
MANUAL_BY_PARTICIPANT   alive while its participant says so, or any manual writer of it writes
MANUAL_BY_TOPIC         alive while it writes, or asserts itself by a heartbeat
"""

from roslet.engine.rtps.events import LivelinessLost, LivelinessRegained
from roslet.engine.rtps.schedule import Alarm
from roslet.wire.rtps.qos import AUTOMATIC, MANUAL_BY_PARTICIPANT
from roslet.wire.rtps.times import INFINITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.engine.rtps.schedule import Schedule
    from roslet.wire.rtps.endpoint_data import EndpointData


class _Watch:
    __slots__ = ("alarm", "alive", "asserted", "kind", "lease", "local", "writer")

    def __init__(self, local: bytes, remote: "EndpointData", now: float) -> None:
        self.local = local
        self.writer = remote.guid
        self.kind = remote.qos.liveliness[0]
        self.lease = remote.qos.liveliness[1] / 1e9
        self.asserted = now
        self.alive = True
        self.alarm: Alarm


class Liveliness:
    """Watches the writers that have a lease. `heard(prefix)` says when anything last came from a participant."""

    def __init__(
        self, schedule: "Schedule", deliver: "Callable[[Any], None]", heard: "Callable[[bytes], float]"
    ) -> None:
        self.manual = False  # whether anything but AUTOMATIC is watched: else samples need not be looked at
        self._by_writer: dict[bytes, dict[bytes, _Watch]] = {}
        self._by_prefix: dict[bytes, dict[bytes, _Watch]] = {}  # of MANUAL_BY_PARTICIPANT
        self._manual = 0
        self._deliver = deliver
        self._heard = heard
        self._schedule = schedule

    def watch(self, local: bytes, remote: "EndpointData", now: float) -> None:
        """Our reader `local` has matched this writer."""
        if remote.qos.liveliness[1] >= INFINITE:
            return
        watch = _Watch(local, remote, now)
        watch.alarm = Alarm(self._schedule, lambda now: self._look(watch, now))
        watch.alarm.set(now + watch.lease)
        self._by_writer.setdefault(watch.writer, {})[local] = watch
        if watch.kind != AUTOMATIC:
            self._manual += 1
        if watch.kind == MANUAL_BY_PARTICIPANT:
            self._by_prefix.setdefault(watch.writer[:12], {})[local + watch.writer] = watch
        self.manual = self._manual > 0

    def forget(self, local: bytes, writer: bytes) -> None:
        """They no longer match."""
        watches = self._by_writer.get(writer)
        watch = watches.pop(local, None) if watches is not None else None
        if watch is None:
            return
        watch.alarm.cancel()
        if not watches:
            del self._by_writer[writer]
        if watch.kind != AUTOMATIC:
            self._manual -= 1
        if watch.kind == MANUAL_BY_PARTICIPANT:
            together = self._by_prefix[writer[:12]]
            del together[local + writer]
            if not together:
                del self._by_prefix[writer[:12]]
        self.manual = self._manual > 0

    def writer_asserted(self, writer: bytes, now: float) -> None:
        """A sample of this writer, or a heartbeat with the liveliness flag."""
        by_participant = False
        for watch in self._by_writer.get(writer, {}).values():
            self._assert(watch, now)
            by_participant = by_participant or watch.kind == MANUAL_BY_PARTICIPANT
        if by_participant:
            self.participant_asserted(writer[:12], now)

    def participant_asserted(self, prefix: bytes, now: float) -> None:
        """A manual participant message."""
        for watch in self._by_prefix.get(prefix, {}).values():
            self._assert(watch, now)

    def _assert(self, watch: _Watch, now: float) -> None:
        watch.asserted = now
        if not watch.alive:
            watch.alive = True
            watch.alarm.set(now + watch.lease)
            self._deliver(LivelinessRegained(watch.local, watch.writer))

    def _look(self, watch: _Watch, now: float) -> None:
        """Has it fallen silent? An AUTOMATIC writer may have come back too."""
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
                return
            at = now + watch.lease  # only looking tells whether it has come back
        watch.alarm.set(at)
