"""What waits to be sent. Bulk goes out within a window, so that it does not run over the receivers' socket buffers.

A flow is the bulk of one writer. Its window is what may be under way: acknowledgements make room at once, and as not
everybody acknowledges, and nobody a part of a sample, so does time, at a pace that any receiver can follow.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from typing import Any

    Address = tuple[str, int]
    Parts = tuple[bytes | bytearray | memoryview, ...]
    Datagram = tuple[Parts, tuple[Address, ...]]
    # ... and what is acknowledged when this datagram has arrived: a sample, and how many of its fragments
    Bulk = tuple[Parts, tuple[Address, ...], tuple[int, int] | None]

# Octets that one peer's default socket buffer (208 KiB on Linux) takes at once.
WINDOW = 192 * 1024
# The most that a window grows to while receivers lose nothing of it.
MAX_WINDOW = 3 << 20
# By how much it grows beyond the size at which something was lost, each time that nothing is.
STEP = WINDOW // 16
# Octets a second that are taken to have arrived without anybody saying so: where nobody can, and where somebody should.
PACE = 200e6
SLOW_PACE = 10e6
# What is sent of one writer's bulk and not acknowledged, of which the sizes are known; of more the oldest is taken to have
# arrived.
MAX_MARKS = 1024
WHOLE = 1 << 32
"""Fragments of a sample: all of them."""


class Outbox:
    """`send` is for what goes out with the next `take`. `at_once(front, rest, addresses)`, where the shell has it, sends a
    small datagram of two parts while it is called: no queue need be made for that."""

    def __init__(self) -> None:
        self.at_once: Callable[[bytes | bytearray, Any, tuple[Address, ...]], None] | None = None
        self._urgent: list[Datagram] = []
        self._flows: list[Flow] = []

    def send(self, parts: "Parts", addresses: "tuple[Address, ...]") -> None:
        """Queue one datagram to each of the addresses."""
        if addresses:
            self._urgent.append((parts, addresses))

    @property
    def idle(self) -> bool:
        """Whether nothing waits to be sent."""
        return not self._urgent and not self._flows

    def activate(self, flow: "Flow") -> None:
        """It has something to send."""
        if flow not in self._flows:
            self._flows.append(flow)

    def take(self, now: float) -> "Sequence[Datagram]":
        """What is to be sent now."""
        found = self._urgent
        if not self._flows:
            if not found:
                return ()
            self._urgent = []
            return found
        self._urgent = []
        for flow in self._flows:
            flow.take(now, found)
        self._flows = [flow for flow in self._flows if flow.waiting or flow.repairs]
        return found

    def deadline(self) -> "float | None":
        """When `take` has something, or None."""
        if self._urgent:
            return 0.0
        found: float | None = None
        for flow in self._flows:
            if found is None or flow.resume < found:
                found = flow.resume
        return found


class Flow:
    """The bulk of one writer. `waiting`, and before it `repairs`, is what has not gone out, `resume` when more of it may."""

    def __init__(self, outbox: "Outbox") -> None:
        self.window = WINDOW
        self.waiting: list[Iterator[Bulk]] = []
        self.repairs: list[Iterator[Bulk]] = []
        self.resume = 0.0
        self._outbox = outbox
        self._ceiling = MAX_WINDOW
        self._under_way = 0.0
        self._at = 0.0
        self._sent = 0  # octets ever
        self._landed = 0  # of those, the ones that everybody has
        self._marks: list[tuple[tuple[int, int], int]] = []  # what, and _sent behind it
        self.high = 0.0  # the most that was under way since the window last changed

    def add(self, datagrams: "Iterator[Bulk]", repair: bool = False) -> None:
        """Send many, made when their time comes."""
        if repair:
            self.repairs.append(datagrams)
        else:
            self.waiting.append(datagrams)
        self._outbox.activate(self)

    def spare(self, size: int, now: float) -> bool:
        """Whether this much may go at once, past the flow: so little is under way that nobody need say when it is there."""
        if self.waiting or self.repairs:
            return False
        self._settle(now)
        if self._under_way + size > self.window // 4:
            return False
        self._under_way += size
        return True

    def _settle(self, now: float) -> None:
        """Some has arrived meanwhile."""
        if now > self._at:
            pace = SLOW_PACE if self._marks else PACE
            self._under_way = max(0.0, self._under_way - (now - self._at) * pace)
            self._at = now

    def take(self, now: float, found: "list[Datagram]") -> None:
        """Add what may be sent now."""
        self._settle(now)
        room = self.window - self._under_way
        sent = 0
        while sent < room:
            queue = self.repairs or self.waiting
            if not queue:
                break
            # One sample after the other: readers put only a few together at once.
            bulk = next(queue[0], None)
            if bulk is None:
                queue.pop(0)
                continue
            parts, addresses, mark = bulk
            found.append((parts, addresses))
            size = sum([len(part) for part in parts]) * len(addresses)
            self._sent += size
            sent += size
            if mark is not None:
                if len(self._marks) >= MAX_MARKS:
                    self._landed = self._marks.pop(0)[1]
                self._marks.append((mark, self._sent))
        self._under_way += sent
        self.high = max(self.high, self._under_way)
        if self.waiting or self.repairs:
            # Not before a good part of the window is free: each look costs a turn of the loop.
            pace = SLOW_PACE if self._marks else PACE
            self.resume = now + max(0.0, self._under_way - self.window // 2) / pace

    @property
    def last_sent(self) -> "tuple[int, int] | None":
        """The last sample, and fragment of it, that has gone out and can be acknowledged, but is not."""
        return self._marks[-1][0] if self._marks else None

    def acknowledged(self, sequence: int, fragment: int = WHOLE) -> None:
        """Everybody has the samples up to this one, of it the fragments up to `fragment`; or knows that they are lost."""
        marks = self._marks
        count = 0
        while count < len(marks) and marks[count][0] <= (sequence, fragment):
            count += 1
        if not count:
            return
        landed = marks[count - 1][1]
        del marks[:count]
        self._under_way = max(0.0, self._under_way - (landed - self._landed))
        self._landed = landed
        self.resume = 0.0

    def widen(self) -> None:
        """What was under way arrived without loss. Where that was little it says nothing of more."""
        if self.high < self.window // 2:
            return
        self.high = 0.0
        self.window = min(2 * self.window, self._ceiling)
        if self.window >= self._ceiling:
            self._ceiling = min(self._ceiling + STEP, MAX_WINDOW)

    def narrow(self) -> None:
        """Some was lost: half of it, but not below the first; and small steps from near where it was."""
        self.high = 0.0
        self._ceiling = max(self.window * 3 // 4, WINDOW)
        self.window = max(self.window // 2, WINDOW)
