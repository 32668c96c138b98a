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

# Seconds for which the end of a program waits for functions of its own that run at its end in another thread.
END_TIMEOUT = 5.0


class Session:
    """A program's node and what belongs to it. There is one a process: `session`."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.node: Node | None = None
        self.init_arguments: tuple[object, ...] | None = None
        self.requested = False  # somebody has asked for the end; `shutting_down` is when others are told
        self.shutting_down = threading.Event()
        self.time_known = False
        self.wall_time = True
        self.pending: list[Callable[[Node], None]] = []
        self._preshutdown: list[Callable[[str], object]] = []
        self._client_hooks: list[Callable[[], object]] = []
        self._hooks: list[Callable[[str], object]] = []
        self._ended = threading.Event()
        self._ending = 0  # the thread that ends the node
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
        if self.shutting_down.is_set():
            function()
        else:
            self._client_hooks.append(function)

    def _add(self, hooks: list[Any], function: Any, reason: str) -> None:
        if self.shutting_down.is_set():
            function(reason)
        else:
            hooks.append(function)

    def shut_down(self, reason: str, close: bool = True) -> None:
        """End the node once: the program's functions while everything still works, then the end for all who wait, then
        the other functions, then unregister. Who comes second, in another thread, waits until it is done."""
        with self.lock:
            first = not self.requested
            self.requested = True
            if first:
                self._ending = threading.get_ident()
        if not first:
            self.wait_for_end()
            return
        try:
            for hook in self._client_hooks:
                self._run(hook)
            self.shutting_down.set()
            for told in [*self._preshutdown, *self._hooks]:
                self._run(told, reason)
            if close and self.node is not None:
                self.node.close()
        finally:
            self.shutting_down.set()
            self._ended.set()

    def wait_for_end(self) -> None:
        """Return when the node has ended, after `END_TIMEOUT` in any case; at once in the thread that ends it."""
        if self._ending != threading.get_ident():
            self._ended.wait(END_TIMEOUT)

    def _run(self, function: Callable[..., object], *arguments: str) -> None:
        try:
            function(*arguments)
        except Exception:
            # A shutdown function must not keep the others from running; rospy reports it likewise.
            sys.stderr.write("signal_shutdown hook error\n" + traceback.format_exc())


session = Session()
