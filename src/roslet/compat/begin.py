"""How a rospy program's node begins: the node itself, its time, its signals, its two logger services."""

from __future__ import annotations

import atexit
import signal
import threading
import time
from typing import TYPE_CHECKING, Any

from roslet.compat import logs
from roslet.compat.rospy import rostime
from roslet.compat.session import session
from roslet.errors import CallTimeout, Fault, Unreachable
from roslet.io.interrupts import on_sigint, put_off
from roslet.node import Node
from roslet.node.log import DEBUG, ERROR, FATAL, INFO, WARN
from roslet.node.values import parse_value

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType

# Seconds between two tries while there is no master.
TRY_AGAIN = 0.2
# Seconds between two looks for a signal while the master is waited for.
LOOK = 0.05

_NAMES = {"debug": DEBUG, "info": INFO, "warn": WARN, "error": ERROR, "fatal": FATAL}
_before: dict[int, Any] = {}


class _Node(Node):
    """A node whose wait for the master is told of here, in rospy's words."""

    def _note(self, text: str) -> None:
        if session.initialized:
            super()._note(text)


def begin_node(
    name: str,
    arguments: list[str],
    anonymous: bool,
    log_level: int | None,
    disable_rostime: bool,
    disable_rosout: bool,
    disable_signals: bool,
) -> None:
    """Make the node of `session`; returns when the master knows it. Raises KeyboardInterrupt where a signal came first."""
    session.load_arguments(arguments)
    logs.set_level(log_level if log_level is not None else INFO)
    if not disable_signals:
        _take_signals()
    # Private parameters are set when there is a master; the node itself would not wait for one.
    parameters = session.arguments.parameters
    others = [one for one in arguments[1:] if one.partition(":=")[0][1:] not in parameters or one[:1] != "_"]
    node = _Node(name, network="ros1://", arguments=others, anonymous=anonymous)
    log = logs.RospyLog(node)
    log.level = DEBUG  # what is logged at all is decided in `logs`
    log._publisher = None if disable_rosout else node.log._publisher
    node.log = log
    _wait_for_master(node)
    for key, value in parameters.items():
        node.set_parameter("~" + key, parse_value(value))
    _set_time(node, disable_rostime)
    node.on_shutdown(_node_closes)
    node.start()
    session.begin(node)
    session.time_known = True
    _offer_logger_services()
    atexit.register(session.shut_down, "atexit")


def _wait_for_master(node: Node) -> None:
    told = False
    while True:
        try:
            node.call_master("getPid")
            return
        except (Unreachable, CallTimeout, Fault):
            if not told:
                told = True
                where = f"Unable to immediately register with master node [{node.master_uri}]"
                logs.emit(ERROR, f"{where}: master may not be running yet. Will keep trying.", None, "rosout")
        end = time.monotonic() + TRY_AGAIN
        while time.monotonic() < end:
            if session.shutting_down.wait(LOOK):
                node.close()
                raise KeyboardInterrupt


def _set_time(node: Node, disable_rostime: bool) -> None:
    """The node has asked for /use_sim_time; ask again behind that, so that the answer is known."""
    if not disable_rostime:
        try:
            simulated = node.get_parameter("/use_sim_time", False)
        except (Unreachable, CallTimeout):
            simulated = False
        if simulated:
            session.wall_time = False
            _watch_clock(node)


def _watch_clock(node: Node) -> None:
    """Wake those who sleep by simulated time whenever it moves."""
    condition = rostime.get_rostime_cond()
    advance = node.clock.advance

    def advance_and_tell(secs: int, nsecs: int) -> None:
        advance(secs, nsecs)
        with condition:
            condition.notify_all()

    node.clock.advance = advance_and_tell  # type: ignore[method-assign]


def _node_closes() -> None:
    """The node ends for a reason of its own: the master has said so, or `rosnode kill`."""
    session.shut_down("external shutdown", close=False)


def _take_signals() -> None:
    if threading.current_thread() is not threading.main_thread():
        raise ValueError("signal only works in main thread of the main interpreter")
    for number in (signal.SIGTERM, signal.SIGINT):
        _before[number] = signal.signal(number, _on_signal)


def _on_signal(number: int, frame: FrameType | None) -> None:
    if put_off(number, frame):
        return  # the end of the node uses the loop, which is in the midst of something
    session.shut_down(f"signal-{number}")
    before: Callable[..., Any] | int | None = _before.get(number)
    if callable(before) and before not in (signal.default_int_handler, on_sigint, _on_signal):
        before(number, frame)


def _offer_logger_services() -> None:
    """`~get_loggers` and `~set_logger_level`, as every rospy node has them."""
    from roslet.compat.rospy.impl.tcpros_service import Service
    from roslet.gen.runtime import service_class

    get_loggers: Any = service_class("ros1", "roscpp/GetLoggers")
    set_level: Any = service_class("ros1", "roscpp/SetLoggerLevel")
    texts = {level: text for text, level in _NAMES.items()}

    def answer_loggers(_request: Any) -> Any:
        from roslet.gen.runtime import message_class

        logger: Any = message_class("ros1", "roscpp/Logger")
        found = [logger(name, texts[level]) for name, level in sorted(logs.levels().items())]
        return get_loggers.Response(loggers=found)

    def answer_level(request: Any) -> Any:
        level = _NAMES.get(request.level.lower())
        if level is None:
            logs.emit(ERROR, f"log level [{request.level}] is none of {', '.join(_NAMES)}", None, "rosout")
        else:
            logs.set_level(level, request.logger)
        return set_level.Response()

    Service("~get_loggers", get_loggers, answer_loggers)
    Service("~set_logger_level", set_level, answer_level)


__all__ = ["begin_node"]
