"""Ctrl-C at a good moment.

Python runs signal handlers between any two instructions of the main thread, also where the loop has taken an answer from a
socket and not yet given it to the engine. An exception there would leave the engine waiting for what has come already,
and the node could not even say goodbye. So a signal that comes at such a moment is sent once more a moment later.
A program's own handlers, and asyncio's, stay what they are: only Python's default one is replaced.
"""

from __future__ import annotations

import signal
import threading
import time
from _thread import start_new_thread

TYPE_CHECKING = False
if TYPE_CHECKING:
    from types import FrameType
    from typing import Any

# Seconds until a signal that came at a bad moment is sent again. Most of what the loop does takes less.
AGAIN = 0.001
# A signal is put off so many times at most: should the loop hang, Ctrl-C must still end it.
MOST = 200

# Where an interruption in between would lose what was taken and not yet handed on, though the loop's lock is not held. Not
# `_wait`, where the loop sleeps: nothing is under way there.
_CAREFUL = ("roslet.io.select", "roslet.io.streams", "roslet.engine.", "roslet.wire.")
_SLEEP = "_wait"

_lock: Any = None
_put_off = 0


def watch(lock: Any) -> None:
    """Where SIGINT has Python's default handler, let Ctrl-C wait while the main thread holds `lock`, an RLock.

    Without effect in other threads, which may not set handlers.
    """
    global _lock
    _lock = lock
    if (
        threading.current_thread() is threading.main_thread()
        and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    ):
        signal.signal(signal.SIGINT, on_sigint)


def held() -> Any:
    """For `with`, while a node is open: Ctrl-C waits for the end of the block, where what it asked of a peer is known.

    The block must be short, and may not wait for another thread.
    """
    return _lock


def on_sigint(number: int, frame: FrameType | None) -> None:
    """KeyboardInterrupt, now or in a moment."""
    if not put_off(number, frame):
        raise KeyboardInterrupt


def put_off(number: int, frame: FrameType | None) -> bool:
    """For handlers that raise, or use a node: true where the moment is bad. Then return; the signal comes again."""
    global _put_off
    if _put_off < MOST and _is_bad(frame):
        try:
            start_new_thread(_send_again, (number,))
        except RuntimeError:  # no thread to be had
            return False
        _put_off += 1
        return True
    _put_off = 0
    return False


def _is_bad(frame: FrameType | None) -> bool:
    # Only the thread that handlers run in, the main one, asks: what it owns cannot change meanwhile.
    if _lock is not None and _lock._is_owned():
        return True
    if frame is None or frame.f_code.co_name == _SLEEP:
        return False
    return str(frame.f_globals.get("__name__", "")).startswith(_CAREFUL)


def _send_again(number: int) -> None:
    time.sleep(AGAIN)
    main = threading.main_thread().ident
    if main is not None:
        signal.pthread_kill(main, number)
