"""`rclpy.signals`: what SIGINT and SIGTERM do while a context runs.

SIGINT ends every context and raises KeyboardInterrupt out of what the program does; SIGTERM ends every context, and spinning
then raises ExternalShutdownException.
"""

from __future__ import annotations

import signal
import threading
from enum import IntFlag
from typing import TYPE_CHECKING, Any

from roslet.io import interrupts

if TYPE_CHECKING:
    from types import FrameType


class SignalHandlerOptions(IntFlag):
    """Which signals are handled."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


_SIGNALS = {SignalHandlerOptions.SIGINT: signal.SIGINT, SignalHandlerOptions.SIGTERM: signal.SIGTERM}
_before: dict[int, Any] = {}


def _handle(number: int, frame: FrameType | None) -> None:
    from roslet.compat.rclpy.context import end_all

    end_all()
    before = _before.get(number)
    if number == signal.SIGINT and callable(before):
        # Not where the loop would lose what it has just taken from a socket.
        (interrupts.on_sigint if before is signal.default_int_handler else before)(number, frame)


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Handle these signals from now on, and no others. Only the main thread can; in another one nothing is done."""
    if threading.current_thread() is not threading.main_thread():
        return
    for option, number in _SIGNALS.items():
        if option in options and number not in _before:
            _before[number] = signal.signal(number, _handle)
        elif option not in options and number in _before:
            signal.signal(number, _before.pop(number))


def uninstall_signal_handlers() -> None:
    """The program's own handlers again."""
    install_signal_handlers(SignalHandlerOptions.NO)


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """Which signals are handled."""
    found = SignalHandlerOptions.NO
    for option, number in _SIGNALS.items():
        if number in _before:
            found |= option
    return found


__all__ = [
    "SignalHandlerOptions",
    "get_current_signal_handlers_options",
    "install_signal_handlers",
    "uninstall_signal_handlers",
]
