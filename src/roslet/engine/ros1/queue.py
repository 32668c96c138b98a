"""The bounded queue of frames that one connection has yet to send. Runs on MicroPython."""

# What one connection may hold back where its queue is unbounded ("keep all"); then publishing must wait.
MAX_BYTES = 64 << 20


class SendQueue:
    """Frames waiting for a slow peer, oldest first.

    depth     most frames kept, one that has partly gone out not counted; a further one drops the oldest. 0 means no
              such limit: then `full` turns true at `max_bytes` and the publisher has to wait.
    bytes     of all frames kept; a frame counts whole until its last byte has gone.
    dropped   frames dropped so far; `high_water` the most frames that ever waited.
    """

    def __init__(self, depth: int, max_bytes: int = MAX_BYTES) -> None:
        self.depth = depth
        self.max_bytes = max_bytes
        self.dropped = 0
        self.high_water = 0
        self.bytes = 0
        self._frames: list[bytes] = []
        self._first = 0  # index of the oldest frame: popping from the front of a list costs its length
        self._sent = 0  # bytes of the oldest frame that have gone out
        self._begun = False  # whether the oldest frame has partly gone out, perhaps before it was queued

    def __len__(self) -> int:
        return len(self._frames) - self._first

    @property
    def full(self) -> bool:
        """Whether a frame more would go beyond the bound."""
        if self.depth:
            return len(self) - (1 if self._begun else 0) >= self.depth
        return self.bytes >= self.max_bytes

    def push_rest(self, rest: bytes) -> None:
        """Queue what is left of a frame that has partly gone out already. Raises ValueError where others wait: its
        rest would go out behind them, and the stream would be lost."""
        if len(self):
            raise ValueError("the rest of a frame behind other frames")
        self._append(rest)
        self._sent = 0
        self._begun = True

    def push(self, frame: bytes) -> int:
        """Queue a whole frame; returns how many frames were dropped for it (0 or 1)."""
        dropped = 0
        if self.depth and len(self) - (1 if self._begun else 0) >= self.depth:
            dropped = self._drop_oldest()
        self._append(frame)
        return dropped

    def _append(self, frame: bytes) -> None:
        self._frames.append(frame)
        self.bytes += len(frame)
        if len(self) > self.high_water:
            self.high_water = len(self)

    def _drop_oldest(self) -> int:
        at = self._first + (1 if self._begun else 0)
        if at >= len(self._frames):
            return 0
        self.bytes -= len(self._frames[at])
        del self._frames[at]
        self.dropped += 1
        return 1

    def peek(self) -> "list[bytes | memoryview]":
        """The next buffers to send, at most 64, the first one possibly cut."""
        first = self._first
        buffers: list[bytes | memoryview] = list(self._frames[first : first + 64])
        if self._sent:
            buffers[0] = memoryview(self._frames[first])[self._sent :]
        return buffers

    def sent(self, count: int) -> None:
        """`count` bytes of what `peek()` gave have gone out."""
        while count:
            left = len(self._frames[self._first]) - self._sent
            if count < left:
                self._sent += count
                self._begun = True
                return
            count -= left
            self.bytes -= len(self._frames[self._first])
            self._frames[self._first] = b""
            self._first += 1
            self._sent = 0
            self._begun = False
        if self._first == len(self._frames):
            self._frames = []
            self._first = 0
        elif self._first > 256:
            del self._frames[: self._first]
            self._first = 0

    def clear(self) -> int:
        """Forget everything; returns how many frames were given up."""
        count = len(self)
        self._frames = []
        self._first = self._sent = self.bytes = 0
        self._begun = False
        return count
