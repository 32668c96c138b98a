"""The answer to a call that is under way."""

from __future__ import annotations

from roslet.errors import CallTimeout

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from typing import Any, Generic, TypeVar

    from roslet.io.select import Reactor

    T = TypeVar("T")
else:
    # Importing typing costs more than the rest of this room: at run time `Generic[T]` is just a base without anything.
    T = None

    class Generic:
        def __class_getitem__(cls, item: object) -> type:
            return cls


class Future(Generic[T]):
    """Holds a value or an error once there is one. `result()` waits and serves the loop meanwhile; `await` works in
    asyncio programs. `what` says in error messages what was waited for."""

    def __init__(self, reactor: Reactor, what: str) -> None:
        self._reactor = reactor
        self._what = what
        self._done = False
        self._value: T | None = None
        self._error: Exception | None = None
        self._callbacks: list[Callable[[Future[T]], object]] = []

    def done(self) -> bool:
        return self._done

    def result(self, timeout: float | None = None) -> T:
        """The value. Raises the call's error, or CallTimeout after `timeout` seconds (None: waits for ever)."""
        if not self._done and not self._reactor.run_until(self.done, timeout, user=False):
            raise CallTimeout(f"{self._what}: no answer within {timeout:g} s")
        if self._error is not None:
            raise self._error
        return self._value  # type: ignore[return-value]

    def exception(self) -> Exception | None:
        """The error of a call that is done and failed."""
        return self._error

    def add_done_callback(self, function: Callable[[Future[T]], object]) -> None:
        """Call `function(self)` when done, in whichever thread serves the loop; at once if done already."""
        self._callbacks.append(function)
        if self._done:
            self._call_back()

    def set_result(self, value: T) -> None:
        if not self._done:
            self._value = value
            self._finish()

    def set_exception(self, error: Exception) -> None:
        if not self._done:
            self._error = error
            self._finish()

    def _finish(self) -> None:
        self._done = True
        self._call_back()

    def _call_back(self) -> None:
        while self._callbacks:
            try:
                function = self._callbacks.pop(0)
            except IndexError:
                return  # another thread has just taken the last
            function(self)

    def __await__(self) -> Generator[Any, None, T]:
        import asyncio

        from roslet.io.asyncio import attach

        loop = asyncio.get_running_loop()
        attach(self._reactor, loop)
        waiter: asyncio.Future[None] = loop.create_future()

        def wake() -> None:
            if not waiter.done():
                waiter.set_result(None)

        self.add_done_callback(lambda _: loop.call_soon_threadsafe(wake))
        yield from waiter
        return self.result(0)
