"""What waits to be sent. Fragments of large samples are paced, so that they do not run over the receiver's socket buffer."""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator

    Address = tuple[str, int]
    Parts = tuple[bytes | bytearray | memoryview, ...]
    Datagram = tuple[Parts, tuple[Address, ...]]

# Octets that one peer's default socket buffer (208 KiB on Linux) takes at once.
BURST = 192 * 1024
# The most that a burst grows to while receivers lose nothing of it.
MAX_BURST = 2 << 20
# Seconds that a peer gets to empty it. Loops that sleep in whole milliseconds reach some 190 MB/s.
INTERVAL = 0.0004


class Outbox:
    """`urgent` goes out with the next call, `bulk` a burst at a time."""

    def __init__(self, burst: int = BURST, interval: float = INTERVAL) -> None:
        self.burst = self._least = burst
        self.interval = interval
        self._urgent: list[Datagram] = []
        self._bulk: list[Iterator[Datagram]] = []
        self._resume = 0.0

    def send(self, parts: "Parts", addresses: "tuple[Address, ...]") -> None:
        """Queue one datagram to each of the addresses."""
        if addresses:
            self._urgent.append((parts, addresses))

    def send_paced(self, datagrams: "Iterator[Datagram]", first: bool = False) -> None:
        """Queue many, made when their time comes; `first`: before those that wait already, for repairs."""
        if first:
            self._bulk.insert(0, datagrams)
        else:
            self._bulk.append(datagrams)

    def widen(self) -> None:
        """A large sample went through at once: the next bursts are larger."""
        self.burst = min(2 * self.burst, max(MAX_BURST, self._least))

    def narrow(self) -> None:
        """Fragments were lost: the next bursts are smaller, but not below the first."""
        self.burst = max(self.burst // 2, self._least)

    def take(self, now: float) -> "list[Datagram]":
        """What is to be sent now."""
        found = self._urgent
        self._urgent = []
        if self._bulk and now >= self._resume:
            left = self.burst
            while self._bulk and left > 0:
                # One sample after the other: readers put only a few together at once.
                datagram = next(self._bulk[0], None)
                if datagram is None:
                    self._bulk.pop(0)
                    continue
                found.append(datagram)
                left -= sum([len(part) for part in datagram[0]]) * len(datagram[1])
            self._resume = now + self.interval
        return found

    def deadline(self) -> "float | None":
        """When `take` has something, or None."""
        if self._urgent:
            return 0.0
        return self._resume if self._bulk else None
