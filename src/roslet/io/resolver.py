"""Host names to IPv4 addresses, without blocking the loop."""

from __future__ import annotations

import socket
import threading

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from roslet.io.select import Reactor, Timer

# Seconds until a name that could not be resolved is tried again: name servers come up late.
AGAIN = 30.0
# Addresses of one name that are used.
MAX_ADDRESSES = 4


def literal(host: str) -> bool:
    """Whether this is an address already."""
    try:
        socket.inet_pton(socket.AF_INET, host)
    except OSError:
        return False
    return True


class Resolver:
    """Resolves names in a thread of its own, one after the other, and those that fail again every AGAIN seconds.

    In the loop, with the reactor's lock held: `found(name, addresses)` once for each name, `failed(name, reason)` at a
    name's first failure only. At most one thread at a time; it ends when it has tried every name.
    """

    def __init__(
        self,
        reactor: Reactor,
        names: Sequence[str],
        found: Callable[[str, tuple[str, ...]], None],
        failed: Callable[[str, str], None],
    ) -> None:
        self._reactor = reactor
        self._left = list(names)
        self._told: set[str] = set()
        self._found = found
        self._failed = failed
        self._closed = False
        self._lock = threading.Lock()
        self._timer: Timer | None = None
        self._start()

    def _start(self) -> None:
        self._timer = None
        if self._left and not self._closed:
            threading.Thread(
                target=self._run, args=(tuple(self._left),), name="roslet resolver", daemon=True
            ).start()

    def _run(self, names: tuple[str, ...]) -> None:
        answers: list[tuple[str, tuple[str, ...], str]] = []
        for name in names:
            if self._closed:
                return
            try:
                rows = socket.getaddrinfo(name, None, socket.AF_INET, socket.SOCK_DGRAM)
                answers.append((name, tuple(str(row[4][0]) for row in rows[:MAX_ADDRESSES]), ""))
            except (OSError, UnicodeError) as error:
                answers.append((name, (), str(error)))
        with self._lock:
            # Once we are closed the reactor may be, too.
            if not self._closed:
                self._reactor.call_soon(lambda: self._answered(answers))

    def _answered(self, answers: list[tuple[str, tuple[str, ...], str]]) -> None:
        if self._closed:
            return
        for name, addresses, reason in answers:
            if addresses:
                self._left.remove(name)
                self._found(name, addresses)
            elif name not in self._told:
                self._told.add(name)
                self._failed(name, reason)
        if self._left:
            self._timer = self._reactor.call_at(self._reactor.now() + AGAIN, self._start)

    def close(self) -> None:
        """No more calls. A name that is being asked for ends in its thread, unheard."""
        with self._lock:
            self._closed = True
        if self._timer is not None:
            self._timer.cancel()

    def abandon(self) -> None:
        """In a forked child, which has no such thread; its lock may be held for ever."""
        self._closed = True
