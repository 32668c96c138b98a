"""The loop inside an asyncio loop: asyncio watches our poller's descriptor and gives us a turn when it is ready."""

from __future__ import annotations

import threading
import weakref

from roslet.errors import Unsupported

TYPE_CHECKING = False
if TYPE_CHECKING:
    import asyncio

    from roslet.io.select import Reactor

# Seconds to wait for another thread that has the loop at the moment.
TURN = 0.1

_attached: weakref.WeakKeyDictionary[asyncio.AbstractEventLoop, _Bridge] = weakref.WeakKeyDictionary()


class _Bridge:
    def __init__(self, reactor: Reactor, loop: asyncio.AbstractEventLoop) -> None:
        self._reactor = reactor
        # The dictionary's key must not be kept alive by its value.
        self._loop = weakref.ref(loop)
        self._handle: asyncio.TimerHandle | None = None
        self._thread = threading.get_ident()
        loop.add_reader(reactor.fileno(), self._turn)
        loop.call_soon(self._turn)
        with reactor.lock:
            reactor.watchers.append(self._spun)

    def _spun(self) -> bool:
        """Another thread has served users and stopped: it may have read what was to tell us of a timer. False when the loop
        is no more."""
        loop = self._loop()
        if loop is None or loop.is_closed():
            return False
        if threading.get_ident() != self._thread:
            try:
                loop.call_soon_threadsafe(self._turn)
            except RuntimeError:  # closed since
                return False
        return True

    def _turn(self) -> None:
        reactor, loop = self._reactor, self._loop()
        if reactor.in_loop or loop is None:
            return
        try:
            turned: list[bool] = []
            reactor.call_soon(lambda: turned.append(True), user=True)
            reactor.run_until(lambda: turned, TURN)
        except Exception as error:
            loop.call_exception_handler({"message": "a roslet callback raised", "exception": error})
        when = reactor.user_deadline()
        if self._handle is not None:
            self._handle.cancel()
            self._handle = None
        if when is not None:
            self._handle = loop.call_later(max(0.0, when - reactor.now()), self._turn)


def attach(reactor: Reactor, loop: asyncio.AbstractEventLoop) -> None:
    """Serve callbacks from `loop` as long as it runs. Raises Unsupported where the system's poller has no descriptor."""
    if loop in _attached:
        return
    if reactor.fileno() < 0:
        raise Unsupported("asyncio needs epoll, which this system does not have; use spin() in a thread")
    _attached[loop] = _Bridge(reactor, loop)
