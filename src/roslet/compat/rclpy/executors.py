"""`rclpy.executors`: who runs the callbacks.

A turn (`spin_once`) runs one piece of work: a task, or the callback of an entity that is ready. What is ready when a pass
begins is run, each once, before anything is looked at again, so that nothing starves:

    look -> nothing: wait for the bell or the nearest timer -> look again
         -> some: take work from the first, run it; the rest is for the next turns
"""

from __future__ import annotations

import inspect
import os
import threading
import time
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy._entity import Bell, Entity
from roslet.compat.rclpy.context import bells
from roslet.compat.rclpy.exceptions import NotInitializedException
from roslet.compat.rclpy.task import Future, Task

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import TracebackType

    from typing_extensions import Self

    from roslet.compat.rclpy.context import Context


class TimeoutException(Exception):
    """There was nothing to do in the time given."""


class ShutdownException(Exception):
    """The executor was shut down."""


class ExternalShutdownException(Exception):
    """The context ended while the executor was spinning."""

    def __init__(self, *args: object) -> None:
        super().__init__(*args)


class ConditionReachedException(Exception):
    """What was waited for has come."""


class _Work:
    """What is being done and not counted as ended: `shutdown` waits for it."""

    def __init__(self) -> None:
        self._condition = threading.Condition()
        self._count = 0

    def __enter__(self) -> None:
        with self._condition:
            self._count += 1

    def __exit__(self, *_: object) -> None:
        with self._condition:
            self._count -= 1
            self._condition.notify_all()

    def wait(self, seconds: float | None) -> bool:
        with self._condition:
            return self._condition.wait_for(lambda: not self._count, seconds)


async def await_or_execute(callback: Callable[..., Any], *args: Any) -> Any:
    """What the callback returns, or what its coroutine does."""
    result = callback(*args)
    return await result if inspect.iscoroutine(result) else result


class Executor:
    """The base. Use SingleThreadedExecutor or MultiThreadedExecutor; as a context manager it is shut down at the end."""

    # Whether callbacks run in others than the thread that spins.
    _threads = False

    def __init__(self, *, context: Context | None = None) -> None:
        from roslet.compat.rclpy.utilities import get_default_context

        self._context = get_default_context() if context is None else context
        if not self._context.begun:
            raise RuntimeError("Context must be initialized a GuardCondition can be created")
        self._lock = threading.RLock()
        self._nodes: list[Any] = []
        self._tasks: deque[tuple[Task[Any], Entity | None]] = deque()
        self._pass: deque[Any] = deque()
        self._failures: deque[Exception] = deque()
        self._is_shutdown = False
        self._working = _Work()
        self._bell = Bell()
        bells.add(self._bell)
        self._context.on_shutdown(self.wake)

    @property
    def context(self) -> Context:
        """The context whose end ends the spinning."""
        return self._context

    # -- nodes

    def add_node(self, node: Any) -> bool:
        """Run this node's callbacks; False where it does already. The node leaves its executor of before."""
        with self._lock:
            if node in self._nodes:
                return False
            self._nodes.append(node)
        node.executor = self
        self.wake()
        return True

    def remove_node(self, node: Any) -> None:
        """Run this node's callbacks no more."""
        with self._lock:
            if node in self._nodes:
                self._nodes.remove(node)
        self.wake()

    def get_nodes(self) -> list[Any]:
        """The nodes."""
        with self._lock:
            return list(self._nodes)

    # -- tasks

    def create_task(self, callback: Callable[..., Any], *args: Any, **kwargs: Any) -> Task[Any]:
        """Have a function or coroutine run in a later turn."""
        task: Task[Any] = Task(callback, args, kwargs, executor=self)
        self._tasks.append((task, None))
        self.wake()
        return task

    def create_future(self) -> Future[Any]:
        """A future whose callbacks this executor runs."""
        return Future(executor=self)

    def wake(self) -> None:
        """Have whoever waits look again. From any thread."""
        self._bell.ring()

    # -- spinning

    def spin(self) -> None:
        """Run callbacks until the executor is shut down; raises ExternalShutdownException where the context ends."""
        while not self._is_shutdown:
            self.spin_once()

    def spin_once(self, timeout_sec: float | None = None) -> None:
        """Run one piece of work; wait for it for at most `timeout_sec` seconds, for ever where it is None or negative.

        What a callback raises comes out here.
        """
        self._spin_once(timeout_sec, None)

    def spin_until_future_complete(self, future: Future[Any], timeout_sec: float | None = None) -> None:
        """Run callbacks until the future is done or cancelled, or the time is over."""
        future._wake_when_done(self.wake)
        end = None if timeout_sec is None or timeout_sec < 0 else time.monotonic() + timeout_sec
        while self._context.ok() and not self._is_shutdown and future._pending():
            left = None if end is None else max(0.0, end - time.monotonic())
            self._spin_once(left, lambda: not future._pending())
            if left == 0.0:
                return

    def spin_once_until_future_complete(self, future: Future[Any], timeout_sec: float | None = None) -> None:
        """As `spin_once`; returns also where the future is done."""
        future._wake_when_done(self.wake)
        self._spin_once(timeout_sec, lambda: not future._pending())

    def _spin_once(self, timeout: float | None, reached: Callable[[], bool] | None) -> None:
        try:
            task, entity = self._next(timeout, reached)
        except (TimeoutException, ShutdownException, ConditionReachedException):
            return
        self._execute(task, entity)

    def _execute(self, task: Task[Any], entity: Entity | None) -> None:
        raise NotImplementedError("Subclasses must implement this method")

    def _do(self, task: Task[Any], entity: Entity | None) -> None:
        """Run a task to its end or to where it waits. Raises what it raised."""
        with self._working:
            task()
        if task._pending():
            if task._awaited is not None:
                task._awaited._wake_when_done(self.wake)
            self._tasks.append((task, entity))
            self.wake()
            return
        error = None if task.cancelled() else task.exception()
        if error is not None:
            raise error

    # -- what is next

    def _next(
        self, timeout: float | None, reached: Callable[[], bool] | None
    ) -> tuple[Task[Any], Entity | None]:
        end = None if timeout is None or timeout < 0 else time.monotonic() + timeout
        while True:
            if self._is_shutdown:
                raise ShutdownException
            if not self._context.ok():
                self._context._wait_for_callbacks()
                raise ExternalShutdownException
            if reached is not None and reached():
                raise ConditionReachedException
            if self._failures:
                raise self._failures.popleft()
            found = self._find()
            if found is not None:
                return found
            left = None if end is None else end - time.monotonic()
            if left is not None and left <= 0:
                raise TimeoutException
            self._sleep(_least(left, self._nearest()))

    def _sleep(self, seconds: float | None) -> None:
        """Wait for the bell, at most this long."""
        self._bell.wait(seconds)

    def _find(self) -> tuple[Task[Any], Entity | None] | None:
        with self._lock:
            while self._pass or self._look():
                while self._pass:
                    one = self._pass.popleft()
                    if isinstance(one, Entity):
                        found = self._begin(one)
                        if found is not None:
                            return found, one
                    elif one[0].ready():
                        return one  # type: ignore[no-any-return]
                    elif one[0]._pending():
                        self._tasks.append(one)
            return None

    def _look(self) -> bool:
        """Begin a pass with all that is ready; whether there is anything."""
        for _ in range(len(self._tasks)):
            one = self._tasks.popleft()
            if one[0].ready():
                self._pass.append(one)
            elif one[0]._pending():
                self._tasks.append(one)
        self._pass.extend(entity for entity in self._entities() if self._may_run(entity))
        return bool(self._pass)

    def _entities(self) -> Iterator[Entity]:
        for node in self._nodes:
            yield from node._node_entities()

    def _may_run(self, entity: Entity) -> bool:
        group = entity.callback_group
        return entity._ready() and (group is None or group.can_execute(entity))

    def can_execute(self, entity: Entity) -> bool:
        """Whether the entity's group lets its callback begin now."""
        return entity.callback_group is None or entity.callback_group.can_execute(entity)

    def _begin(self, entity: Entity) -> Task[Any] | None:
        group = entity.callback_group
        if not self._may_run(entity) or (group is not None and not group.beginning_execution(entity)):
            return None
        work = entity._take()
        if work is Entity._nothing:
            if group is not None:
                group.ending_execution(entity)
            return None

        async def run() -> None:
            try:
                await await_or_execute(entity._run, work)
            finally:
                if group is not None:
                    group.ending_execution(entity)
                    if self._threads:
                        self.wake()  # the thread that spins may wait for what this group held back

        return Task(run, executor=self)

    def _nearest(self) -> float | None:
        """Seconds to the nearest timer that may run."""
        with self._lock:
            nearest = None
            for node in self._nodes:
                for entity in node._node_polled:
                    if self.can_execute(entity):
                        nearest = _least(nearest, entity._seconds())
            return nearest

    # -- the end

    def shutdown(self, timeout_sec: float | None = None) -> bool:
        """Stop spinning, and wait for callbacks that run, for at most `timeout_sec` seconds. False where some still do."""
        self._is_shutdown = True
        self.wake()
        self._context._off_shutdown(self.wake)
        if not self._working.wait(timeout_sec):
            return False
        with self._lock:
            self._nodes.clear()
            self._pass.clear()
        return True

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.shutdown()


def _least(one: float | None, other: float | None) -> float | None:
    if one is None or other is None:
        return other if one is None else one
    return min(one, other)


class SingleThreadedExecutor(Executor):
    """Runs callbacks in the thread that spins."""

    def _execute(self, task: Task[Any], entity: Entity | None) -> None:
        self._do(task, entity)


class MultiThreadedExecutor(Executor):
    """Runs callbacks in `num_threads` threads; None: as many as this process has processors, at least two. Raises
    ValueError for less than one. What a callback raises comes out of a later turn."""

    _threads = True

    def __init__(self, num_threads: int | None = None, *, context: Context | None = None) -> None:
        super().__init__(context=context)
        if num_threads is None:
            num_threads = max(2, len(os.sched_getaffinity(0)))
        self._executor = ThreadPoolExecutor(num_threads)

    def _execute(self, task: Task[Any], entity: Entity | None) -> None:
        def run() -> None:
            try:
                self._do(task, entity)
            except Exception as error:
                self._failures.append(error)
                self.wake()

        self._executor.submit(run)

    def shutdown(self, timeout_sec: float | None = None, *, wait_for_threads: bool = True) -> bool:
        """As for every executor; with `wait_for_threads` the threads have ended when it returns True."""
        ended = super().shutdown(timeout_sec)
        self._executor.shutdown(wait=wait_for_threads and ended)
        return ended


__all__ = [
    "ConditionReachedException",
    "Executor",
    "ExternalShutdownException",
    "MultiThreadedExecutor",
    "NotInitializedException",
    "ShutdownException",
    "SingleThreadedExecutor",
    "TimeoutException",
    "await_or_execute",
]
