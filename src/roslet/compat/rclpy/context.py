"""`rclpy.context`: what lies between init and shutdown."""

from __future__ import annotations

import sys
import threading
import warnings
import weakref
from inspect import ismethod
from typing import TYPE_CHECKING, Any

from roslet.compat.rclpy._arguments import Arguments
from roslet.compat.rclpy.exceptions import RCLError
from roslet.io.select import reactor
from roslet.names import MAX_DOMAIN

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from types import TracebackType

    from roslet.compat.rclpy._entity import Bell

# Seconds that a thread whose spinning ends leaves to the callbacks of the end.
CALLBACKS = 1.0

_running: weakref.WeakSet[Context] = weakref.WeakSet()


class Context:
    """Can be initialised once, and ended once. Nodes belong to it and end with it."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._callbacks: list[Callable[[], Callable[[], object] | None]] = []
        self._nodes: list[weakref.ref[Any]] = []
        self._begun = False
        self._ok = False
        self._ender = 0  # the thread that calls the callbacks
        self._called = threading.Event()  # cleared while they are called
        self._called.set()
        self._domain = 0
        self.arguments = Arguments([])

    def init(
        self,
        args: Sequence[str] | None = None,
        *,
        initialize_logging: bool = True,
        domain_id: int | None = None,
    ) -> None:
        """Begin. `args` are a program's words, sys.argv where it is None; domain None is $ROS_DOMAIN_ID, or 0.

        Raises RuntimeError where it has begun before or the domain cannot be, UnknownROSArgsError and RCLError for words
        after --ros-args that mean nothing or are wrong.
        """
        import os

        with self._lock:
            if domain_id is not None and domain_id < 0:
                raise RuntimeError(f"Domain id ({domain_id}) should not be lower than zero.")
            if self._begun:
                raise RuntimeError("Context.init() must only be called once")
            self.arguments = Arguments(sys.argv if args is None else args)
            if domain_id is None:
                given = os.environ.get("ROS_DOMAIN_ID", "")
                if given and not given.isdecimal():
                    raise RCLError(f"failed to initialize rcl: ROS_DOMAIN_ID is no number: {given!r}")
                domain_id = int(given or 0)
            if domain_id > MAX_DOMAIN:
                raise RCLError(f"failed to initialize rcl: there is no domain {domain_id}")
            self._domain = domain_id
            self._begun = self._ok = True
            _running.add(self)
        if initialize_logging:
            from roslet.compat.rclpy.impl import rcutils_logger

            rcutils_logger.configure(self.arguments)
            for word in self.arguments.bare:
                text = f"Found remap rule '{word}'. This syntax is deprecated. Use '--ros-args --remap {word}' instead."
                rcutils_logger.RcutilsLogger("rcl").warning(text)

    @property
    def begun(self) -> bool:
        """Whether it was initialised, ended or not."""
        return self._begun

    def ok(self) -> bool:
        """Whether it has begun and not ended."""
        return self._ok

    def get_domain_id(self) -> int:
        """The number of its domain. Raises RuntimeError before init."""
        if not self._begun:
            raise RuntimeError("Context must be initialized before it can have a domain id")
        return self._domain

    def track_node(self, node: Any) -> None:
        """The node ends with this context. Held weakly."""
        with self._lock:
            self._nodes.append(weakref.ref(node))

    def untrack_node(self, node: Any) -> None:
        """The node has ended."""
        with self._lock:
            self._nodes = [one for one in self._nodes if one() not in (None, node)]

    def on_shutdown(self, callback: Callable[[], object]) -> None:
        """Call `callback()` at the end; at once where that was. A bound method is held weakly."""
        if not callable(callback):
            raise TypeError("callback should be a callable, got {}", type(callback))
        with self._lock:
            if not self._begun or self._ok:
                self._callbacks.append(
                    weakref.WeakMethod(callback) if ismethod(callback) else lambda: callback
                )
                return
        callback()

    def _off_shutdown(self, callback: Callable[[], object]) -> None:
        with self._lock:
            self._callbacks = [one for one in self._callbacks if one() != callback]

    def shutdown(self) -> None:
        """End: nodes are destroyed, callbacks called, spinning stops. Raises RuntimeError before init."""
        if not self._begun:
            raise RuntimeError("Context must be initialized before it can be shutdown")
        self._shutdown()

    def try_shutdown(self) -> None:
        """End, where it runs."""
        if self._ok:
            self._shutdown()

    def _shutdown(self) -> None:
        with self._lock:
            callbacks, self._callbacks = self._callbacks, []
            tracked, self._nodes = self._nodes, []
            _running.discard(self)
            for number, one in enumerate(tracked):
                node = one()
                if node is not None:
                    # rclpy asks every second node itself: its list changes under its loop. Programs count the calls.
                    (node._node_end if number % 2 else node.destroy_node)()
            self._ender = threading.get_ident()
            self._called.clear()
            self._ok = False
        try:
            for get in callbacks:
                callback = get()
                if callback is not None:
                    callback()
        finally:
            self._called.set()

    def _wait_for_callbacks(self) -> None:
        """Let the callbacks of the end, which another thread calls, come before what follows it in this one. For a moment at
        most, since one of them may wait for this thread."""
        if self._ender != threading.get_ident():
            self._called.wait(CALLBACKS)

    def destroy(self) -> None:
        """Nothing more than `try_shutdown`: memory is Python's."""
        self.try_shutdown()

    def __enter__(self) -> Context:
        if not self._begun:
            warnings.warn(
                "init() must be called on a Context before using it in a Python context manager. "
                "Calling init() with no arguments, this usage is deprecated",
                stacklevel=2,
            )
            self.init()
        return self

    def __exit__(
        self,
        exc_type: type[BaseException] | None,
        exc_val: BaseException | None,
        exc_tb: TracebackType | None,
    ) -> None:
        self.try_shutdown()


def end_all() -> None:
    """What a signal does: no context runs any more. Nodes stay until somebody destroys them, and no callback is called."""
    for context in list(_running):
        context._ok = False
        _running.discard(context)
    for bell in list(bells):
        bell.alarm()
    reactor().interrupt()  # who waits for a service, or a peer


def close_all() -> None:
    """The program has ended: nodes disappear from the graph at once. No callback is called."""
    for context in list(_running):
        for one in list(context._nodes):
            node = one()
            if node is not None:
                node._node_end()
        context._ok = False


# Of the executors: rung when a signal has ended the contexts.
bells: weakref.WeakSet[Bell] = weakref.WeakSet()

__all__ = ["Context", "bells", "close_all", "end_all"]
