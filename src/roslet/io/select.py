"""Sockets and the clock for CPython: one loop a process, two sets of descriptors.

*Control* descriptors (RPC, handshakes, subscribers of our topics, service replies) are always served: by whoever spins, or
by one background thread. *User* descriptors (topics we subscribe, service requests) run user code and are read only
inside `spin`; until then their bytes wait in the kernel and the sender feels it.
"""

from __future__ import annotations

import errno
import heapq
import os
import select
import socket
import sys
import threading
from collections import deque
from time import monotonic, sleep

from roslet.io import interrupts

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    Handler = Callable[[int], None]

if hasattr(select, "epoll"):
    READ, WRITE, GONE = select.EPOLLIN, select.EPOLLOUT, select.EPOLLERR | select.EPOLLHUP
    _SCALE = 1.0  # epoll takes seconds
else:  # pragma: no cover - other systems than Linux
    READ, WRITE, GONE = select.POLLIN, select.POLLOUT, select.POLLERR | select.POLLHUP
    _SCALE = 1000.0  # poll takes milliseconds

# Bytes taken from a control connection in one go.
ROOM = 64 << 10
# The longest sleep of an idle loop: bounds the harm of a wake-up that got lost. Seconds.
MAX_SLEEP = 60.0
# Seconds to look for input before sleeping, where the last sleep was shorter than BRISK: two programs that answer each
# other otherwise wake each other up, on an idle processor for 100 us each time, and never find out of it. Messages that
# come at long intervals never pay for this; those at middling ones soon stop paying.
BUSY_WAIT = 250e-6
BRISK = 500e-6
# After this many looks in vain the loop looks once in 2 to this power sleeps.
MAX_VAIN = 10
# After so many sleeps running that were shorter than BUSY_WAIT it looks again in any case: it would not have been in vain.
STREAK = 4
# Seconds the background thread waits after a spin before it takes the loop back.
LINGER = 0.005


def _poller() -> Any:
    return select.epoll() if hasattr(select, "epoll") else select.poll()


_yield = getattr(os, "sched_yield", lambda: None)


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _print(error: BaseException) -> None:
    """To standard error, with where it came from."""
    sys.excepthook(type(error), error, error.__traceback__)


class Timer:
    """One call at a time in the future; `cancel()` forgets it."""

    __slots__ = ("function", "when")

    def __init__(self, when: float, function: Callable[[], None] | None) -> None:
        self.when = when
        self.function = function

    def cancel(self) -> None:
        self.function = None


class _Timers:
    def __init__(self) -> None:
        self._heap: list[tuple[float, int, Timer]] = []
        self._serial = 0

    def add(self, timer: Timer) -> None:
        self._serial += 1
        heapq.heappush(self._heap, (timer.when, self._serial, timer))

    def deadline(self) -> float | None:
        heap = self._heap
        while heap and heap[0][2].function is None:
            heapq.heappop(heap)
        return heap[0][0] if heap else None

    def pop_due(self, now: float) -> Callable[[], None] | None:
        heap = self._heap
        while heap and (heap[0][0] <= now or heap[0][2].function is None):
            function = heapq.heappop(heap)[2].function
            if function is not None:
                return function
        return None


class _Waker:
    """A pipe whose end `fd` is readable from a call of `wake` until `heard`, which is its handler."""

    def __init__(self) -> None:
        self.fd, self._write = os.pipe()
        os.set_blocking(self.fd, False)
        os.set_blocking(self._write, False)
        self.awake = False

    def wake(self) -> None:
        if not self.awake:
            self.awake = True
            self.interrupt()

    def interrupt(self) -> None:
        """The same from a signal handler: looks at nothing, takes no lock."""
        try:
            os.write(self._write, b"\0")
        except OSError:
            return  # full: it is readable as it is; or closed: nobody is left to wake

    def heard(self, events: int) -> None:
        try:
            os.read(self.fd, 64)
        except BlockingIOError:
            return
        finally:
            # Not before: a byte written in between would be read here too, and every later wake would believe it still to
            # come. Who finds this true writes nothing, and what he wants done is seen in this very turn.
            self.awake = False

    def close(self) -> None:
        # First out of reach: another thread may call soon, and the number may be another file's by then.
        write, self._write = self._write, -1
        os.close(write)
        os.close(self.fd)


class Reactor:
    """The loop. Any thread may call any method; `lock` guards control state and is never held while user code runs."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        # What control connections receive into, one after the other: a machine takes what it wants of it at once.
        self.room = bytearray(ROOM)
        self._control = _poller()
        self._all = _poller()
        self._handlers: dict[int, tuple[Handler, bool]] = {}
        self._timers = _Timers()
        self._user_timers = _Timers()
        self._soon: deque[Callable[[], None]] = deque()
        self._user_soon: deque[Callable[[], None]] = deque()
        self._turn = threading.Lock()
        self._changed = (
            threading.Condition()
        )  # of a reentrant lock: a predicate may wait for something itself
        self._waiting = 0
        self._callers = 0  # threads that would serve user code and wait for the turn
        self._lent = False  # whether the background thread has ever handed the loop to a spinner
        self._owner = 0  # the thread that has the turn
        self._serves_users = False  # whether it serves user code
        self._spinners = 0
        self._user_turns = 0  # of the loop, in which user code was served
        self._idle = threading.Event()
        self._idle.set()
        self._thread: threading.Thread | None = None
        self._error: BaseException | None = None
        self._stopped = False
        # Called when a thread that served users has stopped, until they return false.
        self.watchers: list[Callable[[], bool]] = []
        # Seconds; 0 turns it off, as on a machine where the other side needs this very processor to answer.
        self.busy_wait = BUSY_WAIT if _processors() > 1 else 0.0
        self._brisk = False  # whether the last sleep was a short one
        self._vain = 0  # looks in vain since the last good one
        self._skips = 0  # sleeps before the next look
        self._streak = 0  # sleeps running that a look would have spared
        # Two, since a loop that serves control traffic only must not take from `fileno` that a user's call waits.
        self._waker, self._user_waker = _Waker(), _Waker()
        self.register(self._waker.fd, self._waker.heard)
        self.register(self._user_waker.fd, self._user_waker.heard, user=True)

    # -- registration

    def register(self, fd: int, handler: Handler, events: int = READ, user: bool = False) -> None:
        """Call `handler(events)` when `fd` is ready. `user`: only while somebody spins, and without `lock` held."""
        self._handlers[fd] = (handler, user)
        self._all.register(fd, events)
        if not user:
            self._control.register(fd, events)
            self._ensure_thread()

    def modify(self, fd: int, events: int) -> None:
        self._all.modify(fd, events)
        if not self._handlers[fd][1]:
            self._control.modify(fd, events)

    def unregister(self, fd: int) -> None:
        entry = self._handlers.pop(fd, None)
        if entry is not None:
            self._all.unregister(fd)
            if not entry[1]:
                self._control.unregister(fd)

    def call_at(self, when: float, function: Callable[[], None], user: bool = False) -> Timer:
        """Call `function` at `when` (`now()`'s seconds), control ones with `lock` held."""
        timer = Timer(when, function)
        with self.lock:
            timers = self._user_timers if user else self._timers
            soonest = timers.deadline()
            timers.add(timer)
        if soonest is None or when < soonest:
            self._wake(user)
        return timer

    def call_soon(self, function: Callable[[], None], user: bool = False) -> None:
        """Call `function` in the loop's next turn."""
        (self._user_soon if user else self._soon).append(function)
        self._wake(user)

    def now(self) -> float:
        return monotonic()

    def fileno(self) -> int:
        """A descriptor that is readable when a turn would find something to do; -1 where there is none."""
        return int(self._all.fileno()) if hasattr(self._all, "fileno") else -1

    def user_deadline(self) -> float | None:
        """When the next timer of a user is due."""
        with self.lock:
            return self._user_timers.deadline()

    def wake(self) -> None:
        """End the loop's present sleep, unless the caller is the loop."""
        self._wake(False)

    def interrupt(self) -> None:
        """The same whoever calls: a signal handler too, which runs in the very thread that sleeps. Takes no lock."""
        self._waker.interrupt()

    def _wake(self, user: bool) -> None:
        """The same; with `user` for what only a loop that serves users will do: who watches `fileno` is told then, too, by a
        caller that is a loop itself but serves none."""
        if self._owner != threading.get_ident() or (user and not self._serves_users):
            (self._user_waker if user else self._waker).wake()

    # -- running

    @property
    def in_loop(self) -> bool:
        """Whether the calling thread is the one that runs the loop now."""
        return self._owner == threading.get_ident()

    def run_until(
        self, predicate: Callable[[], object], timeout: float | None = None, user: bool = True
    ) -> bool:
        """Serve until `predicate()` is true or `timeout` seconds have passed; says which (true: the predicate).

        With `user` false only control traffic is served. Called from within a callback it serves control traffic in the
        same way, so that a callback may wait for a service. An exception that a callback raised is raised here, or where
        the loop around that callback was entered.
        """
        if predicate():
            return True
        end = None if timeout is None else monotonic() + timeout
        if self._owner == threading.get_ident():
            return bool(self._loop(predicate, end, False, False))
        with self.lock:
            self._spinners += 1
            self._callers += user
            self._idle.clear()
        self.wake()
        try:
            while True:
                if not self._take_turn(predicate, end, user):
                    return bool(predicate())
                try:
                    served = self._loop(predicate, end, user, not user)
                finally:
                    self._give_up_turn()
                if served is not None:
                    return served
        finally:
            with self.lock:
                self._spinners -= 1
                if not self._spinners:
                    self._idle.set()
                if user and self.watchers:
                    self.watchers[:] = [watcher for watcher in self.watchers if watcher()]

    def _take_turn(self, predicate: Callable[[], object], end: float | None, user: bool) -> bool:
        """Wait for the turn; false where `predicate()` came true, or the time was up, before. The caller has counted itself
        in `_callers` if `user`."""
        try:
            # A thread that serves user code goes before those that only wait for an answer: theirs may depend on it.
            while (not user and self._callers) or not self._turn.acquire(False):
                # Somebody else runs the loop: it tells when it has done something, and when it gives up the turn.
                with self._changed:
                    if predicate():
                        return False
                    self._waiting += 1
                    try:
                        self._changed.wait(self._left(end, 0.05))
                    finally:
                        self._waiting -= 1
                if end is not None and monotonic() >= end:
                    return False
        finally:
            if user:
                with self.lock:
                    self._callers -= 1
        self._owner = threading.get_ident()
        self._serves_users = user
        if self._waker.awake:
            # It was for whoever had the turn; it must not end our first sleep.
            self._waker.heard(READ)
        return True

    def _give_up_turn(self) -> None:
        self._owner = 0
        self._serves_users = False
        self._turn.release()
        if self._waiting:
            with self._changed:
                self._changed.notify_all()

    def run_turn(self, timeout: float) -> None:
        """Serve one turn of the loop, which waits at most `timeout` seconds for something to do."""
        before = self._user_turns
        self.run_until(lambda: self._user_turns != before, timeout)

    @staticmethod
    def _left(end: float | None, most: float) -> float:
        return most if end is None else max(0.0, min(most, end - monotonic()))

    def _loop(
        self, predicate: Callable[[], object], end: float | None, user: bool, yields: bool
    ) -> bool | None:
        """Whether the predicate came true before the time was up; None where `yields` and another thread, which serves
        user code as well, waits for the turn."""
        turn = self._run_turn
        while not predicate():  # first of all: it may have come true while another thread had the loop
            if end is not None and monotonic() >= end:
                return False
            if yields and self._callers:
                return None
            turn(end, user)
            # A wait within a callback, which neither serves users nor yields, leaves what another callback has raised to
            # the loop around it: to raise it there would break off whatever waits, such as the closing of a node.
            if self._error is not None and (user or yields):
                error, self._error = self._error, None
                raise error
        return True

    def _run_turn(self, end: float | None, user: bool) -> None:
        """One sleep and what follows it."""
        soonest = self._timers.deadline()
        if user:
            other = self._user_timers.deadline()
            if other is not None and (soonest is None or other < soonest):
                soonest = other
        if self._soon or (user and self._user_soon):
            pause = 0.0
        elif soonest is None and end is None:
            pause = MAX_SLEEP
        else:
            if soonest is None or (end is not None and end < soonest):
                soonest = end
            pause = soonest - monotonic()  # type: ignore[operator]
            if pause < 0.0:
                pause = 0.0
            elif pause > MAX_SLEEP:
                pause = MAX_SLEEP
        handlers = self._handlers
        for fd, events in self._wait(self._all if user else self._control, pause):
            entry = handlers.get(fd)
            if entry is None:
                continue
            if entry[1]:
                entry[0](events)
            else:
                with self.lock:
                    entry[0](events)
        if self._soon:
            self._run_soon(self._soon, True)
        if user and self._user_soon:
            self._run_soon(self._user_soon, False)
        if soonest is not None:
            now = monotonic()
            if now >= soonest:
                self._run_timers(now, user)
        self._user_turns += user
        if self._waiting:
            with self._changed:
                self._changed.notify_all()

    def _wait(self, poller: Any, pause: float) -> Any:
        """What is ready within `pause` seconds. While input comes in quick succession, look again and again for a
        moment before sleeping: waking up costs tens of microseconds, more than handling a small message. Looking in
        vain is paid for by not looking at all for a while, twice as long each time."""
        if self._brisk and pause:
            if self._skips:
                self._skips -= 1
            else:
                end = monotonic() + self.busy_wait
                while True:
                    ready = poller.poll(0)
                    if ready:
                        self._vain = 0
                        return ready
                    if monotonic() >= end:
                        break
                    _yield()  # the other side may be waiting for this very processor
                self._vain = min(self._vain + 1, MAX_VAIN)
                self._skips = (1 << self._vain) - 1
                pause = max(0.0, pause - self.busy_wait)
        begin = monotonic()
        ready = poller.poll(pause * _SCALE)
        slept = monotonic() - begin
        self._brisk = bool(ready) and slept < BRISK and self.busy_wait > 0.0
        if self._skips:
            self._streak = self._streak + 1 if ready and slept < self.busy_wait else 0
            if self._streak == STREAK:
                self._streak = self._skips = 0
        return ready

    def _run_soon(self, queue: deque[Callable[[], None]], locked: bool) -> None:
        for _ in range(len(queue)):
            if not queue:
                return  # one of the functions has waited, and served the rest meanwhile
            function = queue.popleft()
            if locked:
                with self.lock:
                    function()
            else:
                self.guard(function)

    def _run_timers(self, now: float, user: bool) -> None:
        while True:
            with self.lock:
                function = self._timers.pop_due(now)
                if function is None:
                    break
                function()
        while user:
            with self.lock:
                function = self._user_timers.pop_due(now)
            if function is None:
                break
            self.guard(function)

    def guard(self, function: Callable[..., object], *arguments: object) -> None:
        """Run user code; what it raises comes out of `run_until`, or is printed where nobody waits there."""
        try:
            function(*arguments)
        except Exception as error:
            self.report(error)

    def report(self, error: Exception) -> None:
        """Note an exception of user code: the first one leaves the loop at the end of this turn."""
        if self._error is None:
            self._error = error
        else:
            _print(error)

    # -- the background thread

    def _ensure_thread(self) -> None:
        if self._thread is None and len(self._handlers) > 2:  # more than the two that wake
            self._thread = threading.Thread(target=self._background, name="roslet", daemon=True)
            self._thread.start()

    def _background(self) -> None:
        while not self._stopped:
            self._idle.wait()
            if self._lent:
                # Somebody has just stopped spinning and may be back at once: a change of threads costs more than a turn.
                sleep(LINGER)
                if self._spinners:
                    continue
            self._turn.acquire()
            self._owner = threading.get_ident()
            try:
                while not self._spinners and not self._stopped:
                    try:
                        self._run_turn(None, False)
                    except Exception as error:
                        # A slip of ours; without this thread the process would go silent.
                        _print(error)
                    if self._error is not None:
                        raised, self._error = self._error, None
                        _print(raised)
            finally:
                self._lent = True
                self._give_up_turn()

    def close(self) -> None:
        """End the background thread and close the loop's own descriptors. The loop must not be used after."""
        self._stopped = True
        self._idle.set()
        self.wake()
        thread = self._thread
        if thread is not None and thread is not threading.current_thread():
            thread.join(2.0)
        for poller in (self._control, self._all):
            if hasattr(poller, "close"):
                poller.close()
        self._waker.close()
        self._user_waker.close()

    def abandon(self) -> None:
        """Close the descriptors of a loop that a forked child has inherited."""
        self._stopped = True
        self._handlers = {}
        for poller in (self._control, self._all):
            if hasattr(poller, "close"):
                poller.close()
        self._waker.close()
        self._user_waker.close()


_reactor: Reactor | None = None
_reactor_lock = threading.Lock()


def reactor() -> Reactor:
    """The process's loop, made at the first call and made anew in a forked child."""
    global _reactor
    with _reactor_lock:
        if _reactor is None:
            _reactor = Reactor()
        interrupts.watch(_reactor.lock)
        return _reactor


def _forked() -> None:
    """In the child: the loop, its threads and what its poller watches are the parent's. Only descriptors are closed: to
    unregister one would take it from the parent's poller, which is the same."""
    global _reactor, _reactor_lock
    old, _reactor = _reactor, None
    _reactor_lock = threading.Lock()
    if old is not None:
        old.abandon()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forked)


def listen(host: str, port: int = 0, backlog: int = 128) -> socket.socket:
    """A listening, non-blocking TCP socket."""
    sock = socket.socket()
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sock.bind((host, port))
        sock.listen(backlog)
        sock.setblocking(False)
    except OSError:
        sock.close()
        raise
    return sock


# How a peer that has vanished without a word is noticed, in seconds: after KEEPIDLE of silence it is asked every KEEPINTVL,
# KEEPCNT times; what was sent to it may wait for UNACKED.
KEEPIDLE = 10
KEEPINTVL = 4
KEEPCNT = 4
UNACKED = 26


def tune(sock: socket.socket) -> None:
    """No delay for small messages, and a dead peer is noticed within half a minute."""
    sock.setblocking(False)
    sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in (
        ("TCP_KEEPIDLE", KEEPIDLE),
        ("TCP_KEEPINTVL", KEEPINTVL),
        ("TCP_KEEPCNT", KEEPCNT),
        ("TCP_USER_TIMEOUT", UNACKED * 1000),
    ):
        option = getattr(socket, name, None)
        if option is not None:
            sock.setsockopt(socket.IPPROTO_TCP, option, value)


# accept() failures that mean "no descriptors left": wait instead of spinning.
EXHAUSTED = (errno.EMFILE, errno.ENFILE, errno.ENOBUFS, errno.ENOMEM)
