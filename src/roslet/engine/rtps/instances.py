"""What a reader knows of the instances of a keyed topic. DDS 1.4, 2.2.2.5.1.3 (instance states), 2.2.3.7 (DEADLINE)."""

from roslet.engine.rtps.events import DeadlineMissed, InstanceChanged
from roslet.record import Names
from roslet.wire.rtps.inline_qos import STATUS_DISPOSED, STATUS_UNREGISTERED

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

ALIVE, NOT_ALIVE_DISPOSED, NOT_ALIVE_NO_WRITERS = 1, 2, 4
STATES = Names(
    "state",
    {
        ALIVE: "ALIVE",
        NOT_ALIVE_DISPOSED: "NOT_ALIVE_DISPOSED",
        NOT_ALIVE_NO_WRITERS: "NOT_ALIVE_NO_WRITERS",
    },
)
"""The numbers and names of the specification (2.3.3)."""


class _Instance:
    __slots__ = ("due", "writers")

    def __init__(self, due: float) -> None:
        self.writers: set[bytes] = set()
        self.due = due


class Instances:
    """The living instances; one that is no longer alive is told and forgotten. At most `limit`."""

    def __init__(
        self, local: bytes, limit: int, period: "float | None", deliver: "Callable[[Any], None]"
    ) -> None:
        self._local = local
        self._limit = limit
        self._period = period
        self._deliver = deliver
        self._instances: dict[bytes, _Instance] = {}

    def __len__(self) -> int:
        return len(self._instances)

    def room(self, key: bytes) -> bool:
        """Whether a sample of this instance can be taken."""
        return key in self._instances or len(self._instances) < self._limit

    def note(self, key: bytes, status: int, writer: bytes, now: float) -> None:
        """A sample or an end, of which `status` are the STATUS_ bits, that is handed over."""
        instance = self._instances.get(key)
        if status & STATUS_DISPOSED:
            if instance is not None:
                self._end(key, NOT_ALIVE_DISPOSED, writer)
        elif status & STATUS_UNREGISTERED:
            self._unregister(key, writer)
        else:
            if instance is None:
                instance = self._instances[key] = _Instance(0.0)
                self._deliver(InstanceChanged(self._local, key, ALIVE, writer))
            instance.writers.add(writer)
            if self._period is not None:
                instance.due = now + self._period

    def writer_lost(self, writer: bytes) -> None:
        """It no longer matches: what only it wrote has no writers."""
        for key in [key for key, one in self._instances.items() if writer in one.writers]:
            self._unregister(key, writer)

    def _unregister(self, key: bytes, writer: bytes) -> None:
        instance = self._instances.get(key)
        if instance is not None:
            instance.writers.discard(writer)
            if not instance.writers:
                self._end(key, NOT_ALIVE_NO_WRITERS, writer)

    def _end(self, key: bytes, state: int, writer: bytes) -> None:
        del self._instances[key]
        self._deliver(InstanceChanged(self._local, key, state, writer))

    def missed(self, now: float) -> "float | None":
        """Tell of the instances whose DEADLINE is over; returns when the next one is."""
        soonest: float | None = None
        for key, instance in self._instances.items():
            if now >= instance.due and self._period is not None:
                instance.due = now + self._period
                self._deliver(DeadlineMissed(self._local, key))
            if soonest is None or instance.due < soonest:
                soonest = instance.due
        return soonest
