"""`rclpy.utilities`: the default context, arguments, times to wait."""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING

from roslet.compat.rclpy._arguments import Arguments
from roslet.compat.rclpy.constants import S_TO_NS
from roslet.compat.rclpy.context import Context

if TYPE_CHECKING:
    from collections.abc import Sequence

# What `get_rmw_implementation_identifier` says: there is no rmw here.
RMW = "roslet"

_lock = threading.Lock()
_default: Context | None = None


def get_default_context(*, shutting_down: bool = False) -> Context:
    """The context of those who name none; with `shutting_down` the next one to ask gets a new one."""
    global _default
    with _lock:
        found = Context() if _default is None else _default
        _default = None if shutting_down else found
        return found


def remove_ros_args(args: Sequence[str] | None = None) -> list[str]:
    """The arguments, sys.argv where none are given, that are the program's own. Raises UnknownROSArgsError, RCLError."""
    return Arguments(sys.argv if args is None else args).rest


def ok(*, context: Context | None = None) -> bool:
    """Whether the context, the default one where none is given, has begun and not ended."""
    return (get_default_context() if context is None else context).ok()


def shutdown(*, context: Context | None = None) -> None:
    """End the context, the default one where none is given. Raises RuntimeError where it has not begun."""
    (get_default_context(shutting_down=True) if context is None else context).shutdown()


def try_shutdown(*, context: Context | None = None) -> None:
    """End the context, the default one where none is given, where it runs."""
    if context is not None:
        context.try_shutdown()
        return
    found = get_default_context()
    found.try_shutdown()
    if found.begun:
        get_default_context(shutting_down=True)


def get_rmw_implementation_identifier() -> str:
    """What stands in for the middleware."""
    return RMW


def get_available_rmw_implementations() -> set[str]:
    """There is one."""
    return {RMW}


def timeout_sec_to_nsec(timeout_sec: float | None) -> int:
    """Seconds as nanoseconds; -1 for None and for less than 0, which mean for ever."""
    return -1 if timeout_sec is None or timeout_sec < 0 else int(float(timeout_sec) * S_TO_NS)


__all__ = [
    "get_available_rmw_implementations",
    "get_default_context",
    "get_rmw_implementation_identifier",
    "ok",
    "remove_ros_args",
    "shutdown",
    "timeout_sec_to_nsec",
    "try_shutdown",
]
