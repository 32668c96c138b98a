"""A TCP connection and the machine of the ROS 1 engine that speaks on it."""

import errno
import gc

from roslet.io.micropython.loop import GONE, READ, WRITE

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

    from roslet.io.micropython.ros1 import Ros1Shell

UNREAD = "unread-answers"
# Seconds that a connection that is to be closed may take for what it still has to send.
LAST_WORDS = 2.0


class Stream:
    """`kind`: "rpc" or "tcpros" where the connection came in, else "out"."""

    def __init__(self, shell: "Ros1Shell", machine: "Any", sock: "Any", kind: str, host: str = "") -> None:
        self.shell = shell
        self.machine = machine
        self.sock = sock
        self.kind = kind
        self.host = host
        self.closed = False
        self.connecting = kind == "out"
        self.description = "TCPROS connection"
        self.rest: bytes | memoryview = b""
        self._user = False
        self._end: float | None = None
        self._events = WRITE if self.connecting else READ
        machine.channel = self
        shell.loop.register(sock, self.ready, self._events)

    @property
    def closing(self) -> bool:
        """Whether the machine wants the connection to end."""
        machine = self.machine
        return bool(machine.wants_close if hasattr(machine, "wants_close") else machine.closing)

    def deadline(self) -> "float | None":
        """When the machine's time is up, or that of the last words."""
        return self._end if self._end is not None else self.machine.deadline()

    def handle_deadline(self, now: float) -> None:
        """Let the machine look at the time."""
        if self._end is not None and now >= self._end:
            self.lose("closed; the peer did not read the rest")
            return
        self.machine.handle_deadline(now)
        self.flush()
        self.shell.after(self)

    # -- input

    def ready(self, events: int) -> None:
        """The poller's call."""
        if self.connecting:
            if events & GONE:
                self.lose("cannot connect")
                return
            self.connecting = False
            self._want(READ)
            self.machine.connected(self.shell.loop.now())
            self.flush()
            self.shell.after(self)
            return
        if events & WRITE:
            self.flush()
        if events & (READ | GONE) and not self.closed:
            self._read()

    def _read(self) -> None:
        machine = self.machine
        into = hasattr(machine, "writable")
        room = machine.writable() if into else self.shell.room
        try:
            count = self.sock.readinto(room)
        except OSError as error:
            self.lose("lost: errno %d" % error.errno if error.errno else "lost")
            return
        if count is None:
            return
        now = self.shell.loop.now()
        if not count:
            if hasattr(machine, "receive_end"):
                machine.receive_end(now)
                self.shell.after(self)
                self.flush()
            self.lose("closed by the peer")
            return
        try:
            if into:
                machine.received(count, now)
                self._begin_user()
            else:
                machine.receive_data(memoryview(room)[:count], now)
        except MemoryError:
            self.shell.engine.count("no-memory")
            self.lose("no memory for what came")
            gc.collect()
            return
        self.shell.after(self)
        self.flush()

    def adopt(self, machine: "Any", rest: bytes) -> None:
        """`machine` takes the connection over."""
        machine.channel = self
        machine.take_over(self.machine.data_to_send(), rest)
        self.machine = machine
        self._begin_user()

    def _begin_user(self) -> None:
        """What came behind the header may run user code from now on."""
        machine = self.machine
        if machine.user and not self._user:
            self._user = True
            rest = machine.take_rest()
            if rest:
                machine.receive_data(rest, self.shell.loop.now())

    # -- output

    def flush(self) -> None:
        """Send what the machine has; close when it wants to and everything is out."""
        if self.closed or self.connecting:
            return
        machine = self.machine
        data = machine.data_to_send()
        if data:
            self.rest = bytes(self.rest) + data if self.rest else data
        if self.rest:
            sent = self.send(self.rest)
            if self.closed:
                return
            self.rest = memoryview(self.rest)[sent:] if sent < len(self.rest) else b""
            if len(self.rest) > self.shell.max_unsent:
                self.shell.engine.count(UNREAD)
                self.lose("the peer does not read its answers")
                return
        queue = getattr(machine, "queue", None)
        if queue is not None and not self.rest:
            while len(queue):
                first = queue.peek()[0]
                sent = self.send(first)
                if self.closed:
                    return
                queue.sent(sent)
                if sent < len(first):
                    break
        waiting = bool(self.rest) or (queue is not None and len(queue) > 0)
        self._want(READ | WRITE if waiting else READ)
        if getattr(machine, "paused", False) and not waiting:
            machine.go_on(self.shell.loop.now())
        if self.closing:
            if not waiting:
                self.lose(getattr(machine, "reason", "") or "closed")
            elif self._end is None:
                self._end = self.shell.loop.now() + LAST_WORDS

    def send(self, data: "Any") -> int:
        """How many bytes the socket took; 0 where it is full or has failed, and then `closed` is true."""
        try:
            return self.sock.send(data)  # type: ignore[no-any-return]
        except OSError as error:
            if error.errno != errno.EAGAIN:
                self.lose("cannot send")
            return 0

    def want_write(self) -> None:
        """Flush when the socket has room."""
        self._want(READ | WRITE)

    def _want(self, events: int) -> None:
        if events != self._events and not self.closed:
            self._events = events
            self.shell.loop.modify(self.sock, events)

    # -- the end

    def lose(self, reason: str) -> None:
        """Close the socket and tell the machine."""
        if self.closed:
            return
        self.close()
        lose_machine(self.machine, reason, self.shell.loop.now())
        self.shell.after(self)

    def close(self) -> None:
        """Close the socket without a word to the machine."""
        if not self.closed:
            self.closed = True
            self.shell.loop.unregister(self.sock)
            self.sock.close()


def lose_machine(machine: "Any", reason: str, now: float) -> None:
    """Tell a machine that its connection is gone, or was never made."""
    lost = getattr(machine, "lost", None) or getattr(machine, "connection_lost", None)
    if lost is not None:
        lost(reason, now)
