"""When what is due: one heap for all machines of a participant, so that no datagram makes anybody look at all of them."""

import heapq

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

# Entries of alarms that were taken back, beyond as many as are valid, before the heap is made anew.
SLACK = 64


class Alarm:
    """Calls `function(now)` once, at or after the earliest time it was set to. A machine that needs it later than that lets
    it ring, looks at its own times, and sets it again: moving a time back costs nothing."""

    __slots__ = ("_schedule", "at", "function")

    def __init__(self, schedule: "Schedule", function: "Callable[[float], None]") -> None:
        self.at: float | None = None
        self.function = function
        self._schedule = schedule

    def set(self, at: float) -> None:
        """Ring at `at`, or earlier where it is set to an earlier time."""
        if self.at is None:
            self._schedule.live += 1
        elif at >= self.at:
            return
        self.at = at
        self._schedule.push(at, self)

    def cancel(self) -> None:
        """Do not ring."""
        if self.at is not None:
            self.at = None
            self._schedule.live -= 1


class Schedule:
    """The alarms of a participant. `live`: how many are set."""

    def __init__(self) -> None:
        self.live = 0
        self._heap: list[tuple[float, int, Alarm]] = []
        self._serial = 0

    def push(self, at: float, alarm: Alarm) -> None:
        """What `Alarm.set` does."""
        heap = self._heap
        if len(heap) > 2 * self.live + SLACK:
            valid = [entry for entry in heap if entry[2].at == entry[0]]
            heap[:] = valid
            heapq.heapify(heap)
        self._serial += 1
        heapq.heappush(heap, (at, self._serial, alarm))

    def deadline(self) -> "float | None":
        """The earliest time of an alarm."""
        heap = self._heap
        while heap and heap[0][2].at != heap[0][0]:
            heapq.heappop(heap)
        return heap[0][0] if heap else None

    def ring(self, now: float) -> None:
        """Let those ring whose time has come; one that is set to a time past while this runs waits for the next call."""
        heap = self._heap
        if not heap or heap[0][0] > now:
            return
        due = []
        while heap and heap[0][0] <= now:
            entry = heapq.heappop(heap)
            if entry[2].at == entry[0]:
                entry[2].cancel()
                due.append(entry[2])
        for alarm in due:
            alarm.function(now)
