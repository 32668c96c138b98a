"""A machine on a TCP socket. Nothing here knows ROS: it moves bytes between a socket and a `Machine`'s face."""

from __future__ import annotations

import errno
import socket
import threading
from collections import deque
from contextlib import suppress

from roslet.engine.ros1.framing import Paused
from roslet.errors import ProtocolError
from roslet.io.select import GONE, READ, WRITE, Timer, tune

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from roslet.io.select import Reactor

# Seconds that a peer has to read what is left once a machine wants to close.
LAST_WORDS = 2.0
# Seconds until a queue, or a socket to be closed, that a publishing thread is busy with is looked at again.
BUSY = 0.001
# Host names that may be looked up at a time, each in a thread of its own; more wait.
MAX_LOOKUPS = 8
# Why a connection ends whose peer does not read what it asked for.
UNREAD = "unread-answers"
_BUSY = (errno.EAGAIN, errno.EWOULDBLOCK, errno.EINTR)


class Stream:
    """One connection. `after(stream)` runs after each input, with the loop's lock held, so that its owner can act.

    A machine with a `queue` (a subscriber of our topic) has a `publication`, whose `lock` publishing threads hold while
    they send. The loop never waits for it: one of them may be blocked by some other subscriber for seconds.

    The machine's face: `receive_data(data, now)` or `writable()` and `received(count, now)`; `receive_end(now)` where it
    still answers a peer that sends no more; `data_to_send()`;
    `closing` or `wants_close`; `deadline()`, `handle_deadline(now)`; `connected(now)`; `lost(reason, now)` or
    `connection_lost`, if any; `user` where there is one.
    """

    def __init__(
        self,
        reactor: Reactor,
        machine: Any,
        sock: socket.socket,
        after: Callable[[Stream], None],
        connecting: bool,
    ) -> None:
        self.reactor = reactor
        self.machine = machine
        self.sock = sock
        self.after = after
        self.connecting = connecting
        self.closed = False
        self.broken = False  # whether sending has failed; the loop closes it in a moment
        self.user = False
        self.description = ""
        self.end = ""  # why it was closed
        self._input_ended = False
        self._rest: bytes | memoryview = b""
        self._timer: Timer | None = None
        self._last_words: Timer | None = None
        self._want_lock = threading.Lock()
        self._watched = True  # whether the loop looks at the socket
        self._fd = sock.fileno()
        self._events = WRITE if connecting else READ
        machine.channel = self
        self._into = hasattr(machine, "writable")
        reactor.register(self._fd, self._ready, self._events)
        if not connecting:
            self._describe()
        self.arm()

    @property
    def closing(self) -> bool:
        """Whether the machine wants the connection to end."""
        machine = self.machine
        return bool(machine.wants_close if hasattr(machine, "wants_close") else machine.closing)

    def _describe(self) -> None:
        try:
            ours, theirs = self.sock.getsockname(), self.sock.getpeername()
            self.description = f"TCPROS connection on port {ours[1]} to [{theirs[0]}:{theirs[1]}]"
        except OSError:
            self.description = "a connection that has ended"

    # -- input

    def _ready(self, events: int) -> None:
        if self.closed:
            return
        try:
            if self.connecting:
                self._finish_connect()
                return
            if events & WRITE:
                self.flush()
            if events & (READ | GONE) and not self.closed:
                self._read()
        except Exception as error:
            # A slip of ours must not take the loop down, and the other connections with it.
            self.reactor.report(error)
            self.lose("internal error")

    def _finish_connect(self) -> None:
        code = self.sock.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if code:
            self.lose(f"cannot connect: {errno.errorcode.get(code, code)}")
            return
        if self._is_own_end():
            self.lose("cannot connect: nobody listens there")
            return
        self.connecting = False
        self._describe()
        self._want(READ)
        self.machine.connected(self.reactor.now())
        self.flush()
        self.after(self)
        self.arm()

    def _is_own_end(self) -> bool:
        """Whether the socket has met itself: the kernel may choose the very port that we connect to as ours, where
        that lies among the temporary ones and nobody listens on it any more."""
        try:
            return bool(self.sock.getsockname() == self.sock.getpeername())
        except OSError:
            return False

    def _read(self) -> None:
        machine = self.machine
        try:
            count = self.sock.recv_into(machine.writable() if self._into else self.reactor.room)
        except OSError as error:
            if error.errno not in _BUSY:
                self.lose(error.strerror or str(error))
            return
        if not count:
            self._end_input()
            return
        now = self.reactor.now()
        if self._into:
            machine.received(count, now)
        else:
            machine.receive_data(memoryview(self.reactor.room)[:count], now)
        self.after(self)
        if not self.closed:
            self.flush()
            self.arm()
            if self._into and self.machine.user and not self.user and not self.closed:
                self._become_user(self.machine.take_rest())

    def _end_input(self) -> None:
        """The peer sends no more; it may still read what it asked for."""
        if self._input_ended or not hasattr(self.machine, "receive_end"):
            self.lose("closed by the peer")
            return
        self._input_ended = True
        self.machine.receive_end(self.reactor.now())
        self.after(self)
        if not self.closed:
            self._want(0)  # the end is there to be read for ever
            self.flush()
            self.arm()

    def adopt(self, machine: Any, rest: bytes) -> None:
        """`machine` takes the connection over from the present one, which had `rest` left of the input."""
        machine.channel = self
        machine.take_over(self.machine.data_to_send(), rest)
        self.machine = machine

    def _become_user(self, rest: bytes) -> None:
        """From now on what arrives runs user code: read only while somebody spins, and without the lock."""
        self.user = True
        with self._want_lock:
            self._watched = False
            self.reactor.unregister(self._fd)

        def begin() -> None:
            try:
                if rest and not self.closed:
                    self._take(rest)
            finally:  # Ctrl-C may come in a callback, and spin be called again
                with self._want_lock:
                    if not self.closed:
                        self.reactor.register(self._fd, self._ready_user, self._events, user=True)
                        self._watched = True

        if rest:
            self.reactor.call_soon(begin, user=True)
        else:
            begin()

    def _take(self, rest: bytes) -> None:
        try:
            self.machine.frames.feed(rest)
        except Paused:
            pass
        except ProtocolError as error:
            self.machine.fault(error, self.reactor.now())
        self._after_user()

    def _after_user(self) -> None:
        machine = self.machine
        if machine.closing or machine.replies:
            with self.reactor.lock:
                self.flush()
                self.after(self)
                self._go_on()

    def _go_on(self) -> None:
        """Look at the requests that were left alone while the replies to others waited."""
        if getattr(self.machine, "paused", False) and not self._rest and not self.closed:
            self.reactor.call_soon(self._resume, user=True)

    def _resume(self) -> None:
        if not self.closed and self.machine.paused:
            self.machine.go_on(self.reactor.now())
            self._after_user()

    def _ready_user(self, events: int) -> None:
        if self.closed:
            return
        if events & WRITE:
            with self.reactor.lock:
                self.flush()
                self._go_on()
            if not events & ~WRITE or self.closed:
                return
        machine = self.machine
        try:
            count = self.sock.recv_into(machine.writable())
        except OSError as error:
            if error.errno not in _BUSY:
                with self.reactor.lock:
                    self.lose(error.strerror or str(error))
            return
        if not count:
            with self.reactor.lock:
                self.lose("closed by the peer")
            return
        try:
            machine.frames.received(count)
        except Paused:
            pass
        except ProtocolError as error:
            machine.fault(error, self.reactor.now())
        if machine.closing or machine.replies:
            self._after_user()

    # -- output

    def flush(self) -> None:
        """Send what the machine has; close when it wants to and everything is out."""
        if self.closed or self.connecting:
            if not self.closed and (self.closing or not getattr(self.machine, "wants_connection", True)):
                self.lose("given up")
            return
        data = self.machine.data_to_send()
        if data:
            self._rest = bytes(self._rest) + data if self._rest else data
        if self._rest:
            sent = self.try_send(self._rest)
            if self.closed:
                return
            self._rest = memoryview(self._rest)[sent:] if sent < len(self._rest) else b""
            if self._rest and len(self._rest) > getattr(self.machine, "max_unsent", len(self._rest)):
                self.lose(UNREAD)
                return
        queue = getattr(self.machine, "queue", None)
        if queue is None:
            waiting = bool(self._rest)
            # Who does not take the replies to its requests may not make more of them.
            self._want(WRITE if waiting and self.user else READ | WRITE if waiting else READ)
        else:
            # Publishing threads fill the queue and ask for WRITE under the same lock, so none of their wishes is lost.
            lock = self.machine.publication.lock
            if not lock.acquire(False):
                self._want(READ)
                self.reactor.call_at(self.reactor.now() + BUSY, self.flush)
                return
            try:
                if not self._rest:
                    self._flush_queue(queue)
                waiting = bool(self._rest) or bool(len(queue))
                self._want(READ | WRITE if waiting else READ)
            finally:
                lock.release()
        if self.closing:
            if not waiting or self.broken:
                self.lose(getattr(self.machine, "reason", "") or "closed")
            elif self._last_words is None:
                self._last_words = self.reactor.call_at(
                    self.reactor.now() + LAST_WORDS,
                    lambda: self.lose("closed; the peer did not read the rest"),
                )

    @property
    def unsent(self) -> bool:
        """Whether something waits for room in the socket."""
        queue = getattr(self.machine, "queue", None)
        return not self.closed and bool(self._rest or (queue is not None and len(queue)))

    def take_unsent(self) -> bytes:
        """What is left of a header, for the queue to send it before its frames."""
        rest, self._rest = bytes(self._rest), b""
        return rest

    def _flush_queue(self, queue: Any) -> None:
        while len(queue):
            buffers = queue.peek()
            sent = self.try_send(buffers[0]) if len(buffers) == 1 else self.try_send_many(buffers)
            queue.sent(sent)
            if self.closed or sent < sum(map(len, buffers)):
                return

    def try_send(self, data: Any) -> int:
        """How many bytes the socket took; 0 where it is full or has failed (then `broken` is true)."""
        try:
            return self.sock.send(data)
        except OSError as error:
            return self._send_failed(error)

    def try_send_many(self, buffers: Any) -> int:
        try:
            return self.sock.sendmsg(buffers)
        except OSError as error:
            return self._send_failed(error)

    def _send_failed(self, error: OSError) -> int:
        if error.errno not in _BUSY and not self.broken:
            # Any thread may be here: the loop takes the connection down.
            self.broken = True
            self.reactor.call_soon(lambda: self.lose(error.strerror or str(error)))
        return 0

    def want_write(self) -> None:
        """Flush when the socket has room."""
        self._want(READ | WRITE)

    def pause(self, paused: bool) -> None:
        """Read nothing more, or read on. For connections that only receive."""
        self._want(0 if paused else READ)

    def _want(self, events: int) -> None:
        if self._input_ended:
            events &= ~READ
        with self._want_lock:
            if events != self._events and not self.closed:
                self._events = events
                if self._watched:
                    self.reactor.modify(self._fd, events)

    # -- time and the end

    def arm(self) -> None:
        """One timer for the machine's deadline."""
        when = self.machine.deadline() if not self.closed else None
        timer = self._timer
        if timer is not None:
            if when is not None and timer.function is not None and timer.when <= when:
                return  # it fires early, finds nothing due and is armed again
            timer.cancel()
            self._timer = None
        if when is not None:
            self._timer = self.reactor.call_at(when, self._due)

    def _due(self) -> None:
        self._timer = None
        if not self.closed:
            self.machine.handle_deadline(self.reactor.now())
            self.after(self)
            if not self.closed:
                self.flush()
                self.arm()

    def lose(self, reason: str) -> None:
        """Close the socket and tell the machine."""
        if self.closed:
            return
        self.end = reason
        self.close()
        lose_machine(self.machine, reason, self.reactor.now())
        self.after(self)

    def close(self) -> None:
        """Close the socket without a word to the machine."""
        with self._want_lock:
            if self.closed:
                return
            self.closed = True
            if self._watched:
                self.reactor.unregister(self._fd)
        for timer in (self._timer, self._last_words):
            if timer is not None:
                timer.cancel()
        self._close_socket()

    def _close_socket(self) -> None:
        """A thread that is about to send must not find the descriptor's number given to another connection."""
        publication = getattr(self.machine, "publication", None)
        lock = publication.lock if publication is not None else None
        if lock is None:
            self.sock.close()
        elif lock.acquire(False):
            try:
                self.sock.close()
            finally:
                lock.release()
        else:
            with suppress(OSError):  # it may be gone already
                self.sock.shutdown(socket.SHUT_RDWR)
            self.reactor.call_at(self.reactor.now() + BUSY, self._close_socket)


def lose_machine(machine: Any, reason: str, now: float) -> None:
    """Tell a machine that its connection is gone, or was never made."""
    lost = getattr(machine, "lost", None) or getattr(machine, "connection_lost", None)
    if lost is not None:
        lost(reason, now)


def connect(
    reactor: Reactor,
    machine: Any,
    address: tuple[str, int],
    after: Callable[[Stream], None],
    failed: Callable[[str], None],
    opened: Callable[[Stream], bool] | None = None,
) -> None:
    """Connect `machine` to `address` without blocking; `failed(reason)` where no socket could even be made.
    `opened(stream)` tells the owner of the stream that will connect; false: it is no longer wanted.

    A host that is no address is looked up in a thread of its own: a name server may take seconds.
    """
    host, port = address
    try:
        socket.inet_aton(host)
    except OSError:
        if host != "localhost":
            _lookup(
                reactor, address, lambda found: _open(reactor, machine, found, after, failed, opened), failed
            )
            return
        host = "127.0.0.1"
    _open(reactor, machine, (host, port), after, failed, opened)


def _open(
    reactor: Reactor,
    machine: Any,
    address: tuple[str, int],
    after: Callable[[Stream], None],
    failed: Callable[[str], None],
    opened: Callable[[Stream], bool] | None,
) -> None:
    try:
        sock = socket.socket()
    except OSError as error:
        failed(error.strerror or str(error))
        return
    tune(sock)
    code = sock.connect_ex(address)
    if code not in (0, errno.EINPROGRESS):
        sock.close()
        failed(f"cannot connect: {errno.errorcode.get(code, code)}")
        return
    stream = Stream(reactor, machine, sock, after, connecting=True)
    if opened is not None and not opened(stream):
        stream.close()


_lookups: deque[Callable[[], None]] = deque()
_looking = 0
_lookup_lock = threading.Lock()


def _lookup(
    reactor: Reactor,
    address: tuple[str, int],
    found: Callable[[tuple[str, int]], None],
    failed: Callable[[str], None],
) -> None:
    """Call `found` with the numeric address, or `failed`, in the loop."""
    global _looking

    def run() -> None:
        try:
            numeric = socket.getaddrinfo(address[0], address[1], socket.AF_INET, socket.SOCK_STREAM)[0][4][0]
        except (OSError, ValueError) as error:  # ValueError: a name that cannot even be asked for
            reason = f"cannot find host {address[0]}: {getattr(error, 'strerror', None) or error}"
            reactor.call_soon(lambda: failed(reason))
            return
        reactor.call_soon(lambda: found((str(numeric), address[1])))

    with _lookup_lock:
        if _looking >= MAX_LOOKUPS:
            _lookups.append(run)
            return
        _looking += 1
    threading.Thread(target=_look_up, args=(run,), name="roslet-lookup", daemon=True).start()


def _look_up(run: Callable[[], None]) -> None:
    global _looking
    while True:
        run()
        with _lookup_lock:
            if not _lookups:
                _looking -= 1
                return
            run = _lookups.popleft()
