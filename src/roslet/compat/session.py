"""The one node that a rospy program has: made by `init_node`, used by everything else in `compat`.

rospy programs may name topics, services and parameters before there is a node; what was made then waits in `pending`.
"""

from __future__ import annotations

import os
import sys
import threading
import traceback
from typing import TYPE_CHECKING, Any

from roslet.names import Arguments, join, resolve

if TYPE_CHECKING:
    from collections.abc import Callable

    from roslet.node import Node

# Seconds that shutting down waits for a callback that is running. rospy gives its threads 5; a program that is told to
# end should be gone at once, and a callback that blocks is not worth more.
JOIN_TIMEOUT = 0.2


class Session:
    """A program's node and what belongs to it. There is one a process: `session`."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.node: Node | None = None
        self.init_arguments: tuple[object, ...] | None = None
        self.shutting_down = threading.Event()
        self.time_known = False
        self.wall_time = True
        self.pending: list[Callable[[Node], None]] = []
        self.threads: list[threading.Thread] = []
        self._preshutdown: list[Callable[[str], object]] = []
        self._client_hooks: list[Callable[[], object]] = []
        self._hooks: list[Callable[[str], object]] = []
        self._ended = threading.Event()
        self._ending: int = 0
        self.load_arguments(sys.argv)

    def load_arguments(self, arguments: list[str] | tuple[str, ...]) -> None:
        """Take the remappings of a command line; before there is a node the name is `unnamed`."""
        self.arguments = Arguments(list(arguments[1:]))
        namespace = self.arguments.specials.get("ns") or os.environ.get("ROS_NAMESPACE", "")
        self.namespace = join("/", join(namespace.strip("/"), "")) if namespace.strip("/") else "/"
        self._provisional = join(self.namespace, "unnamed")

    @property
    def initialized(self) -> bool:
        return self.node is not None

    @property
    def name(self) -> str:
        """The node's full name."""
        return self._provisional if self.node is None else self.node.name

    def resolve(self, name: str) -> str:
        """The full name with remappings applied. Raises InvalidName."""
        if self.node is not None:
            return self.node.resolve(name)
        return resolve(name, self._provisional, self.arguments.resolved(self._provisional))

    def when_initialized(self, attach: Callable[[Node], None]) -> None:
        """Call `attach(node)` now, or as soon as there is a node."""
        with self.lock:
            if self.node is None:
                self.pending.append(attach)
                return
            node = self.node
        attach(node)

    def begin(self, node: Node) -> None:
        """There is a node: attach what waits for it."""
        with self.lock:
            self.node = node
            waiting, self.pending = self.pending, []
        for attach in waiting:
            attach(node)

    # -- the end

    def on_preshutdown(self, function: Callable[[str], object]) -> None:
        """Call `function(reason)` before the node's connections are closed, before all other functions."""
        self._preshutdown.append(function)

    def on_shutdown(self, function: Callable[[str], object]) -> None:
        """Call `function(reason)` when the node ends; at once where it has ended."""
        self._add(self._hooks, function, "shutdown")

    def on_client_shutdown(self, function: Callable[[], object]) -> None:
        """The same for the program's own functions, which take no argument and come first."""
        if self._ended.is_set() or self.shutting_down.is_set():
            function()
        else:
            self._client_hooks.append(function)

    def _add(self, hooks: list[Any], function: Any, reason: str) -> None:
        if self.shutting_down.is_set():
            function(reason)
        else:
            hooks.append(function)

    def shut_down(self, reason: str, close: bool = True) -> None:
        """End the node once: tell the program, then unregister. Whoever comes second, in another thread, waits until it
        is done; called from a shutdown function it returns at once."""
        with self.lock:
            first = not self.shutting_down.is_set()
            self.shutting_down.set()
            if first:
                self._ending = threading.get_ident()
        if not first:
            if self._ending != threading.get_ident():
                self._ended.wait(5.0)
            return
        try:
            for told in self._preshutdown:
                self._run(told, reason)
            for hook in self._client_hooks:
                self._run(hook)
            for told in self._hooks:
                self._run(told, reason)
            if close and self.node is not None:
                self.node.close()
            for thread in self.threads:
                if thread is not threading.current_thread() and thread.is_alive():
                    thread.join(JOIN_TIMEOUT)
        finally:
            self._ended.set()
            self._ending = 0

    def _run(self, function: Callable[..., object], *arguments: str) -> None:
        try:
            function(*arguments)
        except Exception:
            # A shutdown function must not keep the others from running; rospy reports it likewise.
            sys.stderr.write("signal_shutdown hook error\n" + traceback.format_exc())


session = Session()
