"""Where a rospy program's callbacks run: each topic, each service connection has a thread of its own, so that a callback
may wait for what another callback brings. Messages wait in a queue of the subscriber's size."""

from __future__ import annotations

import threading
import traceback
from collections import deque
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

# A subscriber without queue_size keeps at most so many messages; then its connection is not read until there is room, so
# that the publisher feels it. rospy holds what one read of the socket gave, 64 KiB of small messages.
UNBOUNDED = 1000


class Worker:
    """Calls `work(item)` in a thread for each item put, in order. With `size`, an item that comes when that many wait
    drops the oldest. The thread starts with the first item and ends with `close`."""

    def __init__(self, name: str, work: Callable[[Any], object], size: int | None = None) -> None:
        self.name = name
        self.dropped = 0
        self.closed = False
        self._work = work
        self._items: deque[Any] = deque()
        self._size = size
        self._ready = threading.Condition(threading.Lock())
        self._waiting = False
        self._thread: threading.Thread | None = None

    @property
    def size(self) -> int | None:
        return self._size

    @size.setter
    def size(self, size: int | None) -> None:
        self._size = size

    def __len__(self) -> int:
        return len(self._items)

    def put(self, item: Any) -> None:
        """Never blocks."""
        with self._ready:
            if self.closed:
                return
            if self._size is not None and len(self._items) >= self._size:
                self._items.popleft()
                self.dropped += 1
            self._items.append(item)
            if self._waiting:
                self._ready.notify()
            elif self._thread is None:
                self._thread = threading.Thread(target=self._run, name=self.name, daemon=True)
                self._thread.start()

    def _run(self) -> None:
        while True:
            with self._ready:
                while not self._items:
                    if self.closed:
                        return
                    self._waiting = True
                    self._ready.wait()
                    self._waiting = False
                item = self._items.popleft()
            try:
                self._work(item)
            except Exception:
                # The program's code is guarded where it is called. What fails here is a slip of ours: it is shown, and
                # the topic does not fall silent for it.
                traceback.print_exc()

    def close(self) -> None:
        """No further items; what waits is dropped, what runs goes on."""
        with self._ready:
            self.closed = True
            self._items.clear()
            self._ready.notify()
