"""`rclpy.task`: results that are not there yet, and functions and coroutines that an executor runs.

    pending --set_result, set_exception--> finished
       |-----cancel----------------------> cancelled

A coroutine that awaits a future is resumed when the future is done: the future wakes the executor of the task. One that
yields anything else is resumed in the next turn.
"""

from __future__ import annotations

import inspect
import sys
import threading
import warnings
import weakref
from enum import Enum
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Mapping, Sequence

    from roslet.compat.rclpy.executors import Executor

T = TypeVar("T")


class FutureState(Enum):
    """Where a future stands."""

    PENDING = "PENDING"
    CANCELLED = "CANCELLED"
    FINISHED = "FINISHED"


class Future(Generic[T]):
    """A result that comes later. Where it belongs to an executor, that runs the callbacks; else who sets the result."""

    def __init__(self, *, executor: Executor | None = None) -> None:
        self._lock = threading.Lock()
        self._state = FutureState.PENDING
        self._result: T | None = None
        self._exception: Exception | None = None
        self._told = True  # whether anybody asked for the exception
        self._callbacks: list[Callable[[Future[T]], Any]] = []
        self._wakers: list[Callable[[], None]] = []
        self._home: weakref.ref[Executor] | None = None
        self._set_executor(executor)

    def __del__(self) -> None:
        if not self._told:
            print(f"The following exception was never retrieved: {self._exception}", file=sys.stderr)

    def __await__(self) -> Generator[Any, None, T | None]:
        while self._state is FutureState.PENDING:
            yield self
        return self.result()

    def _set_executor(self, executor: Executor | None) -> None:
        self._home = None if executor is None else weakref.ref(executor)

    def _executor(self) -> Executor | None:
        return None if self._home is None else self._home()

    def _pending(self) -> bool:
        return self._state is FutureState.PENDING

    def cancel(self) -> None:
        """Give it up, where it is pending. A cancelled future is not done."""
        self._end(FutureState.CANCELLED)

    def cancelled(self) -> bool:
        """Whether it was cancelled."""
        return self._state is FutureState.CANCELLED

    def done(self) -> bool:
        """Whether there is a result or an exception."""
        return self._state is FutureState.FINISHED

    def result(self) -> T | None:
        """The result, None where there is none yet; raises the exception where there is one."""
        error = self.exception()
        if error is not None:
            raise error
        return self._result

    def exception(self) -> Exception | None:
        """The exception, or None."""
        self._told = True
        return self._exception

    def set_result(self, result: T) -> None:
        """It is done, and this is its result."""
        self._result = result
        self._end(FutureState.FINISHED, again=True)

    def set_exception(self, exception: Exception) -> None:
        """It is done, and has failed."""
        self._exception = exception
        self._told = False
        self._end(FutureState.FINISHED, again=True)

    def add_done_callback(self, callback: Callable[[Future[T]], Any]) -> None:
        """Call `callback(self)` when it is done or cancelled; at once where it is already, and then what the callback
        raises comes out here."""
        with self._lock:
            if self._state is FutureState.PENDING:
                self._callbacks.append(callback)
                return
        executor = self._executor()
        if executor is None:
            callback(self)
        else:
            executor.create_task(callback, self)

    def remove_done_callback(self, callback: Callable[[Future[T]], Any]) -> bool:
        """Take a callback back; False where it is not there (any more)."""
        with self._lock:
            if callback not in self._callbacks:
                return False
            self._callbacks.remove(callback)
            return True

    def _wake_when_done(self, waker: Callable[[], None]) -> None:
        """Call `waker()` when it is done or cancelled, in whichever thread does that; at once where it is already."""
        with self._lock:
            if self._state is FutureState.PENDING:
                self._wakers.append(waker)
                return
        waker()

    def _end(self, state: FutureState, again: bool = False) -> None:
        with self._lock:
            if self._state is not FutureState.PENDING and not again:
                return
            self._state = state
            callbacks, self._callbacks = self._callbacks, []
            wakers, self._wakers = self._wakers, []
        executor = self._executor()
        for callback in callbacks:
            if executor is not None:
                executor.create_task(callback, self)
                continue
            try:
                callback(self)
            except Exception as error:
                warnings.warn(f"Unhandled exception in done callback: {error}", stacklevel=3)
        for waker in wakers:
            waker()


class Task(Future[T]):
    """A function or coroutine that runs when the task is called. Executors make these; a coroutine takes several calls."""

    def __init__(
        self,
        handler: Callable[..., Any],
        args: Sequence[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        executor: Executor | None = None,
    ) -> None:
        super().__init__(executor=executor)
        args = () if args is None else tuple(args)
        kwargs = {} if kwargs is None else kwargs
        self._handler: Callable[[], Any] | None = None
        self._coroutine: Any = None
        self._awaited: Future[Any] | None = None
        if inspect.iscoroutinefunction(handler):
            self._coroutine = handler(*args, **kwargs)
        else:
            self._handler = lambda: handler(*args, **kwargs)
        self._running = threading.Lock()

    def __call__(self) -> None:
        """Run the function, or the coroutine to where it waits. Nothing where the task is done or runs already."""
        if not self._pending() or not self._running.acquire(blocking=False):
            return
        try:
            if self._pending():
                self._step()
        finally:
            self._running.release()

    def _step(self) -> None:
        try:
            if self._coroutine is None:
                assert self._handler is not None
                result = self._handler()
            else:
                waits_for = self._coroutine.send(None)
                self._awaited = waits_for if isinstance(waits_for, Future) else None
                return
        except StopIteration as end:
            self._drop()
            self.set_result(end.value)
        except Exception as error:
            self._drop()
            self.set_exception(error)
        else:
            self._drop()
            self.set_result(result)

    def _drop(self) -> None:
        self._handler = self._coroutine = self._awaited = None

    def ready(self) -> bool:
        """Whether a call would get on: it is pending, does not run, and what it awaits is there."""
        if not self._pending() or self._running.locked():
            return False
        return self._awaited is None or not self._awaited._pending()

    def executing(self) -> bool:
        """Whether it runs at this moment."""
        return self._running.locked()

    def cancel(self) -> None:
        """Give it up; a coroutine is closed."""
        coroutine = self._coroutine
        if self._pending() and coroutine is not None and not self._running.locked():
            coroutine.close()
        super().cancel()


__all__ = ["Future", "FutureState", "Task"]
