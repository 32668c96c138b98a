"""What an executor waits for: the base of timers, subscriptions, services, clients, guard conditions and waitables.

something arrives -> the entity is `_ready()` -> it notifies the executor of its node
the executor -> `_take()` a piece of work -> `_run(work)`, which may give a coroutine
"""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy.exceptions import InvalidHandle
from roslet.io.select import reactor

if TYPE_CHECKING:
    from types import TracebackType

    from roslet.compat.rclpy.callback_groups import CallbackGroup


class Bell:
    """Wakes a thread that waits. No lock is taken: signal handlers wake too."""

    def __init__(self) -> None:
        self._reactor = reactor()
        self._rung = False

    def ring(self) -> None:
        """The next `wait`, or that of now, returns."""
        if not self._rung:
            self._rung = True
            self._reactor.wake()

    def alarm(self) -> None:
        """The same from a signal handler, which interrupts the very thread that waits."""
        self._rung = True
        self._reactor.interrupt()

    def wait(self, seconds: float | None) -> None:
        """Run the loop until the bell is rung, or `seconds` have passed; at once where it was rung since the last wait.

        So what arrives is taken from its socket in the thread that will run its callback.
        """
        self._reactor.run_until(lambda: self._rung, seconds, user=False)
        self._rung = False


class Entity:
    """Something with a callback that an executor runs. `_nothing` is what `_take` gives where there is no work after all."""

    _nothing = object()
    # Whether it gets ready by itself, as timers do: executors look at it in every turn. The others notify.
    _polled = False

    def __init__(self, callback_group: CallbackGroup | None) -> None:
        self.callback_group = callback_group
        self._destroyed = False
        self._home: weakref.ref[Any] | None = None
        if callback_group is not None:
            callback_group.add_entity(self)

    def _belongs_to(self, node: Any) -> None:
        self._home = weakref.ref(node)

    def _notify(self) -> None:
        """Have the executor of the node look at this entity. From any thread."""
        node = None if self._home is None else self._home()
        if node is not None:
            node._node_active.add(self)
            executor = node.executor
            if executor is not None:
                executor.wake()

    def _check(self) -> None:
        """Raises InvalidHandle where it was destroyed."""
        if self._destroyed:
            raise InvalidHandle()

    def _ready(self) -> bool:
        """Whether there is work."""
        raise NotImplementedError

    def _take(self) -> Any:
        """A piece of work, `_nothing` where there is none after all."""
        raise NotImplementedError

    def _run(self, work: Any) -> Any:
        """Do a piece of work; a coroutine where there is more to be done later."""
        raise NotImplementedError

    def _seconds(self) -> float | None:
        """How long until it is ready by itself; None where it is made ready by others."""
        return None

    def destroy(self) -> None:
        """No further calls. Twice is allowed."""
        self._destroyed = True

    def __enter__(self) -> Any:
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.destroy()
