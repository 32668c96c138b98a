"""Cuts a TCPROS byte stream into frames, in place: the bytes that arrive are the bytes a message's views show.

The shell asks `writable()` for room, receives into it, and says `received(n)`; each complete frame goes to
`deliver(view, start, end)` at once, in the same thread. Runs on MicroPython.

Memory: small frames share one chunk of `CHUNK` bytes. A frame that does not fit gets a buffer of its own, of at most
`FIRST_LARGE` bytes at first, which then at most doubles as bytes arrive: a length that lies costs its sender half of
what it costs us. After delivery such a buffer serves the next large frame unless a view on it is still alive; then it
belongs to whoever holds the view.
"""

from roslet.errors import ProtocolError
from roslet.wire.primitives import uint32
from roslet.wire.tcpros import MAX_FRAME

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable

# One receive call takes at most this much of a burst of small frames.
CHUNK = 64 << 10
# The first allocation for a large frame; it doubles as bytes arrive.
FIRST_LARGE = 4 << 20


class Paused(Exception):
    """Raised by `deliver` to leave the frames behind this one where they are; `received(0)` goes on with them."""


class FrameReceiver:
    """See the module. What `deliver` raises comes out of `received`; the frame counts as delivered.

    `maximum` bounds a frame's body in bytes; a longer one raises ProtocolError frame-too-large.

    `prefix` bytes stand before each length (1 for service replies, else 0); `deliver` gets the start of the body and
    finds the prefix at `start - 4 - prefix`. With `copies` each small frame is delivered in a buffer of its own, for
    types whose messages hold views: one small message that is kept must not keep a whole chunk alive. With `lends` views
    are good until `deliver` returns: a large frame's buffer then always serves the next one.
    """

    def __init__(
        self,
        deliver: "Callable[[memoryview, int, int], None]",
        maximum: int = MAX_FRAME,
        prefix: int = 0,
        chunk: int = CHUNK,
        copies: bool = False,
        lends: bool = False,
    ) -> None:
        self.deliver = deliver if maximum >= chunk else self._checked(deliver)
        self.copies = copies
        self.lends = lends
        self.maximum = maximum
        self._head = 4 + prefix
        self._prefix = prefix
        self._chunk_size = chunk
        self._chunk_view = memoryview(b"")  # made when the first bytes come; many links never receive any
        self._start = 0
        self._end = 0
        self._large: bytearray | None = None  # the buffer of the large frame being received
        self._large_size = 0  # bytes of that frame, head included
        self._large_end = 0  # bytes of it received
        self._spare: bytearray | None = None

    def _checked(
        self, deliver: "Callable[[memoryview, int, int], None]"
    ) -> "Callable[[memoryview, int, int], None]":
        """Only where the bound lies below the chunk: then a frame that is whole already may still be too long."""

        def checked(view: memoryview, start: int, end: int) -> None:
            if end - start > self.maximum:
                raise _too_large(end - start, self.maximum)
            deliver(view, start, end)

        return checked

    @property
    def pending(self) -> int:
        """Bytes received of a frame that is not complete."""
        return self._large_end if self._large is not None else self._end - self._start

    def writable(self) -> memoryview:
        """Room for the next bytes, at least one."""
        large = self._large
        if large is None:
            if not self._chunk_view:
                self._chunk_view = memoryview(bytearray(self._chunk_size))
            return self._chunk_view[self._end :] if self._end else self._chunk_view
        if self._large_end == len(large):
            grown = bytearray(min(self._large_size, 2 * len(large)))
            grown[: self._large_end] = large
            self._large = large = grown
        return memoryview(large)[self._large_end : self._large_size]

    def received(self, count: int) -> None:
        """`count` bytes now stand in what `writable()` gave. Raises ProtocolError frame-too-large."""
        if self._large is not None:
            self._large_end += count
            if self._large_end == self._large_size:
                self._finish_large()
            return
        self._end = end = self._end + count
        view = self._chunk_view
        start = self._start
        head = self._head
        try:
            while end - start >= head:
                size = uint32(view, start + head - 4)
                body = start + head
                if size > end - body:
                    if size > self.maximum:
                        raise _too_large(size, self.maximum)
                    if head + size > len(view):
                        self._begin_large(start, end, head + size)
                        start = end = 0
                    break
                self._start = start = body + size
                if self.copies:
                    self.deliver(memoryview(bytearray(view[body:start])), 0, size)
                else:
                    self.deliver(view, body, start)
        finally:
            # Also when `deliver` raises: the next bytes need room.
            if start == end:
                self._start = self._end = 0
            elif len(view) - start < len(view) // 4 or end == len(view):
                rest = bytes(view[start:end])
                view[: len(rest)] = rest
                self._start, self._end = 0, len(rest)

    def feed(self, data: "bytes | bytearray | memoryview") -> None:
        """Receive `data` by copying it: for tests and for shells that cannot receive into a buffer."""
        at = 0
        while at < len(data):
            room = self.writable()
            count = min(len(room), len(data) - at)
            room[:count] = data[at : at + count]
            del room  # a view of ours must not look like one that a message holds
            at += count
            self.received(count)

    def _begin_large(self, start: int, end: int, size: int) -> None:
        have = end - start
        spare = self._spare
        if spare is not None and len(spare) >= size:
            large, self._spare = spare, None
        else:
            large = bytearray(min(size, max(FIRST_LARGE, have)))
        large[:have] = self._chunk_view[start:end]
        self._large, self._large_size, self._large_end = large, size, have
        self._start = self._end = 0

    def _finish_large(self) -> None:
        large, size = self._large, self._large_size
        self._large = None
        if large is None:
            return
        self.deliver(memoryview(large), self._head, size)
        if (self.lends or _unshared(large)) and (self._spare is None or len(self._spare) <= len(large)):
            self._spare = large


def _too_large(size: int, maximum: int) -> ProtocolError:
    return ProtocolError("frame-too-large", "%d bytes; at most %d are accepted" % (size, maximum))


def _unshared(buffer: bytearray) -> bool:
    """Whether no view on `buffer` is alive: a bytearray that is exported refuses to change its length. MicroPython
    cannot tell."""
    if not hasattr(buffer, "pop"):
        return False
    try:
        last = buffer.pop()
    except BufferError:
        return False
    buffer.append(last)
    return True
