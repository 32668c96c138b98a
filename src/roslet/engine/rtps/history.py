"""What a writer keeps: changes by sequence number. RTPS 2.3, 8.2.2 (HistoryCache); DDS 1.4, 2.2.3.18, 2.2.3.19."""

from roslet.errors import RosletError
from roslet.wire.primitives import CPYTHON
from roslet.wire.rtps.data import FLAG_D
from roslet.wire.rtps.qos import KEEP_ALL

TYPE_CHECKING = False
if TYPE_CHECKING:
    from roslet.wire.rtps.qos import Qos

# Samples of a KEEP_ALL writer without resource limits of its own: readers that do not acknowledge must not take the
# machine's memory.
DEFAULT_SAMPLES = 4096
DEFAULT_BYTES = 256 << 20
# Where heap is short: small samples that were kept, and are used again.
MAX_SPARES = 16
SPARE_BYTES = 256


class HistoryFull(RosletError):
    """A writer has reached a limit, and its readers have yet to acknowledge; or it has no room for another instance."""


class Change:
    """One sample, or the end of an instance: `flags` as in DATA; `key` tells instances apart; `to`: the one reader
    that it is for, or nothing; `fragment`: octets of a part of it, where it is longer than that."""

    __slots__ = ("expires", "flags", "fragment", "inline_qos", "key", "payload", "sequence", "time", "to")

    def __init__(
        self,
        sequence: int,
        payload: "bytes | bytearray",
        inline_qos: bytes,
        flags: int,
        time: int,
        key: bytes,
        to: bytes = b"",
        fragment: int = 0,
    ) -> None:
        self.sequence = sequence
        self.payload = payload
        self.inline_qos = inline_qos
        self.flags = flags
        self.time = time
        self.key = key
        self.to = to
        self.fragment = fragment
        self.expires = 0.0  # when LIFESPAN ends it, where the writer has one


class History:
    """Changes in order. KEEP_LAST drops the oldest of an instance beyond the depth, and the oldest of all beyond
    max_samples; KEEP_ALL is full at its limits. Neither has more than max_instances."""

    def __init__(
        self, qos: "Qos", max_bytes: int = DEFAULT_BYTES, max_instances: int = DEFAULT_SAMPLES
    ) -> None:
        kind, depth = qos.history
        samples, instances, an_instance = qos.resource_limits
        self.keep_all = kind == KEEP_ALL
        self.depth = max(depth, 1)
        if an_instance > 0:
            self.depth = min(self.depth, an_instance)
        self.max_samples = samples if samples > 0 else DEFAULT_SAMPLES
        self.max_instances = instances if instances > 0 else max_instances
        self.max_an_instance = an_instance if an_instance > 0 else self.max_samples
        self.max_bytes = max_bytes
        self.bytes = 0
        self._changes: dict[int, Change] = {}
        self._instances: dict[bytes, list[int]] = {}
        self._counts = an_instance > 0  # whether KEEP_ALL must know how many an instance has
        self._first = 1  # no change below this is held
        self._ended = 0  # ends of instances among the changes
        self._spares: list[Change] = []  # only where heap is short

    def __len__(self) -> int:
        return len(self._changes)

    def full(self, size: int, key: bytes = b"") -> bool:
        """Whether a sample of `size` octets of instance `key` must wait."""
        if not self._changes:
            return False
        if key and key not in self._instances and len(self._instances) >= self.max_instances:
            return True
        if not self.keep_all:
            return False
        if self._counts and len(self._instances.get(key, ())) >= self.max_an_instance:
            return True
        return self.bytes + size > self.max_bytes or len(self._changes) >= self.max_samples

    def add(self, change: Change) -> None:
        """Keep it, and drop what KEEP_LAST no longer keeps. Raises HistoryFull."""
        size = len(change.payload)
        if self.full(size, change.key):
            raise HistoryFull(
                "%d samples, %d bytes are not yet acknowledged" % (len(self._changes), self.bytes)
            )
        if not self._changes:
            self._first = change.sequence
        self._changes[change.sequence] = change
        self.bytes += size
        if not change.flags & FLAG_D:
            self._ended += 1
        if self.keep_all and not self._counts and not change.key:
            return
        numbers = self._instances.get(change.key)
        if numbers is None:
            numbers = self._instances[change.key] = []
        numbers.append(change.sequence)
        if not self.keep_all:
            if len(numbers) > self.depth:
                self.remove(numbers[0])
            while (self.bytes > self.max_bytes or len(self._changes) > self.max_samples) and len(
                self._changes
            ) > 1:
                self.remove(self.first(0))

    def spare(
        self,
        sequence: int,
        payload: "bytes | bytearray | memoryview",
        time: int,
        fragment: int,
        again: bool,
    ) -> "Change | None":
        """A change of data with no more to say, where heap is short: with `again` one that was removed, in the same memory,
        so nothing may be left that looks at it. None where it is too large for that."""
        size = len(payload)
        if size > SPARE_BYTES:
            return None
        while again and self._spares:
            change = self._spares.pop()
            if len(change.payload) == size and isinstance(change.payload, bytearray):
                change.payload[:] = payload
                change.sequence = sequence
                change.time = time
                change.fragment = fragment
                return change
        return Change(sequence, bytearray(payload), b"", FLAG_D, time, b"", b"", fragment)

    def get(self, sequence: int) -> "Change | None":
        return self._changes.get(sequence)

    def remove(self, sequence: int) -> None:
        """Forget a change; one that is not there is no error."""
        change = self._changes.pop(sequence, None)
        if change is None:
            return
        self.bytes -= len(change.payload)
        if not change.flags & FLAG_D:
            self._ended -= 1
        if not CPYTHON and isinstance(change.payload, bytearray) and len(self._spares) < MAX_SPARES:
            self._spares.append(change)
        numbers = self._instances.get(change.key)
        if numbers is not None:
            numbers.remove(sequence)
            if not numbers:
                del self._instances[change.key]

    def remove_through(self, sequence: int) -> None:
        """Forget every change up to `sequence`."""
        while self._changes and self.first(0) <= sequence:
            self.remove(self._first)

    def forget_expired(self, now: float) -> None:
        """Forget the oldest changes whose time is over."""
        while self._changes:
            first = self.first(0)
            if self._changes[first].expires > now:
                break
            self.remove(first)

    def forget_ended(self, sequence: int) -> None:
        """Forget the ends of instances up to `sequence`."""
        if not self._ended:
            return
        ended = [
            one.sequence
            for one in self._changes.values()
            if not one.flags & FLAG_D and one.sequence <= sequence
        ]
        for number in ended:
            self.remove(number)

    def first(self, otherwise: int) -> int:
        """The lowest number held, or `otherwise`."""
        changes = self._changes
        if not changes:
            return otherwise
        # Numbers only grow, so this walks over each gap once.
        while self._first not in changes:
            self._first += 1
        return self._first

    def numbers(self) -> "list[int]":
        """What is held, in order."""
        return sorted(self._changes)
