"""`rclpy.guard_condition`: a callback that the program itself asks for."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy._entity import Entity

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.compat.rclpy.callback_groups import CallbackGroup
    from roslet.compat.rclpy.context import Context


class GuardCondition(Entity):
    """`trigger()` has the executor call `callback()` once, however often it is triggered before that."""

    def __init__(
        self,
        callback: Callable[[], Any] | None,
        callback_group: CallbackGroup | None,
        context: Context | None = None,
    ) -> None:
        super().__init__(callback_group)
        self.callback = callback
        self._lock = threading.Lock()
        self._triggered = False

    def trigger(self) -> None:
        """Ask for a call, from any thread."""
        self._check()
        self._triggered = True
        self._notify()

    def _ready(self) -> bool:
        return self._triggered and not self._destroyed

    def _take(self) -> Any:
        with self._lock:
            if not self._triggered:
                return self._nothing
            self._triggered = False
            return None

    def _run(self, work: Any) -> Any:
        return None if self.callback is None else self.callback()


__all__ = ["GuardCondition"]
