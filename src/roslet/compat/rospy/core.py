"""`rospy.core`: logging, and the state of the program's node."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from roslet.compat import logs
from roslet.compat.rospy import rostime
from roslet.compat.rospy.exceptions import ROSException
from roslet.compat.rospy.names import (
    ANYTYPE,
    GLOBALNS,
    REMAP,
    SEP,
    SERVICE_ANYTYPE,
    TOPIC_ANYTYPE,
    canonicalize_name,
    get_caller_id,
    get_mappings,
    get_name,
    get_namespace,
    get_resolved_mappings,
    get_ros_namespace,
    global_name,
    is_global,
    is_private,
    make_global_ns,
    namespace,
    ns_join,
    remap_name,
    resolve_name,
    scoped_name,
    valid_name,
)
from roslet.compat.session import session
from roslet.errors import InvalidName
from roslet.names import parse_host_port
from roslet.node.log import DEBUG, ERROR, FATAL, INFO, WARN

if TYPE_CHECKING:
    from collections.abc import Callable

ROSRPC = "rosrpc://"


def _seconds(period: Any) -> float:
    return float(period.to_sec()) if hasattr(period, "to_sec") else float(period)


def _functions(level: int) -> tuple[Callable[..., None], ...]:
    """The four log functions of one level. Depths: the caller's line is two calls above `logs.log`."""

    def plain(msg: Any, *args: Any, logger_name: str | None = None, **_unused: Any) -> None:
        logs.log(level, msg, args, logger_name, 2)

    def throttled(period: Any, msg: Any, *args: Any, logger_name: str | None = None, **_unused: Any) -> None:
        if logs.after_period(logs.place(2), _seconds(period), rostime.get_time()):
            logs.log(level, msg, args, logger_name, 2)

    def identical(period: Any, msg: Any, *args: Any, logger_name: str | None = None, **_unused: Any) -> None:
        if logs.not_identical(logs.place(2), _seconds(period), str(msg), rostime.get_time()):
            logs.log(level, msg, args, logger_name, 2)

    def once(msg: Any, *args: Any, logger_name: str | None = None, **_unused: Any) -> None:
        if logs.first_time(logs.place(2)):
            logs.log(level, msg, args, logger_name, 2)

    return plain, throttled, identical, once


logdebug, logdebug_throttle, logdebug_throttle_identical, logdebug_once = _functions(DEBUG)
loginfo, loginfo_throttle, loginfo_throttle_identical, loginfo_once = _functions(INFO)
logwarn, logwarn_throttle, logwarn_throttle_identical, logwarn_once = _functions(WARN)
logerr, logerr_throttle, logerr_throttle_identical, logerr_once = _functions(ERROR)
logfatal, logfatal_throttle, logfatal_throttle_identical, logfatal_once = _functions(FATAL)
logout = loginfo
logerror = logerr
rospydebug, rospyinfo, rospywarn, rospyerr = logdebug, loginfo, logwarn, logerr


def is_initialized() -> bool:
    """Whether init_node has made the node."""
    return session.initialized


def is_shutdown() -> bool:
    """Whether the node has been told to end, or has ended."""
    return session.shutting_down.is_set()


def is_shutdown_requested() -> bool:
    """Whether somebody has asked for the end, even if the functions of `on_shutdown` still run."""
    return session.requested


def signal_shutdown(reason: str) -> None:
    """End the node: run the functions of `on_shutdown`, unregister, close every connection."""
    session.shut_down(reason)


def add_client_shutdown_hook(h: Callable[[], object]) -> None:
    """Call `h()` when the node ends. Raises TypeError for what cannot be called."""
    if not callable(h):
        raise TypeError(f"shutdown hook [{h}] must be a function or callable object: {type(h)}")
    session.on_client_shutdown(h)


def add_preshutdown_hook(h: Callable[[str], object]) -> None:
    """Call `h(reason)` when the node ends, before the functions of `on_shutdown`."""
    if not callable(h):
        raise TypeError(f"shutdown hook [{h}] must be a function or callable object: {type(h)}")
    session.on_preshutdown(h)


def add_shutdown_hook(h: Callable[[str], object]) -> None:
    """Call `h(reason)` when the node ends, after the functions of `on_shutdown`."""
    if not callable(h):
        raise TypeError(f"shutdown hook [{h}] must be a function or callable object: {type(h)}")
    session.on_shutdown(h)


def get_node_uri() -> str | None:
    """Where the node's slave API is; None before init_node."""
    return None if session.node is None else session.node.uri


def parse_rosrpc_uri(uri: str) -> tuple[str, int]:
    """Host and port of a service's URI. Raises ParameterInvalid."""
    try:
        return parse_host_port(uri)
    except InvalidName as error:
        raise ParameterInvalid(f"ERROR: invalid service URI {uri}: {error}") from None


class ParameterInvalid(ROSException):
    """An argument of an API call is wrong."""


__all__ = [
    "ANYTYPE",
    "GLOBALNS",
    "REMAP",
    "ROSRPC",
    "SEP",
    "SERVICE_ANYTYPE",
    "TOPIC_ANYTYPE",
    "ParameterInvalid",
    "add_client_shutdown_hook",
    "add_preshutdown_hook",
    "add_shutdown_hook",
    "canonicalize_name",
    "get_caller_id",
    "get_mappings",
    "get_name",
    "get_namespace",
    "get_node_uri",
    "get_resolved_mappings",
    "get_ros_namespace",
    "global_name",
    "is_global",
    "is_initialized",
    "is_private",
    "is_shutdown",
    "is_shutdown_requested",
    "logdebug",
    "logdebug_once",
    "logdebug_throttle",
    "logdebug_throttle_identical",
    "logerr",
    "logerr_once",
    "logerr_throttle",
    "logerr_throttle_identical",
    "logerror",
    "logfatal",
    "logfatal_once",
    "logfatal_throttle",
    "logfatal_throttle_identical",
    "loginfo",
    "loginfo_once",
    "loginfo_throttle",
    "loginfo_throttle_identical",
    "logout",
    "logwarn",
    "logwarn_once",
    "logwarn_throttle",
    "logwarn_throttle_identical",
    "make_global_ns",
    "namespace",
    "ns_join",
    "parse_rosrpc_uri",
    "remap_name",
    "resolve_name",
    "rospydebug",
    "rospyerr",
    "rospyinfo",
    "rospywarn",
    "scoped_name",
    "signal_shutdown",
    "valid_name",
]
